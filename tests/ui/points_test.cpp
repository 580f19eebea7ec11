// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <span>

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QListWidget>
#include <QPushButton>

#include "ui/histogram_view.h"
#include "ui/points_panel.h"
#include "ui/window_fixture.h"

namespace alidade::test {

namespace {

QComboBox* comboNamed(QWidget* panel, const QString& name) {
  for (QComboBox* box : panel->findChildren<QComboBox*>())
    if (box->accessibleName() == name) return box;
  return nullptr;
}

}  // namespace

struct PointsInWindow : OpenWindow {
  void SetUp() override {
    OpenWindow::SetUp();
    window->actions()[Command::ShowPoints]->trigger();
    panel = window->findChild<QWidget*>("pointsPanel");
    ASSERT_NE(panel, nullptr);
    ASSERT_TRUE(waitFor([this] { return panel->isVisible(); }));
    if (!session().display().pointPass) window->actions()[Command::PassPoints]->trigger();
    ASSERT_TRUE(settle());
  }
  QWidget* panel = nullptr;
};

TEST_F(PointsInWindow, ColourByClassChangesThePictureAndKeepsItsPoints) {
  const auto before = session().rendered();
  QComboBox* colourBy = comboNamed(panel, "Colour by");
  ASSERT_NE(colourBy, nullptr);
  colourBy->setCurrentIndex(static_cast<int>(ColourBy::Classification));
  ASSERT_TRUE(settle());
  const auto after = session().rendered();
  EXPECT_EQ(session().display().points.colourBy, ColourBy::Classification);
  EXPECT_EQ(after->frame.picture.pointsDrawn, before->frame.picture.pointsDrawn);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < after->frame.picture.colour.size(); ++i)
    changed += !(after->frame.picture.colour.data()[i] == before->frame.picture.colour.data()[i]);
  EXPECT_GT(changed, after->frame.picture.colour.size() / 10);
}

TEST_F(PointsInWindow, AHiddenClassNeitherShowsNorHides) {
  auto* classes = window->findChild<QListWidget*>("classList");
  ASSERT_GT(classes->count(), 1);
  const auto known = [this] {
    std::size_t count = 0;
    for (const float z : std::span(session().rendered()->frame.picture.scanDepth.data(),
                                   session().rendered()->frame.picture.scanDepth.size()))
      count += std::isfinite(z);
    return count;
  };
  const std::size_t before = known();
  for (int row = 0; row < classes->count(); ++row) classes->item(row)->setCheckState(Qt::Unchecked);
  ASSERT_TRUE(settle());
  EXPECT_EQ(session().display().points.hiddenClasses.count(), static_cast<std::size_t>(classes->count()));
  EXPECT_GT(before, 1000u);
  EXPECT_EQ(known(), 0u);
}

TEST_F(PointsInWindow, TheBoxGoesAroundTheSelectedElementAndCutsTheScan) {
  const auto pixel = pixelOnElement();
  ASSERT_TRUE(pixel.has_value());
  click(*pixel);
  const SelectionState selected = session().selection();
  ASSERT_GE(selected.element, 0);
  QCheckBox* use = nullptr;
  for (QCheckBox* box : panel->findChildren<QCheckBox*>())
    if (box->text() == "Use only points inside") use = box;
  ASSERT_NE(use, nullptr);
  use->setChecked(true);
  auto* around = window->findChild<QPushButton*>("boxAroundSelection");
  ASSERT_TRUE(waitFor([&] { return around->isVisibleTo(panel); }));
  around->click();
  ASSERT_TRUE(settle());
  const Bounds bounds = session().model(selected.design)->elementBounds(static_cast<std::size_t>(selected.element));
  const ClipBox& box = session().display().points.clipBox;
  EXPECT_TRUE(box.on);
  EXPECT_LT(glm::length(box.centre - bounds.centre()), 1e-9);
  EXPECT_LT(glm::length(box.size - (bounds.size() + 1.0)), 1e-9);
}

TEST_F(PointsInWindow, PlanesCutTheScanOneByOne) {
  const auto total = [this] { return session().rendered()->frame.picture.pointsDrawn; };
  const std::uint64_t whole = total();
  const auto press = [this](const char* name) {
    auto* button = window->findChild<QPushButton*>(name);
    ASSERT_NE(button, nullptr);
    button->click();
    ASSERT_TRUE(settle());
  };
  press("addCut");  // level, through the middle of the scans
  const std::uint64_t below = total();
  EXPECT_LT(below, whole);
  press("turnCut");
  const std::uint64_t above = total();
  EXPECT_LT(above, whole);
  EXPECT_NE(above, below);
  press("addCut");  // the same plane from above: nothing is left but what lies in it
  EXPECT_LT(total(), std::min(above, below));
  auto* list = window->findChild<QListWidget*>("cutList");
  ASSERT_EQ(list->count(), 2);
  EXPECT_EQ(list->currentRow(), 1);
  QDoubleSpinBox* tilt = nullptr;
  for (QDoubleSpinBox* spin : panel->findChildren<QDoubleSpinBox*>())
    if (spin->accessibleName() == "Tilt") tilt = spin;  // the last one is the planes'
  ASSERT_NE(tilt, nullptr);
  EXPECT_EQ(tilt->value(), 90);
  list->setCurrentRow(0);
  EXPECT_EQ(tilt->value(), -90) << "the figures are those of the plane that the list stands on";
  list->setCurrentRow(1);
  list->item(1)->setCheckState(Qt::Unchecked);
  ASSERT_TRUE(settle());
  EXPECT_EQ(total(), above);
  press("removeCut");
  press("removeCut");
  EXPECT_EQ(list->count(), 0);
  EXPECT_EQ(total(), whole);
}

TEST_F(PointsInWindow, WhatADistanceIsTakenOfDecidesHowManyFarPointsShow) {
  QComboBox* thinned = comboNamed(panel, "Thinned");
  ASSERT_NE(thinned, nullptr);
  const auto drawn = [&](LevelThreshold threshold) -> std::uint64_t {
    thinned->setCurrentIndex(static_cast<int>(threshold));
    EXPECT_TRUE(settle());
    EXPECT_EQ(session().display().levelThreshold, threshold);
    return session().rendered()->frame.picture.pointsDrawn;
  };
  // A part counts as near as its nearest point, and the nearest part decides for all: each shows the other's points and more.
  const std::uint64_t byPoint = drawn(LevelThreshold::ByPoint), byPart = drawn(LevelThreshold::ByDistance),
                      alike = drawn(LevelThreshold::Uniform);
  EXPECT_GT(byPoint, 1000u);
  EXPECT_LT(byPoint, byPart);
  EXPECT_LT(byPart, alike);
}

TEST_F(PointsInWindow, DraggingTheHistogramSetsTheRange) {
  comboNamed(panel, "Colour by")->setCurrentIndex(static_cast<int>(ColourBy::Height));
  ASSERT_TRUE(settle());
  auto* histogram = window->findChild<HistogramView*>("histogram");
  ASSERT_TRUE(histogram->isVisible());
  EXPECT_TRUE(session().display().points.automaticRange);
  const QPoint right(histogram->width() - 8, histogram->height() / 2), middle(histogram->width() / 2, histogram->height() / 2);
  QTest::mousePress(histogram, Qt::LeftButton, Qt::NoModifier, right);
  QMouseEvent move(QEvent::MouseMove, QPointF(middle), histogram->mapToGlobal(QPointF(middle)), Qt::NoButton, Qt::LeftButton,
                   Qt::NoModifier);
  QApplication::sendEvent(histogram, &move);
  QTest::mouseRelease(histogram, Qt::LeftButton, Qt::NoModifier, middle);
  ASSERT_TRUE(settle());
  const PointStyle& style = session().display().points;
  EXPECT_FALSE(style.automaticRange);
  EXPECT_LT(style.rangeLow, style.rangeHigh);
}

}  // namespace alidade::test

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <set>

#include <QAction>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalSpy>
#include <QTreeView>

#include "app/jobs.h"
#include "io/picture_file.h"
#include "ui/export_dialog.h"
#include "ui/project_tree_model.h"
#include "ui/scene_widget.h"
#include "ui/value_slider.h"
#include "ui/window_fixture.h"

namespace alidade::test {

TEST_F(OpenWindow, ShowsTheFirstPosedFrameWithTheDesignOnIt) {
  const RenderResult& result = *session().rendered();
  EXPECT_FALSE(result.problem.has_value());
  EXPECT_FALSE(result.frame.picture.elements.empty());
  EXPECT_GT(result.frame.picture.pointsTotal, 0u);
  EXPECT_TRUE(window->windowTitle().contains("demo"));
}

TEST_F(OpenWindow, ArrowKeysStepThroughTheFramesAndStopAtTheEnds) {
  session().setFrameIndex(0);
  key(Qt::Key_Right);
  EXPECT_EQ(session().frameIndex(), 1);
  key(Qt::Key_Right, Qt::ShiftModifier);
  EXPECT_EQ(session().frameIndex(), static_cast<int>(session().project()->frames.size()) - 1);
  key(Qt::Key_Left);
  EXPECT_EQ(session().frameIndex(), static_cast<int>(session().project()->frames.size()) - 2);
  key(Qt::Key_Home);
  key(Qt::Key_Left);
  EXPECT_EQ(session().frameIndex(), 0);
  ASSERT_TRUE(settle());
  EXPECT_EQ(session().rendered()->request.frame, session().frame());
}

TEST_F(OpenWindow, AClickedElementIsSelectedInTreeAndProperties) {
  const auto pixel = pixelOnElement();
  ASSERT_TRUE(pixel.has_value());
  const auto expected = view().probe().elementAt(*pixel);
  click(*pixel);
  EXPECT_EQ(session().selection().design, expected->design);
  EXPECT_EQ(session().selection().element, expected->element);

  const DesignElement& element =
      session().model(expected->design)->elements[static_cast<std::size_t>(expected->element)];
  const auto* tree = window->findChild<QTreeView*>("projectTree");
  const QString row = tree->currentIndex().data().toString();
  EXPECT_TRUE(row.startsWith(QString::fromStdString(element.name))) << row.toStdString();
  bool named = false;
  for (const QLabel* label : window->findChild<QWidget*>("propertiesPanel")->findChildren<QLabel*>())
    named = named || label->text() == QString::fromStdString(element.name);
  EXPECT_TRUE(named);
  ASSERT_TRUE(settle());
  EXPECT_FALSE(session().rendered()->frame.description.designs.empty());
}

TEST_F(OpenWindow, HidingAnElementTakesItOutOfThePictureAndUndoBringsItBack) {
  const auto pixel = pixelOnElement();
  ASSERT_TRUE(pixel.has_value());
  click(*pixel);
  const SelectionState selected = session().selection();
  window->actions()[Command::HideSelected]->trigger();
  ASSERT_TRUE(settle());
  EXPECT_FALSE(session().elementVisible(selected.design, selected.element));
  EXPECT_FALSE(sharesOf(*session().rendered(), selected.design, selected.element).has_value());
  key(Qt::Key_Z, Qt::ControlModifier);
  ASSERT_TRUE(settle());
  EXPECT_TRUE(session().elementVisible(selected.design, selected.element));
  EXPECT_TRUE(sharesOf(*session().rendered(), selected.design, selected.element).has_value());
}

TEST_F(OpenWindow, TheTreesCheckBoxHidesAScan) {
  ProjectTreeModel& tree = window->tree();
  const QModelIndex scans = tree.index(0, 0);
  const QModelIndex scan = tree.index(0, 0, scans);
  ASSERT_EQ(tree.kind(scan), ProjectTreeModel::Kind::Scan);
  ASSERT_TRUE(tree.setData(scan, Qt::Unchecked, Qt::CheckStateRole));
  ASSERT_TRUE(settle());
  EXPECT_EQ(session().rendered()->frame.picture.pointsDrawn, 0u);
  session().undo().undo();
  ASSERT_TRUE(settle());
  EXPECT_GT(session().rendered()->frame.picture.pointsDrawn, 0u);
}

TEST_F(OpenWindow, DraggingTheDensityDrawsFewerPointsAndADoubleClickReturnsToAutomatic) {
  auto* slider = window->findChild<ValueSlider*>("densitySlider");
  ASSERT_NE(slider, nullptr);
  const auto before = session().rendered()->frame.picture.pointsDrawn;
  ASSERT_GT(before, 0u);
  const QPoint grip(slider->width() - 60, slider->height() / 2);
  QTest::mousePress(slider, Qt::LeftButton, Qt::NoModifier, grip);
  for (int step = 1; step <= 8; ++step) QTest::mouseMove(slider, grip - QPoint(10 * step, 0));
  QTest::mouseRelease(slider, Qt::LeftButton, Qt::NoModifier, grip - QPoint(80, 0));
  EXPECT_LT(session().display().density, 0.5);
  ASSERT_TRUE(settle());
  EXPECT_LT(session().rendered()->frame.picture.pointsDrawn, before);
  QTest::mouseDClick(slider, Qt::LeftButton, Qt::NoModifier, grip - QPoint(80, 0));
  EXPECT_EQ(session().display().density, 1.0);
}

TEST_F(OpenWindow, ADensityCanBeTyped) {
  auto* slider = window->findChild<ValueSlider*>("densitySlider");
  slider->setFocus();
  QTest::keyClick(slider, Qt::Key_4);
  auto* field = slider->findChild<QLineEdit*>();
  ASSERT_NE(field, nullptr);
  QTest::keyClick(field, Qt::Key_2);
  QTest::keyPress(field, Qt::Key_Return);  // it is gone before the key is let go
  EXPECT_NEAR(session().display().density, 0.42, 1e-9);
  EXPECT_TRUE(session().display().designPass) << "the digits must not reach the pass keys";
}

TEST_F(OpenWindow, KeysSwitchPassesAndHiddenParts) {
  key(Qt::Key_4);
  EXPECT_TRUE(session().display().pointPass);
  key(Qt::Key_3);
  EXPECT_FALSE(session().display().designPass);
  const HiddenStyle before = session().display().hidden;
  key(Qt::Key_H);
  EXPECT_NE(session().display().hidden, before);
  key(Qt::Key_H);
  key(Qt::Key_H);
  EXPECT_EQ(session().display().hidden, before);
}

TEST_F(OpenWindow, TheWheelKeepsThePixelUnderTheCursor) {
  const QPointF at(view().width() * 0.3, view().height() * 0.4);
  const glm::dvec2 raw = view().rawFromView(at);
  const double before = view().zoom();
  QWheelEvent wheel(at, view().mapToGlobal(at), {}, {0, 240}, Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase,
                    false);
  QApplication::sendEvent(&view(), &wheel);
  EXPECT_NEAR(view().zoom(), before * 1.44, 1e-9);
  EXPECT_NEAR(glm::length(view().rawFromView(at) - raw), 0.0, 1e-9);
  key(Qt::Key_F);
  EXPECT_NEAR(view().zoom(), before, 1e-9);
}

TEST_F(OpenWindow, HoldingSpaceAndDraggingPansAndDoesNotPlay) {
  const QRectF before = view().pictureRect();
  QTest::keyPress(&view(), Qt::Key_Space);
  QTest::mousePress(&view(), Qt::LeftButton, Qt::NoModifier, {200, 200});
  QTest::mouseMove(&view(), {230, 215});
  QTest::mouseRelease(&view(), Qt::LeftButton, Qt::NoModifier, {230, 215});
  QTest::keyRelease(&view(), Qt::Key_Space);
  EXPECT_EQ(view().pictureRect().topLeft() - before.topLeft(), QPointF(30, 15));
  EXPECT_FALSE(window->playback().playing());
}

TEST_F(OpenWindow, HoldingRShowsTheRawPicture) {
  QTest::keyPress(&view(), Qt::Key_R);
  ASSERT_TRUE(settle());
  EXPECT_TRUE(session().rendered()->request.rawOnly);
  EXPECT_TRUE(session().rendered()->frame.picture.elements.empty());
  QTest::keyRelease(&view(), Qt::Key_R);
  ASSERT_TRUE(settle());
  EXPECT_FALSE(session().rendered()->request.rawOnly);
}

TEST_F(OpenWindow, TheStatusLineReadsTheWorldUnderTheCursor) {
  const auto pixel = pixelOnScan(true);
  ASSERT_TRUE(pixel.has_value());
  hover(*pixel);
  const QString words = window->findChild<QLabel*>("statusWorld")->text();
  EXPECT_TRUE(words.startsWith("E ")) << words.toStdString();
  EXPECT_TRUE(words.contains(" N ") && words.contains(" H ") && words.contains(" m")) << words.toStdString();
  EXPECT_TRUE(window->findChild<QLabel*>("statusDistance")->text().endsWith("away"));
  // The point read projects back to where it was read.
  const auto world = view().cursorReadout().world;
  ASSERT_TRUE(world.has_value());
  const auto back = view().probe().project(*world);
  ASSERT_TRUE(back.has_value());
  EXPECT_LT(glm::length(*back - *view().cursorRaw()), 1.5);
}

TEST_F(OpenWindow, ATextIsWrittenMovedAndUndone) {
  const auto pixel = pixelOnScan(true);
  ASSERT_TRUE(pixel.has_value());
  const std::size_t before = session().project()->annotations.size();
  key(Qt::Key_T);
  click(*pixel);
  auto* edit = view().findChild<QLineEdit*>("annotationText");
  ASSERT_NE(edit, nullptr);
  QTest::keyClicks(edit, "Rebar missing");
  QTest::keyPress(edit, Qt::Key_Return);
  ASSERT_EQ(session().project()->annotations.size(), before + 1);
  const Annotation made = session().project()->annotations.back();
  EXPECT_EQ(made.text, "Rebar missing");
  EXPECT_EQ(made.anchor, AnnotationAnchor::World);
  ASSERT_TRUE(settle());
  const auto at = view().probe().project(made.world);
  ASSERT_TRUE(at.has_value());
  EXPECT_LT(glm::length(*at - *pixel), 2.0);
  key(Qt::Key_Z, Qt::ControlModifier);
  EXPECT_EQ(session().project()->annotations.size(), before);
  key(Qt::Key_Y, Qt::ControlModifier);
  EXPECT_EQ(session().project()->annotations.size(), before + 1);
}

TEST_F(OpenWindow, WithoutScanUnderItAnArrowIsTiedToThePicture) {
  const auto pixel = pixelOnScan(false);
  ASSERT_TRUE(pixel.has_value()) << "the demo shows no pixel without scan";
  key(Qt::Key_A);
  const QPoint from = view().viewFromRaw(*pixel).toPoint();
  QTest::mousePress(&view(), Qt::LeftButton, Qt::NoModifier, from);
  QTest::mouseMove(&view(), from + QPoint(40, 30));
  QTest::mouseRelease(&view(), Qt::LeftButton, Qt::NoModifier, from + QPoint(40, 30));
  ASSERT_FALSE(session().project()->annotations.empty());
  EXPECT_EQ(session().project()->annotations.back().kind, AnnotationKind::Arrow);
  EXPECT_EQ(session().project()->annotations.back().anchor, AnnotationAnchor::Picture);
}

TEST_F(OpenWindow, TwoClicksMeasureADistance) {
  const auto first = pixelOnScan(true);
  ASSERT_TRUE(first.has_value());
  const auto second = pixelOnScan(true, *first);
  ASSERT_TRUE(second.has_value());
  key(Qt::Key_M);
  click(*first);
  const auto a = view().cursorReadout().world;
  click(*second);
  const auto b = view().cursorReadout().world;
  ASSERT_TRUE(a && b);
  const QString last = session().messages().messages().back().what;
  EXPECT_TRUE(last.contains(QString::number(glm::length(*b - *a), 'f', 3))) << last.toStdString();
}

TEST_F(OpenWindow, ExportsThePictureWithItsDataInTheFile) {
  key(Qt::Key_E, Qt::ControlModifier);
  ExportDialog* dialog = window->exportDialog();
  ASSERT_NE(dialog, nullptr);
  ASSERT_TRUE(waitFor([&] { return dialog->previewReady(); }));
  const QString path = folder.filePath("overlay.png");
  dialog->findChild<QLineEdit*>("path")->setText(path);
  QTest::mouseClick(dialog->findChild<QPushButton*>("save"), Qt::LeftButton);
  ASSERT_TRUE(waitFor([&] { return QFile::exists(path) && session().jobs().idle(); }));
  const auto text = readPngText(path.toStdString());
  ASSERT_TRUE(text.has_value()) << text.error().text();
  bool namesFrame = false;
  for (const auto& [key, value] : *text)
    namesFrame = namesFrame || value.find(session().currentFrame()->name) != std::string::npos;
  EXPECT_TRUE(namesFrame);
  const auto picture = readPicture(path.toStdString());
  ASSERT_TRUE(picture.has_value());
  EXPECT_GT(picture->height(), view().probe().rawHeight()) << "the title block stands below the picture";
}

TEST_F(OpenWindow, AnExportThatCannotBeWrittenSaysSoAndKeepsTheDialog) {
  key(Qt::Key_E, Qt::ControlModifier);
  ExportDialog* dialog = window->exportDialog();
  ASSERT_NE(dialog, nullptr);
  ASSERT_TRUE(waitFor([&] { return dialog->previewReady(); }));
  dialog->findChild<QLineEdit*>("path")->setText("/nowhere/at/all/overlay.png");
  QTest::mouseClick(dialog->findChild<QPushButton*>("save"), Qt::LeftButton);
  ASSERT_TRUE(waitFor([&] { return session().jobs().idle(); }));
  ASSERT_FALSE(session().messages().messages().empty());
  EXPECT_EQ(session().messages().messages().back().severity, Severity::Error);
  EXPECT_NE(window->exportDialog(), nullptr);
}

TEST_F(OpenWindow, ARunningJobIsCancelledFromTheStrip) {
  bool cancelled = false;
  session().jobs().run(
      "Waiting",
      [](const Progress& progress) {
        for (int i = 0; i < 2000 && !progress.cancelled(); ++i) {
          progress.report(i / 2000.0, "step");
          QTest::qSleep(5);
        }
        return progress.cancelled();
      },
      [&](bool wasCancelled) { cancelled = wasCancelled; });
  QWidget* strip = window->findChild<QWidget*>("jobStrip");
  ASSERT_TRUE(
      waitFor([&] { return strip->isVisible() && strip->findChild<QAbstractButton*>("cancelJob"); }, 5000));
  QTest::mouseClick(strip->findChild<QAbstractButton*>("cancelJob"), Qt::LeftButton);
  ASSERT_TRUE(waitFor([&] { return session().jobs().idle(); }, 5000));
  EXPECT_TRUE(cancelled);
  EXPECT_FALSE(strip->isVisible());
}

TEST_F(OpenWindow, PlaysTheFramesAndStopsAtTheLast) {
  session().setFrameIndex(0);
  key(Qt::Key_Space);
  EXPECT_TRUE(window->playback().playing());
  ASSERT_TRUE(waitFor([&] { return !window->playback().playing(); }, 30'000));
  EXPECT_EQ(session().frameIndex(), static_cast<int>(session().project()->frames.size()) - 1);
}

TEST_F(OpenWindow, SavedUnderAnotherNameItOpensAgainWithItsAnnotation) {
  session().change("Add annotation", [&](Project& project) {
    Annotation annotation;
    annotation.id = {77};
    annotation.text = "kept";
    annotation.frame = session().frame();
    project.annotations.push_back(annotation);
  });
  EXPECT_TRUE(window->isWindowModified());
  const QString path = folder.filePath("copy.alidade");
  window->files().saveAs(path);
  ASSERT_TRUE(waitFor([&] { return session().jobs().idle(); }));
  EXPECT_FALSE(window->isWindowModified());
  window->files().open(path);
  ASSERT_TRUE(settle());
  ASSERT_EQ(session().project()->annotations.size(), 1u);
  EXPECT_EQ(session().project()->annotations[0].text, "kept");
  EXPECT_TRUE(window->files().recent().contains(path));
}

TEST_F(OpenWindow, TabGoesFromOverlayTo3dToBoth) {
  key(Qt::Key_Tab);
  EXPECT_TRUE(window->scene().isVisible());
  EXPECT_FALSE(view().isVisible());
  QTest::keyClick(&window->scene(), Qt::Key_Tab);
  EXPECT_TRUE(window->scene().isVisible());
  EXPECT_TRUE(view().isVisible());
  QTest::qWait(200);
}

/// Distinct colours of the 3D picture: a black or empty view has one.
static std::size_t coloursOf(SceneWidget& scene) {
  const QImage picture = scene.grabFramebuffer().convertToFormat(QImage::Format_RGB32);
  std::set<QRgb> colours;
  for (int y = 0; y < picture.height(); y += 4)
    for (int x = 0; x < picture.width(); x += 4) colours.insert(picture.pixel(x, y));
  return colours.size();
}

TEST_F(OpenWindow, The3dViewGoesToItsOwnWindowAndComesBackWithItsPicture) {
  SceneWidget& scene = window->scene();
  window->actions()[Command::ShowBoth]->setChecked(true);
  QTest::qWait(300);
  ASSERT_GT(coloursOf(scene), 50u);
  window->actions()[Command::FloatScene]->setChecked(true);
  ASSERT_TRUE(scene.isWindow());
  ASSERT_TRUE(QTest::qWaitForWindowExposed(&scene));
  QTest::qWait(300);
  EXPECT_GT(coloursOf(scene), 50u) << "the floating view is empty";
  scene.resize(700, 500);
  QTest::qWait(200);
  EXPECT_GT(coloursOf(scene), 50u) << "the resized view is empty";
  scene.close();
  EXPECT_FALSE(scene.isWindow());
  EXPECT_TRUE(scene.isVisible());
  EXPECT_FALSE(window->actions()[Command::FloatScene]->isChecked());
  QTest::qWait(300);
  EXPECT_GT(coloursOf(scene), 50u) << "the view that came back is empty";
}

TEST_F(OpenWindow, ThePaletteRunsACommandByItsName) {
  key(Qt::Key_K, Qt::ControlModifier);
  auto* palette = window->findChild<QWidget*>("commandPalette");
  ASSERT_TRUE(palette->isVisible());
  auto* edit = palette->findChild<QLineEdit*>();
  QTest::keyClicks(edit, "last frame");
  QTest::keyClick(edit, Qt::Key_Return);
  EXPECT_FALSE(palette->isVisible());
  ASSERT_TRUE(waitFor(
      [&] { return session().frameIndex() == static_cast<int>(session().project()->frames.size()) - 1; },
      3000));
}

}  // namespace alidade::test

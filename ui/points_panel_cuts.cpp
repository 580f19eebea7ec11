// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// PointsPanel's list of clip planes.

#include <cmath>
#include <numbers>

#include <QFormLayout>
#include <QHBoxLayout>
#include <QListWidget>
#include <QPushButton>

#include "geometry/angle.h"
#include "ui/format.h"
#include "ui/points_panel.h"

namespace alidade {

namespace {

constexpr double kFarthestPlace = 2e8;  ///< beyond any survey's coordinates, metres

QString nameOf(const CutPlane& cut, std::size_t index) {
  return PointsPanel::tr("%1  faces %2°, tilt %3°")
      .arg(index + 1)
      .arg(degreesFromRadians(cut.azimuthRad), 0, 'f', 1)
      .arg(formatNumber(degreesFromRadians(cut.elevationRad), 1));
}

}  // namespace

void PointsPanel::buildCuts() {
  QFormLayout* form = section(tr("Clip planes"));
  m_cuts = new QListWidget;
  m_cuts->setObjectName(QStringLiteral("cutList"));
  m_cuts->setToolTip(tr("Points in front of a ticked plane neither show nor hide the design"));
  m_cuts->setFixedHeight(3 * 21 + 6);
  form->addRow(m_cuts);
  follow([this](const DisplaySettings& d) { refreshCuts(d); });  // before the figures, which ask where the list stands
  auto* buttons = new QWidget;
  auto* row = new QHBoxLayout(buttons);
  row->setContentsMargins(0, 0, 0, 0);
  const auto button = [&](const QString& name, const QString& title, const QString& tip, void (PointsPanel::*action)()) {
    auto* made = new QPushButton(title);
    made->setObjectName(name);
    made->setToolTip(tip);
    row->addWidget(made);
    connect(made, &QPushButton::clicked, this, action);
    return made;
  };
  button(QStringLiteral("addCut"), tr("Add"), tr("Adds a level plane through the selected element, or through the scans, that cuts off what is above"),
         &PointsPanel::addCut);
  QPushButton* turn = button(QStringLiteral("turnCut"), tr("Turn round"), tr("Keeps the other side of the plane"), &PointsPanel::turnCut);
  QPushButton* remove = button(QStringLiteral("removeCut"), tr("Remove"), tr("Removes the plane"), &PointsPanel::removeCut);
  form->addRow(buttons);
  number(
      form, tr("Faces"), tr("Direction of the side that is cut off, clockwise from north"), tr("°"), 0, 360, 1, 1,
      [this](const auto& d) { return degreesFromRadians(cutOf(d).azimuthRad); },
      [this](auto& d, double v) { editCut(d, [&](CutPlane& cut) { cut.azimuthRad = radiansFromDegrees(v); }); });
  number(
      form, tr("Tilt"), tr("Of its normal above the horizon: 90° cuts off what is above"), tr("°"), -90, 90, 1, 1,
      [this](const auto& d) { return degreesFromRadians(cutOf(d).elevationRad); },
      [this](auto& d, double v) { editCut(d, [&](CutPlane& cut) { cut.elevationRad = radiansFromDegrees(v); }); });
  figure(
      form, tr("Place"), tr("Of the plane along its normal"), tr(" m"), -kFarthestPlace, kFar, 0.05, 3,
      [this](const auto& d) { return glm::dot(cutOf(d).normal(), cutOf(d).point); },
      [this](auto& d, double v) {
        editCut(d, [&](CutPlane& cut) { cut.point += (v - glm::dot(cut.normal(), cut.point)) * cut.normal(); });
      });
  connect(m_cuts, &QListWidget::itemChanged, this, [this](QListWidgetItem* item) {
    if (m_filling) return;
    const auto index = static_cast<std::size_t>(m_cuts->row(item));
    apply([&](DisplaySettings& d) { d.points.cuts.at(index).on = item->checkState() == Qt::Checked; });
  });
  connect(m_cuts, &QListWidget::currentRowChanged, this, [this] {
    if (!m_filling) refresh();
  });
  follow([form, turn, remove, list = m_cuts](const DisplaySettings& d) {
    const bool any = !d.points.cuts.empty();
    turn->setEnabled(any);
    remove->setEnabled(any);
    list->setVisible(any);
    for (int i = 2; i < form->rowCount(); ++i) form->setRowVisible(i, any);
  });
}

CutPlane PointsPanel::cutOf(const DisplaySettings& display) const {
  const auto& cuts = display.points.cuts;
  const int row = m_cuts->currentRow();
  return row >= 0 && row < static_cast<int>(cuts.size()) ? cuts[static_cast<std::size_t>(row)] : CutPlane();
}

void PointsPanel::editCut(DisplaySettings& display, const std::function<void(CutPlane&)>& edit) const {
  auto& cuts = display.points.cuts;
  const int row = m_cuts->currentRow();
  if (row >= 0 && row < static_cast<int>(cuts.size())) edit(cuts[static_cast<std::size_t>(row)]);
}

void PointsPanel::refreshCuts(const DisplaySettings& display) {
  const auto& cuts = display.points.cuts;
  m_filling = true;
  while (m_cuts->count() > static_cast<int>(cuts.size())) delete m_cuts->takeItem(m_cuts->count() - 1);
  while (m_cuts->count() < static_cast<int>(cuts.size())) {
    auto* item = new QListWidgetItem;
    item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsUserCheckable);
    m_cuts->addItem(item);
    m_cuts->setCurrentItem(item);
  }
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    QListWidgetItem* item = m_cuts->item(static_cast<int>(i));
    item->setText(nameOf(cuts[i], i));
    item->setCheckState(cuts[i].on ? Qt::Checked : Qt::Unchecked);
  }
  if (m_cuts->currentRow() < 0 && m_cuts->count() > 0) m_cuts->setCurrentRow(0);
  m_filling = false;
}

void PointsPanel::addCut() {
  const Bounds around = boundsOfInterest();
  if (around.empty()) return;
  apply([&](DisplaySettings& d) { d.points.cuts.push_back({true, around.centre(), 0, 0.5 * std::numbers::pi}); });
}

void PointsPanel::turnCut() {
  apply([this](DisplaySettings& d) {
    editCut(d, [](CutPlane& cut) {
      cut.azimuthRad = std::fmod(cut.azimuthRad + std::numbers::pi, 2 * std::numbers::pi);
      cut.elevationRad = -cut.elevationRad;
    });
  });
}

void PointsPanel::removeCut() {
  apply([this](DisplaySettings& d) {
    const int row = m_cuts->currentRow();
    if (row >= 0 && row < static_cast<int>(d.points.cuts.size())) d.points.cuts.erase(d.points.cuts.begin() + row);
  });
}

}  // namespace alidade

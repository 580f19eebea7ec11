// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/resection_panel.h"

#include <QHeaderView>
#include <QKeyEvent>

#include "geometry/angle.h"
#include "ui/format.h"
#include "ui/view_tool.h"
#include "ui_resection_panel.h"

namespace alidade {

ResectionPanel::ResectionPanel(Session& session, PoseRefinement& refinement, OverlayView& view,
                               QWidget* parent)
    : QWidget(parent),
      m_session(session),
      m_refinement(refinement),
      m_view(view),
      m_form(std::make_unique<Ui::ResectionPanelForm>()) {
  m_form->setupUi(this);
  QTableWidget* table = m_form->observationTable;
  table->setColumnCount(4);
  table->setHorizontalHeaderLabels({tr("Point"), tr("u, v"), tr("Δu, Δv"), tr("px")});
  table->verticalHeader()->setVisible(false);
  table->verticalHeader()->setDefaultSectionSize(22);
  table->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  table->horizontalHeader()->setSectionResizeMode(0, QHeaderView::Stretch);
  table->setShowGrid(false);
  table->setMinimumHeight(110);
  table->installEventFilter(this);
  connect(table, &QTableWidget::itemChanged, this, [this](QTableWidgetItem* item) {
    if (m_refreshing || item->column() != 0) return;
    m_refinement.setEnabled(m_rows[static_cast<std::size_t>(item->row())], item->checkState() == Qt::Checked);
  });
  connect(m_form->pick, &QPushButton::clicked, this, &ResectionPanel::startPick);
  connect(m_form->refine, &QPushButton::clicked, &m_refinement, &PoseRefinement::refine);
  connect(m_form->accept, &QPushButton::clicked, &m_refinement, &PoseRefinement::accept);
  connect(m_form->drop, &QPushButton::clicked, &m_refinement, &PoseRefinement::drop);
  connect(m_form->lockPosition, &QCheckBox::clicked, this, [this](bool on) {
    for (QCheckBox* box : {m_form->lockE, m_form->lockN, m_form->lockH}) box->setChecked(on);
  });
  for (QCheckBox* box : {m_form->lockE, m_form->lockN, m_form->lockH, m_form->lockAttitude})
    connect(box, &QCheckBox::toggled, this, &ResectionPanel::applyLocks);
  connect(&m_refinement, &PoseRefinement::changed, this, &ResectionPanel::refresh);
  connect(&session, &Session::structureChanged, this, &ResectionPanel::refillPoints);
  connect(&session, &Session::pictureReady, this, &ResectionPanel::refresh);
  refillPoints();
  refresh();
}

ResectionPanel::~ResectionPanel() = default;

void ResectionPanel::refillPoints() {
  m_points.clear();
  m_form->point->clear();
  m_points.push_back({tr("Point of the scan"), std::nullopt});
  for (const ControlPoint& point : m_session.project()->controlPoints)
    m_points.push_back({text(point.name), point.position});
  for (const StakePoint& point : m_session.project()->stakePoints)
    m_points.push_back({text(point.name), point.position});
  for (const KnownPoint& point : m_points) m_form->point->addItem(point.name);
  if (m_points.size() > 1) m_form->point->setCurrentIndex(1);
}

void ResectionPanel::applyLocks() {
  ResectionOptions& options = m_refinement.options();
  options.lockPosition = {m_form->lockE->isChecked(), m_form->lockN->isChecked(), m_form->lockH->isChecked()};
  options.lockAttitude = m_form->lockAttitude->isChecked();
  m_form->lockPosition->setChecked(options.lockPosition[0] && options.lockPosition[1] &&
                                   options.lockPosition[2]);
}

void ResectionPanel::startPick() {
  const int index = m_form->point->currentIndex();
  if (index < 0) return;
  const KnownPoint point = m_points[static_cast<std::size_t>(index)];
  point.world ? pickPixel(point) : pickScanPoint();
}

void ResectionPanel::useWorldPoint(const glm::dvec3& world) {
  pickPixel({tr("S%1").arg(m_refinement.observations().size() + 1), world});
}

void ResectionPanel::pickScanPoint() {
  emit toolBorrowed();
  m_view.setTool(makePointTool(
      tr("Click the scan point where the picture shows it now, or pick it in 3D. Esc leaves"), true,
      [this](const glm::dvec2&, const std::optional<glm::dvec3>& world) { useWorldPoint(*world); },
      [this] { endPick(); }));
}

void ResectionPanel::pickPixel(const KnownPoint& point) {
  emit toolBorrowed();
  m_view.setTool(makePointTool(
      tr("Click where the picture really shows %1. Esc leaves").arg(point.name), false,
      [this, point](const glm::dvec2& raw, const std::optional<glm::dvec3>&) {
        m_refinement.add(raw, *point.world, point.name);
        const int next = m_form->point->currentIndex() + 1;
        const bool known = m_form->point->currentIndex() > 0;
        if (known && next < m_form->point->count()) m_form->point->setCurrentIndex(next);
        endPick();
      },
      [this] { endPick(); }));
}

void ResectionPanel::endPick() {
  // The tool that calls this is still running: it is replaced once it has returned.
  QMetaObject::invokeMethod(this, &ResectionPanel::toolReturned, Qt::QueuedConnection);
}

bool ResectionPanel::eventFilter(QObject* watched, QEvent* event) {
  if (watched == m_form->observationTable) {
    const int row = m_form->observationTable->currentRow();
    const bool override = event->type() == QEvent::ShortcutOverride;
    if ((override || event->type() == QEvent::KeyPress) && row >= 0) {
      const int key = static_cast<QKeyEvent*>(event)->key();
      if (key == Qt::Key_Delete || key == Qt::Key_Backspace) {
        override ? event->accept() : m_refinement.remove(m_rows[static_cast<std::size_t>(row)]);
        return true;
      }
    }
  }
  return QWidget::eventFilter(watched, event);
}

void ResectionPanel::refresh() {
  m_refreshing = true;
  const auto observations = m_refinement.observations();
  QTableWidget* table = m_form->observationTable;
  table->setRowCount(static_cast<int>(observations.size()));
  m_rows.clear();
  int enabled = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Observation& o = observations[i];
    m_rows.push_back(o.id);
    enabled += o.enabled;
    const auto residual = m_refinement.residual(o);
    const QString cells[] = {
        text(o.name), QStringLiteral("%1, %2").arg(o.pixel.x, 0, 'f', 1).arg(o.pixel.y, 0, 'f', 1),
        residual ? QStringLiteral("%1, %2").arg(residual->x, 0, 'f', 1).arg(residual->y, 0, 'f', 1)
                 : tr("not seen"),
        residual ? QString::number(glm::length(*residual), 'f', 2) : QString()};
    for (int c = 0; c < 4; ++c) {
      auto* item = new QTableWidgetItem(cells[c]);
      item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable |
                     (c == 0 ? Qt::ItemIsUserCheckable : Qt::NoItemFlags));
      if (c == 0) item->setCheckState(o.enabled ? Qt::Checked : Qt::Unchecked);
      if (c > 0) item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
      table->setItem(static_cast<int>(i), c, item);
    }
  }
  m_form->pick->setEnabled(m_session.currentFrame() != nullptr);
  m_form->refine->setEnabled(enabled > 0 && !m_refinement.running());
  m_form->refine->setText(m_refinement.running() ? tr("Refining…") : tr("Refine"));
  m_form->accept->setEnabled(m_refinement.hasCandidate());
  m_form->drop->setEnabled(m_refinement.hasCandidate());
  refreshSummary();
  m_refreshing = false;
}

void ResectionPanel::refreshSummary() {
  const auto& summary = m_refinement.summary();
  if (!summary) {
    m_form->summary->clear();
    return;
  }
  QStringList lines;
  if (!summary->converged) {
    lines << tr("✕ Not refined: %1").arg(text(summary->reason));
  } else {
    lines << tr("✓ rms %1 px, σ₀ %2, %3 iterations")
                 .arg(summary->rmsPx, 0, 'f', 2)
                 .arg(summary->sigma0, 0, 'f', 2)
                 .arg(summary->iterations);
    lines << tr("Position ± %1, %2, %3")
                 .arg(formatMillimetres(summary->positionStdM.x), formatMillimetres(summary->positionStdM.y),
                      formatMillimetres(summary->positionStdM.z));
    lines << tr("Attitude ± %1, %2, %3 mgon")
                 .arg(gonFromRadians(summary->rotationStdRad.x) * 1000, 0, 'f', 1)
                 .arg(gonFromRadians(summary->rotationStdRad.y) * 1000, 0, 'f', 1)
                 .arg(gonFromRadians(summary->rotationStdRad.z) * 1000, 0, 'f', 1);
    for (const ExpectedError& expected : summary->expected)
      lines << tr("Overlay good to %1 mm among the points (95 %)").arg(expected.millimetres, 0, 'f', 1);
    if (summary->outlierCount() > 0)
      lines << tr("▲ %1 outliers: tick them off or pick them again").arg(summary->outlierCount());
    if (m_refinement.hasCandidate()) lines << tr("Hold B to see the pose before.");
  }
  m_form->summary->setText(lines.join('\n'));
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/resection_panel.h"

#include <algorithm>

#include <QHeaderView>
#include <QKeyEvent>
#include <QSortFilterProxyModel>

#include "app/observing.h"
#include "geometry/angle.h"
#include "targets/mark.h"
#include "ui/format.h"
#include "ui/observation_model.h"
#include "ui/value_slider.h"
#include "ui/view_tool.h"
#include "ui_resection_panel.h"

namespace alidade {

namespace {

constexpr double kGrabPx = 14.0;         // screen pixels around a corner or an edge of the design
constexpr double kLeastSigmaPx = 0.1;    // what a mark is good for once lens and light have their say
constexpr double kScanSigmaM = 0.003;

}  // namespace

ResectionPanel::ResectionPanel(Session& session, PoseRefinement& refinement, OverlayView& view,
                               QWidget* parent)
    : QWidget(parent),
      m_session(session),
      m_refinement(refinement),
      m_view(view),
      m_form(std::make_unique<Ui::ResectionPanelForm>()),
      m_model(new ObservationModel(session, refinement, this)),
      m_sorted(new QSortFilterProxyModel(this)) {
  m_form->setupUi(this);
  m_sorted->setSourceModel(m_model);
  m_sorted->setSortRole(ObservationModel::kSortRole);
  m_sorted->setDynamicSortFilter(true);
  QTableView* table = m_form->observationTable;
  table->setModel(m_sorted);
  table->sortByColumn(-1, Qt::AscendingOrder);  // as they were observed, until a header is clicked
  table->verticalHeader()->setVisible(false);
  table->verticalHeader()->setDefaultSectionSize(22);
  table->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  table->setMinimumHeight(110);
  table->installEventFilter(this);
  connect(table->selectionModel(), &QItemSelectionModel::selectionChanged, this, &ResectionPanel::refresh);
  m_scale = new ValueSlider(tr("Residuals drawn"), QStringLiteral("measure"), {1, 200, 10, true, 1, 0, QStringLiteral("×")});
  m_scale->setObjectName(QStringLiteral("residualScale"));
  m_scale->setToolTip(tr("How much longer than true the residual vectors are drawn. Hold V to hide them"));
  m_form->outer->insertWidget(m_form->outer->indexOf(table) + 1, m_scale);
  connect(m_form->align, &QPushButton::clicked, &m_refinement, &PoseRefinement::alignAutomatically);
  connect(m_form->alignAll, &QPushButton::clicked, &m_refinement, &PoseRefinement::alignSequence);
  connect(m_form->pick, &QPushButton::clicked, this, &ResectionPanel::startPick);
  connect(m_form->match, &QPushButton::clicked, this, [this] { m_refinement.matchInOtherFrames(selected()); });
  connect(m_form->judge, &QPushButton::clicked, this, [this] {
    pickScanPoint(tr("Click the object point that the millimetres are wanted for. Esc leaves"), [this](const glm::dvec3& world) {
      m_refinement.setJudgedAt(world);
      endPick();
    });
  });
  connect(m_form->refine, &QPushButton::clicked, &m_refinement, &PoseRefinement::refine);
  connect(m_form->accept, &QPushButton::clicked, &m_refinement, &PoseRefinement::accept);
  connect(m_form->drop, &QPushButton::clicked, &m_refinement, &PoseRefinement::drop);
  connectOptions();
  connect(&m_refinement, &PoseRefinement::changed, this, &ResectionPanel::refresh);
  connect(&session, &Session::structureChanged, this, &ResectionPanel::refillPoints);
  connect(&session, &Session::pictureReady, this, &ResectionPanel::refresh);
  refillPoints();
  refresh();
}

ResectionPanel::~ResectionPanel() = default;

void ResectionPanel::connectOptions() {
  for (QCheckBox* box : {m_form->lockE, m_form->lockN, m_form->lockH, m_form->lockX, m_form->lockY, m_form->lockZ,
                         m_form->freeFocal, m_form->freePrincipal, m_form->freeDistortion})
    connect(box, &QCheckBox::toggled, this, &ResectionPanel::applyOptions);
  connect(m_form->scope, &QComboBox::currentIndexChanged, this,
          [this](int index) { m_refinement.setScope(index == 0 ? RefinementScope::Frame : RefinementScope::AllFrames); });
  connect(m_scale, &ValueSlider::changed, this, [this](double value, bool dragging) {
    DisplaySettings display = m_session.display();
    display.residualScale = value;
    m_session.setDisplay(display, dragging);
  });
  connect(&m_session, &Session::displayChanged, this, [this] { m_scale->setValue(m_session.display().residualScale); });
}

void ResectionPanel::refillPoints() {
  m_choices.clear();
  m_form->point->clear();
  const auto offer = [this](Source source, const QString& name, Observation observation = {}) {
    m_choices.push_back({source, std::move(observation)});
    m_form->point->addItem(name);
  };
  offer(Source::Scan, tr("Point of the scan"));
  offer(Source::DesignCorner, tr("Corner of the design"));
  offer(Source::DesignEdge, tr("Edge of the design"));
  const auto known = [&](const std::string& name, const glm::dvec3& world, double sigmaM) {
    Observation observation;
    observation.name = name, observation.world = world, observation.sigmaM = sigmaM;
    offer(Source::Known, text(name), observation);
  };
  for (const ControlPoint& point : m_session.project()->controlPoints) known(point.name, point.position, point.sigmaM);
  for (const StakePoint& point : m_session.project()->stakePoints) known(point.name, point.position, 0);
  constexpr int kFirstKnown = 3;
  if (m_form->point->count() > kFirstKnown) m_form->point->setCurrentIndex(kFirstKnown);
}

void ResectionPanel::applyOptions() {
  NetworkFreedom& freedom = m_refinement.freedom();
  freedom.lockPosition = {m_form->lockE->isChecked(), m_form->lockN->isChecked(), m_form->lockH->isChecked()};
  freedom.lockAttitude = {m_form->lockX->isChecked(), m_form->lockY->isChecked(), m_form->lockZ->isChecked()};
  freedom.focal = m_form->freeFocal->isChecked();
  freedom.principalPoint = m_form->freePrincipal->isChecked();
  freedom.distortion = m_form->freeDistortion->isChecked();
}

ObservationId ResectionPanel::selected() const {
  const QModelIndexList rows = m_form->observationTable->selectionModel()->selectedRows();
  return rows.isEmpty() ? ObservationId() : m_model->idAt(m_sorted->mapToSource(rows.front()).row());
}

void ResectionPanel::startPick() {
  const int index = m_form->point->currentIndex();
  if (index < 0) return;
  const Choice& choice = m_choices[static_cast<std::size_t>(index)];
  switch (choice.source) {
    case Source::Known:
      return pickPixel(choice.observation);
    case Source::Scan:
      return pickScanPoint(tr("Click the scan point where the picture shows it now, or pick it in 3D. Esc leaves"),
                           [this](const glm::dvec3& world) { useWorldPoint(world); });
    case Source::DesignCorner:
    case Source::DesignEdge:
      return pickDesign(choice.source);
  }
}

void ResectionPanel::useWorldPoint(const glm::dvec3& world) {
  Observation observation;
  observation.kind = ObservedKind::Scan;
  observation.world = world;
  observation.sigmaM = kScanSigmaM;
  observation.name = freePointName(*m_session.project(), "S");
  pickPixel(observation);
}

void ResectionPanel::borrow(const QString& hint, bool wantsScan,
                            const std::function<void(const glm::dvec2&, const std::optional<glm::dvec3>&)>& picked) {
  emit toolBorrowed();
  m_view.setTool(makePointTool(hint, wantsScan, picked, [this] { endPick(); }));
}

void ResectionPanel::pickScanPoint(const QString& hint, const std::function<void(const glm::dvec3&)>& picked) {
  borrow(hint, true, [picked](const glm::dvec2&, const std::optional<glm::dvec3>& world) { picked(*world); });
}

void ResectionPanel::pickDesign(Source source) {
  const bool edge = source == Source::DesignEdge;
  const QString hint = edge ? tr("Click the design's edge where it is drawn now. Esc leaves")
                            : tr("Click the design's corner where it is drawn now. Esc leaves");
  borrow(hint, false, [this, edge](const glm::dvec2& raw, const std::optional<glm::dvec3>&) {
    const FrameDescription* frame = m_view.probe().description();
    const double radius = kGrabPx / m_view.zoom();
    const auto snapped = !frame ? std::nullopt : edge ? designEdgeAt(*frame, raw, radius) : designCornerAt(*frame, raw, radius);
    if (!snapped) return m_view.flash(edge ? tr("No edge of the design is drawn here") : tr("No corner of the design is drawn here"));
    Observation observation;
    observation.kind = edge ? ObservedKind::Edge : ObservedKind::Control;
    observation.world = snapped->world;
    observation.edgeEnd = snapped->edgeEnd;
    observation.name = freePointName(*m_session.project(), edge ? "E" : "D");
    pickPixel(observation);
  });
}

void ResectionPanel::pickPixel(const Observation& what) {
  const bool edge = what.kind == ObservedKind::Edge;
  const QString hint = edge ? tr("Click places along the edge in the picture, two or more. Esc ends")
                            : tr("Click where the picture really shows %1. Esc leaves").arg(text(what.name));
  borrow(hint, false, [this, what, edge](const glm::dvec2& raw, const std::optional<glm::dvec3>&) {
    Observation seen = what;
    seen.pixel = raw;
    if (!edge && m_form->snap->isChecked()) snap(seen);
    m_refinement.add(seen);
    if (edge) return;
    const int next = m_form->point->currentIndex() + 1;
    const bool known = m_choices[static_cast<std::size_t>(m_form->point->currentIndex())].source == Source::Known;
    if (known && next < m_form->point->count()) m_form->point->setCurrentIndex(next);
    endPick();
  });
}

void ResectionPanel::snap(Observation& observation) const {
  const ColourImage* picture = m_view.probe().rawPicture();
  if (!picture) return;
  const auto mark = refineMark(*picture, observation.pixel);
  if (!mark) return m_view.flash(tr("Kept where it was clicked. %1").arg(text(mark.error().what)));
  observation.pixel = mark->pixel;
  observation.sigmaPx = std::max(kLeastSigmaPx, mark->sigmaPx);
  m_view.flash(mark->shape == MarkShape::Corner ? tr("Snapped to the corner, ± %1 px").arg(observation.sigmaPx, 0, 'f', 2)
                                                : tr("Snapped to the target's centre, ± %1 px").arg(observation.sigmaPx, 0, 'f', 2));
}

void ResectionPanel::endPick() {
  // The tool that calls this is still running: it is replaced once it has returned.
  QMetaObject::invokeMethod(this, &ResectionPanel::toolReturned, Qt::QueuedConnection);
}

bool ResectionPanel::eventFilter(QObject* watched, QEvent* event) {
  if (watched == m_form->observationTable) {
    const bool override = event->type() == QEvent::ShortcutOverride;
    if ((override || event->type() == QEvent::KeyPress) && selected()) {
      const int key = static_cast<QKeyEvent*>(event)->key();
      if (key == Qt::Key_Delete || key == Qt::Key_Backspace) {
        override ? event->accept() : m_refinement.remove(selected());
        return true;
      }
    }
  }
  return QWidget::eventFilter(watched, event);
}

void ResectionPanel::refresh() {
  const auto observations = m_refinement.observations(m_refinement.scope());
  const auto used = std::count_if(observations.begin(), observations.end(),
                                  [](const Observation& o) { return o.enabled && !o.heldOut; });
  const bool all = m_refinement.scope() == RefinementScope::AllFrames;
  m_form->observationTable->setColumnHidden(ObservationModel::FrameName, !all);
  const Frame* frame = m_session.currentFrame();
  const bool hasModel = !m_session.project()->scans.empty() || !m_session.project()->designs.empty();
  m_form->align->setEnabled(frame && frame->cameraFromWorld && hasModel && !m_refinement.running());
  m_form->alignAll->setEnabled(m_session.project()->frames.size() > 1 && hasModel && !m_refinement.running());
  m_form->pick->setEnabled(frame != nullptr);
  m_form->match->setEnabled(static_cast<bool>(selected()) && m_session.project()->frames.size() > 1);
  m_form->judge->setEnabled(frame != nullptr);
  m_form->refine->setEnabled(used > 0 && !m_refinement.running());
  m_form->refine->setText(m_refinement.running() ? tr("Refining…") : tr("Refine"));
  m_form->accept->setEnabled(m_refinement.hasCandidate());
  m_form->drop->setEnabled(m_refinement.hasCandidate());
  const auto& at = m_refinement.judgedAt();
  m_form->judgedAt->setText(at ? tr("Judged at %1").arg(formatWorld(*at)) : tr("Judged amid the points"));
  refreshSummary();
}

QString ResectionPanel::chosenPointWords(const ExpectedError& expected) const {
  return std::isfinite(expected.millimetres) ? tr("Overlay good to %1 mm at the chosen point (95 %)").arg(expected.millimetres, 0, 'f', 1)
                                             : tr("The chosen point is not in view");
}

QString ResectionPanel::alignmentWords() const {
  const AlignmentSummary& found = *m_refinement.alignment();
  if (!found.converged)
    return tr("✕ Not aligned: %1\nPick points, or start from a better pose.").arg(text(found.reason));
  const glm::dvec3 moved = found.cameraFromWorld.centre() - found.startCameraFromWorld.centre();
  QStringList lines{tr("✓ Aligned, confidence %1").arg(formatPercent(found.confidence)),
                    tr("%1 of %2 patches agree").arg(found.evidence.inliers).arg(found.evidence.patches),
                    tr("Overlay good to %1 px (95 %)").arg(found.evidence.expectedPx, 0, 'f', 2)};
  if (const CameraRecord* camera = m_session.currentCamera(); camera && m_refinement.judgedAt())
    lines << chosenPointWords(expectedError(camera->camera, found.cameraFromWorld, found.estimate.covariance, *m_refinement.judgedAt()));
  lines << tr("Moved %1").arg(formatMillimetres(glm::length(moved)));
  if (m_refinement.hasCandidate()) lines << tr("Hold B to see the pose before.");
  return lines.join('\n');
}

QStringList ResectionPanel::sequenceWords() const {
  const SequenceSummary& found = *m_refinement.sequence();
  const auto count = [&](auto which) { return static_cast<int>(std::count_if(found.frames.begin(), found.frames.end(), which)); };
  QStringList lines{tr("%1 of %2 keyframes found themselves, %3 refined")
                        .arg(count([](const SequenceFrame& f) { return f.aligned; }))
                        .arg(found.frames.size())
                        .arg(count([](const SequenceFrame& f) { return f.refined; }))};
  for (const MovementAlarm& alarm : found.alarms)
    if (const Frame* frame = m_session.project()->findFrame(alarm.frame))
      lines << tr("▲ The camera moved by %1 before %2").arg(formatMillimetres(alarm.metres), text(frame->name));
  return lines;
}

void ResectionPanel::refreshSummary() {
  const auto& summary = m_refinement.summary();
  if (!summary) {
    m_form->summary->setText(m_refinement.alignment() ? alignmentWords() : QString());
    return;
  }
  QStringList lines;
  if (m_refinement.sequence()) lines = sequenceWords();
  const bool converged = m_refinement.sequence() ? m_refinement.sequence()->converged : summary->converged;
  if (!converged) {
    lines << tr("✕ Not refined: %1").arg(reportText(m_refinement.sequence() ? m_refinement.sequence()->reason : summary->reason));
    m_form->summary->setText(lines.join('\n'));
    return;
  }
  lines << tr("✓ σ₀ %1, redundancy %2, %3 iterations")
               .arg(summary->sigma0, 0, 'f', 2)
               .arg(summary->redundancy)
               .arg(summary->iterations);
  for (const ResidualGroup& group : summary->groups)
    if (std::isfinite(group.rmsM))
      lines << tr("%1%2: %3 rms of %4")
                   .arg(text(residualKindName(group.kind)), group.heldOut ? tr(", held out") : QString(), formatMillimetres(group.rmsM))
                   .arg(group.count);
    else if (std::isfinite(group.rmsPx))
      lines << tr("%1%2: %3 px rms of %4")
                   .arg(text(residualKindName(group.kind)), group.heldOut ? tr(", held out") : QString())
                   .arg(group.rmsPx, 0, 'f', 2)
                   .arg(group.count);
  const Frame* frame = m_session.currentFrame();
  const auto& names = m_refinement.frameNames();
  const auto at = frame ? std::find(names.begin(), names.end(), frame->name) : names.end();
  if (at != names.end() && static_cast<std::size_t>(at - names.begin()) < summary->poses.size()) {
    const AdjustedPose& pose = summary->poses[static_cast<std::size_t>(at - names.begin())];
    lines << tr("Position ± %1, %2, %3")
                 .arg(formatMillimetres(pose.positionStdM.x), formatMillimetres(pose.positionStdM.y),
                      formatMillimetres(pose.positionStdM.z));
    lines << tr("95 % ellipse %1 by %2, height ± %3")
                 .arg(formatMillimetres(pose.ellipse.semiMajorM), formatMillimetres(pose.ellipse.semiMinorM),
                      formatMillimetres(pose.ellipse.heightM));
    lines << tr("Attitude ± %1, %2, %3 mgon")
                 .arg(gonFromRadians(pose.rotationStdRad.x) * 1000, 0, 'f', 1)
                 .arg(gonFromRadians(pose.rotationStdRad.y) * 1000, 0, 'f', 1)
                 .arg(gonFromRadians(pose.rotationStdRad.z) * 1000, 0, 'f', 1);
  }
  if (const auto expected = m_refinement.expectedHere())
    lines << (m_refinement.judgedAt() ? chosenPointWords(*expected)
                                      : tr("Overlay good to %1 mm among the points (95 %)").arg(expected->millimetres, 0, 'f', 1));
  for (std::size_t i = 0; i < summary->cameraAccuracy.size(); ++i)
    if (const CameraAccuracy& known = summary->cameraAccuracy[i]; !known.covariance.empty() && known.std(0) > 0)
      lines << tr("Focal length %1 ± %2 px").arg(summary->cameras[i].fx, 0, 'f', 2).arg(known.std(0), 0, 'f', 2);
  for (const std::string& pair : summary->correlations) lines << tr("▲ %1").arg(reportText(pair));
  for (const std::string& warning : summary->warnings) lines << tr("▲ %1").arg(reportText(warning));
  if (const int outliers = summary->outlierCount(); outliers > 0)
    lines << tr("▲ %1 outliers took no part: leave them out or pick them again").arg(outliers);
  if (m_refinement.hasCandidate()) lines << tr("Hold B to see the pose before.");
  m_form->summary->setText(lines.join('\n'));
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/pose_refinement.h"

#include <algorithm>

#include "app/observing.h"
#include "app/pose_clock.h"
#include "ui/format.h"

namespace alidade {

namespace {

/// Of a long sequence every so many frames are aligned; those between follow.
constexpr int kMostKeyframes = 60;

struct RefineOutcome {
  NetworkSummary summary;
  std::vector<std::string> frameNames;
  std::set<ObservationId> outliers;
};

/// What is known before the job starts.
struct RefineTask {
  std::vector<ObservationRow> rows;
  NetworkFreedom freedom;
  glm::dvec3 judgedAt{0};
  std::string frame;
};

Result<RefineOutcome> run(const RefineTask& task, Project& project, const Progress& progress) {
  const auto refinement = networkOf(project, task.frame, task.rows, task.freedom);
  if (!refinement) return fail(refinement.error());
  NetworkOptions options;
  for (std::size_t i = 0; i < refinement->frames.size(); ++i) options.at.push_back({static_cast<int>(i), task.judgedAt});
  auto summary = refineNetwork(project, *refinement, options, false, progress);
  if (!summary) return fail(summary.error());
  RefineOutcome outcome;
  for (const NetworkFrame& frame : refinement->network.frames) outcome.frameNames.push_back(frame.name);
  for (const NetworkResidual& r : summary->residuals) {
    if (!r.outlier) continue;
    if (const auto row = refinement->rowOf(r)) outcome.outliers.insert(task.rows[*row].id);
  }
  outcome.summary = std::move(*summary);
  return outcome;
}

bool samePose(const std::optional<RigidTransform>& a, const std::optional<RigidTransform>& b) {
  return a && b && a->rotation == b->rotation && a->translation == b->translation;
}

/// Gives `project` the poses and calibrations that the refinement changed, and no other: the rest may have been
/// changed since it began.
void apply(const Project& base, const Project& candidate, Project& project) {
  for (const Frame& better : candidate.frames) {
    const Frame* was = base.findFrame(better.id);
    Frame* frame = project.findFrame(better.id);
    if (!was || !frame || samePose(was->cameraFromWorld, better.cameraFromWorld)) continue;
    frame->cameraFromWorld = better.cameraFromWorld;
    frame->originalCameraFromWorld = better.originalCameraFromWorld;
    frame->poseSource = better.poseSource;
    frame->quality = better.quality;
  }
  for (const CameraRecord& better : candidate.cameras) {
    const CameraRecord* was = base.findCamera(better.id);
    if (!was || was->camera.intrinsics().parameters() == better.camera.intrinsics().parameters()) continue;
    for (CameraRecord& camera : project.cameras)
      if (camera.id == better.id) camera.camera = better.camera;
  }
}

}  // namespace

PoseRefinement::PoseRefinement(Session& session, QObject* parent) : QObject(parent), m_session(session) {
  connect(&session, &Session::frameChanged, this, &PoseRefinement::showCandidate);
  connect(&session, &Session::structureChanged, this, &PoseRefinement::forget);
  connect(&session, &Session::projectChanged, this, &PoseRefinement::changed);
}

std::vector<Observation> PoseRefinement::observations(RefinementScope scope) const {
  std::vector<Observation> own;
  for (const Observation& o : m_session.project()->observations)
    if (scope == RefinementScope::AllFrames || o.frame == m_session.frame()) own.push_back(o);
  return own;
}

void PoseRefinement::add(Observation observation) {
  if (observation.name.empty()) observation.name = freePointName(*m_session.project(), "S");
  observation.id = nextObservationId(*m_session.project());
  observation.frame = m_session.frame();
  m_session.change(tr("Add observation %1").arg(text(observation.name)),
                   [&](Project& project) { project.observations.push_back(observation); });
}

void PoseRefinement::remove(ObservationId id) {
  m_session.change(tr("Remove observation"), [&](Project& project) {
    std::erase_if(project.observations, [&](const Observation& o) { return o.id == id; });
  });
}

void PoseRefinement::setEnabled(ObservationId id, bool enabled) {
  m_session.change(enabled ? tr("Use observation") : tr("Leave observation out"), [&](Project& project) {
    for (Observation& o : project.observations)
      if (o.id == id) o.enabled = enabled;
  });
}

void PoseRefinement::setHeldOut(ObservationId id, bool heldOut) {
  m_session.change(heldOut ? tr("Hold observation out as a check") : tr("Fit observation"), [&](Project& project) {
    for (Observation& o : project.observations)
      if (o.id == id) o.heldOut = heldOut;
  });
}

void PoseRefinement::matchInOtherFrames(ObservationId id) {
  const auto project = m_session.project();
  const auto seen = std::find_if(project->observations.begin(), project->observations.end(),
                                 [&](const Observation& o) { return o.id == id; });
  if (seen == project->observations.end()) return;
  m_session.jobs().run(
      tr("Looking for %1 in other frames").arg(text(seen->name)),
      [project, observation = *seen](const Progress& progress) {
        PictureCache pictures(2);
        return alidade::matchInOtherFrames(*project, observation, pictures, progress);
      },
      [this, name = text(seen->name)](Result<MatchedObservations> made) {
        if (!made) return m_session.messages().error(made.error());
        for (const std::string& note : made->notes) m_session.messages().info(tr("%1 not found in %2").arg(name, text(note)));
        m_session.messages().info(tr("%1 found in %2 other frames").arg(name).arg(made->observations.size()));
        if (made->observations.empty()) return;
        m_session.change(tr("Observe %1 in %2 frames").arg(name).arg(made->observations.size()), [&](Project& changed) {
          // Others may have come since the job began.
          ObservationId next = nextObservationId(changed);
          for (Observation found : made->observations) {
            found.id = next, ++next.value;
            changed.observations.push_back(std::move(found));
          }
        });
      });
}

void PoseRefinement::setScope(RefinementScope scope) {
  if (std::exchange(m_scope, scope) != scope) emit changed();
}

void PoseRefinement::setJudgedAt(std::optional<glm::dvec3> world) {
  m_judgedAt = world;
  emit changed();
}

/// Works on a copy of the project; `take` keeps the outcome and says whether its poses are proposed. What belongs to a
/// project that was changed meanwhile is dropped.
template <class Work, class Take>
void PoseRefinement::start(const QString& name, Work work, Take take) {
  using Outcome = typename std::invoke_result_t<Work, Project&, const Progress&>::value_type;
  struct Finished {
    Outcome outcome;
    std::shared_ptr<const Project> project;
  };
  m_running = true;
  emit changed();
  m_session.jobs().run(
      name,
      [work = std::move(work), base = m_session.project()](const Progress& progress) -> Result<Finished> {
        Project copy = *base;
        auto outcome = work(copy, progress);
        if (!outcome) return fail(outcome.error());
        return Finished{std::move(*outcome), std::make_shared<const Project>(std::move(copy))};
      },
      [this, name, take = std::move(take), base = m_session.project()](Result<Finished> finished) {
        m_running = false;
        if (!finished) {
          m_session.messages().error(finished.error());
        } else if (m_session.project() == base) {
          forgetSummaries();
          if (take(std::move(finished->outcome))) propose(base, finished->project, name);
        }
        emit changed();
      });
}

void PoseRefinement::refine() {
  if (m_running || !m_session.currentFrame()) return;
  RefineTask task;
  task.freedom = m_freedom;
  task.frame = m_session.currentFrame()->name;
  task.rows = observationRowsOf(*m_session.project(), m_scope == RefinementScope::Frame ? m_session.frame() : FrameId());
  glm::dvec3 middle(0);
  double points = 0;
  for (const ObservationRow& row : task.rows)
    if (row.kind != ObservationKind::Depth && row.world) middle = glm::mix(middle, *row.world, 1 / ++points);
  // The expected millimetres are wanted where the work is.
  task.judgedAt = m_judgedAt.value_or(middle);
  const QString name = m_scope == RefinementScope::Frame ? tr("Refine pose of %1").arg(text(task.frame)) : tr("Refine poses");
  start(
      name, [task](Project& project, const Progress& progress) { return run(task, project, progress); },
      [this](RefineOutcome outcome) {
        m_summary = std::move(outcome.summary);
        m_frameNames = std::move(outcome.frameNames);
        m_outliers = std::move(outcome.outliers);
        return m_summary->converged;
      });
}

void PoseRefinement::alignAutomatically() {
  if (m_running || !m_session.currentFrame()) return;
  const AlignTo target = alignmentTarget(*m_session.project());
  const QString name = (target == AlignTo::Scans ? tr("Align %1 with the scan") : tr("Align %1 with the design"))
                           .arg(text(m_session.currentFrame()->name));
  start(
      name,
      [target, data = m_session.data(), frame = m_session.frame()](Project& project, const Progress& progress) {
        PictureCache pictures(1);
        return autoAlignFrame(project, alignmentScene(project, *data, target), pictures, frame, {}, false, progress);
      },
      [this](AlignmentSummary summary) {
        m_alignment = std::move(summary);
        return m_alignment->converged;
      });
}

void PoseRefinement::alignSequence() {
  if (m_running || m_session.project()->frames.empty()) return;
  start(
      tr("Align all frames"),
      [data = m_session.data(), at = m_judgedAt](Project& project, const Progress& progress) {
        SequenceOptions options;
        if (at) options.at.push_back(*at);
        options.everyNth = std::max(1, static_cast<int>(project.frames.size()) / kMostKeyframes);
        PictureCache pictures(2);
        return refineSequence(project, alignmentScene(project, *data, alignmentTarget(project)), pictures, options, false, progress);
      },
      [this](SequenceSummary summary) {
        m_sequence = std::move(summary);
        m_summary = m_sequence->adjustment;
        for (const NetworkFrame& frame : m_sequence->network.frames) m_frameNames.push_back(frame.name);
        return m_sequence->converged;
      });
}

void PoseRefinement::propose(std::shared_ptr<const Project> base, std::shared_ptr<const Project> candidate, const QString& name) {
  m_base = std::move(base);
  m_candidate = std::move(candidate);
  m_candidateName = name;
  showCandidate();
}

void PoseRefinement::showCandidate() {
  const Frame* frame = m_candidate ? m_candidate->findFrame(m_session.frame()) : nullptr;
  const Frame* shown = m_session.currentFrame();
  const bool differs = frame && shown && frame->cameraFromWorld && !samePose(frame->cameraFromWorld, shown->cameraFromWorld);
  m_session.setCandidate(differs ? std::optional(*frame) : std::nullopt);
  emit changed();
}

void PoseRefinement::accept() {
  if (!m_candidate) return;
  const auto candidate = std::exchange(m_candidate, nullptr);
  m_session.setCandidate(std::nullopt);
  m_session.change(m_candidateName, [&](Project& project) { apply(*m_base, *candidate, project); });
  emit changed();
}

void PoseRefinement::drop() {
  forget();
  m_session.setCandidate(std::nullopt);
}

void PoseRefinement::forget() {
  m_candidate.reset();
  forgetSummaries();
  emit changed();
}

void PoseRefinement::forgetSummaries() {
  m_summary.reset();
  m_alignment.reset();
  m_sequence.reset();
  m_frameNames.clear();
  m_outliers.clear();
}

std::optional<ExpectedError> PoseRefinement::expectedHere() const {
  const Frame* frame = m_session.currentFrame();
  const auto name = frame ? std::find(m_frameNames.begin(), m_frameNames.end(), frame->name) : m_frameNames.end();
  if (!m_summary || name == m_frameNames.end()) return std::nullopt;
  const auto index = static_cast<std::size_t>(name - m_frameNames.begin());
  return index < m_summary->expected.size() ? std::optional(m_summary->expected[index]) : std::nullopt;
}

std::optional<double> PoseRefinement::residualM(const Observation& observation) const {
  return depthResidualM(m_candidate ? *m_candidate : *m_session.project(), observation);
}

std::optional<glm::dvec2> PoseRefinement::residual(const Observation& observation) const {
  const Project& project = m_candidate ? *m_candidate : *m_session.project();
  const Frame* frame = project.findFrame(observation.frame);
  const CameraRecord* camera = frame ? project.findCamera(frame->camera) : nullptr;
  if (!camera || !frame->cameraFromWorld || !observation.hasPixel()) return std::nullopt;
  const auto pixel = fittedPixel(camera->camera, shutterOf(project, *frame), *frame->cameraFromWorld, observation);
  if (!pixel) return std::nullopt;
  return *pixel - observation.pixel;
}

}  // namespace alidade

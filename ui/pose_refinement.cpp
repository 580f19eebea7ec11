// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/pose_refinement.h"

#include <algorithm>

#include "ui/format.h"

namespace alidade {

namespace {

struct RefineOutcome {
  ResectionSummary summary;
  Frame frame;
};

}  // namespace

PoseRefinement::PoseRefinement(Session& session, QObject* parent) : QObject(parent), m_session(session) {
  connect(&session, &Session::frameChanged, this, &PoseRefinement::forget);
  connect(&session, &Session::structureChanged, this, &PoseRefinement::forget);
  connect(&session, &Session::projectChanged, this, &PoseRefinement::changed);
}

std::vector<Observation> PoseRefinement::observations() const {
  std::vector<Observation> own;
  for (const Observation& o : m_session.project()->observations)
    if (o.frame == m_session.frame()) own.push_back(o);
  return own;
}

void PoseRefinement::add(const glm::dvec2& pixel, const glm::dvec3& world, const QString& name) {
  m_session.change(tr("Add observation %1").arg(name), [&](Project& project) {
    Observation o;
    for (const Observation& other : project.observations) o.id.value = std::max(o.id.value, other.id.value);
    ++o.id.value;
    o.frame = m_session.frame();
    o.pixel = pixel;
    o.world = world;
    o.name = name.toStdString();
    project.observations.push_back(o);
  });
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

void PoseRefinement::refine() {
  if (m_running || !m_session.currentFrame()) return;
  std::vector<ResectionObservation> used;
  for (const Observation& o : observations())
    if (o.enabled) used.push_back({o.pixel, o.world, o.sigmaPx, o.name});
  ResectionOptions options = m_options;
  // The expected millimetres are wanted where the work is: at the middle of the observed points.
  glm::dvec3 middle(0);
  for (const auto& o : used) middle += o.world / static_cast<double>(used.size());
  if (!used.empty()) options.at = {middle};
  const FrameId frame = m_session.frame();
  const auto project = m_session.project();
  m_running = true;
  emit changed();
  m_session.jobs().run(
      tr("Refining the pose of %1").arg(text(m_session.currentFrame()->name)),
      [project, frame, used, options](const Progress&) -> Result<RefineOutcome> {
        Project copy = *project;
        auto summary = refineFrame(copy, frame, used, options, false);
        if (!summary) return fail(summary.error());
        return RefineOutcome{std::move(*summary), *copy.findFrame(frame)};
      },
      [this, frame](Result<RefineOutcome> outcome) {
        m_running = false;
        if (!outcome) {
          m_session.messages().error(outcome.error());
        } else if (frame == m_session.frame()) {
          m_summary = std::move(outcome->summary);
          if (m_summary->converged) {
            m_candidate = std::move(outcome->frame);
            m_session.setCandidatePose(m_candidate->cameraFromWorld);
          }
        }
        emit changed();
      });
}

void PoseRefinement::accept() {
  if (!m_candidate) return;
  const Frame candidate = *std::exchange(m_candidate, std::nullopt);
  m_session.setCandidatePose(std::nullopt);
  m_session.change(tr("Refine pose of %1").arg(text(candidate.name)), [&](Project& project) {
    if (Frame* frame = project.findFrame(candidate.id)) *frame = candidate;
  });
  emit changed();
}

void PoseRefinement::drop() {
  m_candidate.reset();
  m_summary.reset();
  m_session.setCandidatePose(std::nullopt);
  emit changed();
}

void PoseRefinement::forget() {
  m_candidate.reset();
  m_summary.reset();
  emit changed();
}

std::optional<glm::dvec2> PoseRefinement::residual(const Observation& observation) const {
  const Frame* frame = m_session.currentFrame();
  const CameraRecord* camera = m_session.currentCamera();
  if (!frame || !camera) return std::nullopt;
  const auto& pose = m_session.candidatePose() ? m_session.candidatePose() : frame->cameraFromWorld;
  if (!pose) return std::nullopt;
  const auto pixel = camera->camera.project(*pose * observation.world);
  if (!pixel) return std::nullopt;
  return *pixel - observation.pixel;
}

}  // namespace alidade

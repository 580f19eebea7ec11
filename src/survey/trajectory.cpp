// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/trajectory.h"

#include <algorithm>
#include <cmath>

namespace alidade {

std::string poseGapText(PoseGap gap) {
  switch (gap) {
    case PoseGap::NoSamples: return "the trajectory is empty";
    case PoseGap::BeforeStart: return "before the trajectory starts";
    case PoseGap::AfterEnd: return "after the trajectory ends";
    case PoseGap::Interrupted: return "the trajectory is interrupted there";
  }
  return {};
}

PoseTrack::PoseTrack(std::vector<PoseSample> samples) {
  std::erase_if(samples, [](const PoseSample& s) { return !std::isfinite(s.timeSecs) || !s.cameraFromWorld.isFinite(); });
  std::stable_sort(samples.begin(), samples.end(),
                   [](const PoseSample& a, const PoseSample& b) { return a.timeSecs < b.timeSecs; });
  const auto sameTime = [](const PoseSample& a, const PoseSample& b) { return a.timeSecs == b.timeSecs; };
  const auto kept = std::unique(samples.rbegin(), samples.rend(), sameTime);
  samples.erase(samples.begin(), kept.base());
  std::vector<double> steps;
  for (std::size_t i = 1; i < samples.size(); ++i) steps.push_back(samples[i].timeSecs - samples[i - 1].timeSecs);
  if (!steps.empty()) {
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    m_step = *middle;
  }
  m_samples = std::make_shared<const std::vector<PoseSample>>(std::move(samples));
}

const std::vector<PoseSample>& PoseTrack::samples() const {
  static const std::vector<PoseSample> none;
  return m_samples ? *m_samples : none;
}

PoseTrack::Answer PoseTrack::at(double timeSecs) const {
  const auto& all = samples();
  if (all.empty() || !std::isfinite(timeSecs)) return {std::nullopt, PoseGap::NoSamples};
  const double slack = 1e-3 * std::min(1.0, m_step) + 0.01 * m_step;
  const auto after = std::lower_bound(all.begin(), all.end(), timeSecs,
                                      [](const PoseSample& s, double t) { return s.timeSecs < t; });
  if (after == all.end()) {
    if (timeSecs - all.back().timeSecs <= slack) return {all.back().cameraFromWorld};
    return {std::nullopt, PoseGap::AfterEnd};
  }
  if (after->timeSecs == timeSecs) return {after->cameraFromWorld};
  if (after == all.begin()) {
    if (all.front().timeSecs - timeSecs <= slack) return {all.front().cameraFromWorld};
    return {std::nullopt, PoseGap::BeforeStart};
  }
  const PoseSample& a = *(after - 1);
  const PoseSample& b = *after;
  const double step = b.timeSecs - a.timeSecs;
  if (step > longestStepSecs()) return {std::nullopt, PoseGap::Interrupted};
  return {interpolateOnScrew(a.cameraFromWorld, b.cameraFromWorld, (timeSecs - a.timeSecs) / step)};
}

std::optional<Twist> PoseTrack::motionAt(double timeSecs, double spanSecs) const {
  if (!(spanSecs > 0)) return std::nullopt;
  // At an end the velocity of the side that is there.
  double from = timeSecs - 0.5 * spanSecs, to = timeSecs + 0.5 * spanSecs;
  auto before = at(from), after = at(to);
  if (!before.cameraFromWorld) before = at(from = timeSecs);
  if (!after.cameraFromWorld) after = at(to = timeSecs);
  if (!before.cameraFromWorld || !after.cameraFromWorld || !(to > from)) return std::nullopt;
  // Relative to one centre, see interpolateOnScrew.
  const glm::dvec3 origin = before.cameraFromWorld->centre();
  const RigidTransform nearBefore{before.cameraFromWorld->rotation, glm::dvec3(0)};
  const RigidTransform nearAfter{after.cameraFromWorld->rotation, *after.cameraFromWorld * origin};
  return logarithm(nearAfter * nearBefore.inverse()) * (1.0 / (to - from));
}

}  // namespace alidade

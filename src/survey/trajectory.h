// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/rigid_transform.h"
#include "geometry/twist.h"

namespace alidade {

struct PoseSample {
  double timeSecs = 0;  ///< on the trajectory's own clock
  RigidTransform cameraFromWorld;
};

/// Why a trajectory gives no pose.
enum class PoseGap { NoSamples, BeforeStart, AfterEnd, Interrupted };
std::string poseGapText(PoseGap gap);

/// Poses over time, between the samples on the constant screw that joins them. Never beyond the ends (but for a
/// hundredth of a step), never across an interruption: a tracker that lost its way. Immutable, cheap to copy.
class PoseTrack {
 public:
  PoseTrack() = default;
  /// Sorts by time; of samples of one time the last stays. Samples that are not finite are left out.
  explicit PoseTrack(std::vector<PoseSample> samples);

  const std::vector<PoseSample>& samples() const;
  bool empty() const { return samples().empty(); }
  double medianStepSecs() const { return m_step; }
  /// A gap longer than this interrupts: three median steps.
  double longestStepSecs() const { return 3 * m_step; }

  /// cameraFromWorld, or the reason why there is none.
  struct Answer {
    std::optional<RigidTransform> cameraFromWorld;
    PoseGap gap = PoseGap::NoSamples;  ///< where there is no pose
  };
  Answer at(double timeSecs) const;

  /// The camera's velocity in its own axes, from the poses `spanSecs` around: pInCamera(t + dt) =
  /// exp(motion dt) pInCamera(t). Nothing where a pose is missing.
  std::optional<Twist> motionAt(double timeSecs, double spanSecs) const;

 private:
  std::shared_ptr<const std::vector<PoseSample>> m_samples;
  double m_step = 0;
};

}  // namespace alidade

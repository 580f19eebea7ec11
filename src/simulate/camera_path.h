// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "camera/camera.h"
#include "geometry/rigid_transform.h"
#include "simulate/site_model.h"

namespace alidade {

constexpr double kFramesPerSecond = 15.0;

/// A wide-angle machine-vision camera with plain barrel distortion (OpenCV's five coefficients), scaled to
/// the picture's width.
Intrinsics demoIntrinsics(int width, int height);

/// A person who walks along the building's front with the camera in hand, back and forth.
class Walk {
 public:
  explicit Walk(std::uint32_t seed);
  ~Walk();
  /// cameraFromSite.
  RigidTransform at(double seconds) const;

 private:
  struct Wanders;
  std::uint32_t m_seed;
  std::unique_ptr<const Wanders> m_wanders;
};

/// Its pose at each frame: the same way whatever the number of frames.
std::vector<RigidTransform> walkPast(int frames, std::uint32_t seed);

/// Poses that are off by about 2 cm and 0.2 degrees, as a tracker gives them.
std::vector<RigidTransform> perturbed(const std::vector<RigidTransform>& cameraFromWorld, std::uint32_t seed);

}  // namespace alidade

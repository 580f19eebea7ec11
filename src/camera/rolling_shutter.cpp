// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "camera/rolling_shutter.h"

#include <algorithm>
#include <cmath>

namespace alidade {

std::optional<glm::dvec3> pointAtItsRow(const Camera& camera, const RollingShutter& shutter, const glm::dvec3& pInCamera) {
  if (!shutter.isOn()) return pInCamera;
  constexpr int kMostSteps = 30;
  constexpr double kSettledPx = 1e-3;
  // A point beside the picture is held to its nearest row: the motion is not carried on for longer than the frame.
  const double top = -0.5 * camera.height(), bottom = 1.5 * camera.height();
  double row = 0.5 * (camera.height() - 1);
  glm::dvec3 p = pInCamera;
  for (int step = 0; step < kMostSteps; ++step) {
    const auto pixel = camera.project(p);
    if (!pixel) return std::nullopt;
    const double next = std::clamp(pixel->y, top, bottom), change = std::abs(next - row);
    row = next;
    if (change < kSettledPx) return p;
    p = exponential(shutter.motion * shutter.secsAtRow(row, camera.height())) * pInCamera;
  }
  return std::nullopt;
}

std::optional<glm::dvec2> project(const Camera& camera, const RollingShutter& shutter, const glm::dvec3& pInCamera) {
  const auto p = pointAtItsRow(camera, shutter, pInCamera);
  return p ? camera.project(*p) : std::nullopt;
}

}  // namespace alidade

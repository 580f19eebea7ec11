// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "inspect/hit.h"

#include <cmath>
#include <numbers>

namespace alidade {

std::optional<Hit> hitAt(const DepthImage& scanDepth, const Camera& camera, const RigidTransform& cameraFromWorld,
                         const glm::dvec2& pixel, const HitUncertainty& uncertainty) {
  if (!std::isfinite(pixel.x) || !std::isfinite(pixel.y) || !camera.inPicture(pixel)) return std::nullopt;
  const int x = static_cast<int>(std::lround(pixel.x)), y = static_cast<int>(std::lround(pixel.y));
  if (!scanDepth.contains(x, y)) return std::nullopt;
  const double z = scanDepth.at(x, y);
  if (!std::isfinite(z)) return std::nullopt;
  const auto ray = camera.unproject(pixel);
  if (!ray) return std::nullopt;

  Hit hit;
  const glm::dvec3 inCamera = *ray * z;
  hit.world = cameraFromWorld.inverse() * inCamera;
  hit.depthM = z;
  hit.distanceM = glm::length(inCamera);
  if (uncertainty.pose) {
    const double position = glm::length(uncertainty.pose->positionStdM);
    const double rotation = glm::length(uncertainty.pose->rotationStdRad) * hit.distanceM;
    const double sampling = uncertainty.scanSpacingM / std::sqrt(12.0);  // uniform within one spacing
    hit.sigmaM = std::sqrt(position * position + rotation * rotation + sampling * sampling);
  }
  return hit;
}

Measurement measure(const Hit& from, const Hit& to) {
  const glm::dvec3 delta = to.world - from.world;
  Measurement result;
  result.slopeM = glm::length(delta);
  result.horizontalM = std::hypot(delta.x, delta.y);
  result.heightM = delta.z;
  result.azimuthRad = std::atan2(delta.x, delta.y);
  if (result.azimuthRad < 0) result.azimuthRad += 2 * std::numbers::pi;
  if (from.sigmaM && to.sigmaM) result.sigmaM = std::hypot(*from.sigmaM, *to.sigmaM);
  return result;
}

StakeOutDelta stakeOutDelta(const StakePoint& design, const glm::dvec3& asBuilt) {
  StakeOutDelta delta;
  delta.deltaM = asBuilt - design.position;
  delta.horizontalM = std::hypot(delta.deltaM.x, delta.deltaM.y);
  delta.cutM = delta.deltaM.z;
  delta.within = delta.horizontalM <= design.toleranceM;
  return delta;
}

}  // namespace alidade

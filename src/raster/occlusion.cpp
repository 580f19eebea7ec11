// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/occlusion.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "raster/splat_pass.h"
#include "raster/surface_fill.h"

namespace alidade {

namespace {

/// Spacing times focal length as the payload carries it: log2 in steps of 2^-13, above the place in the
/// pixel.
std::uint32_t spacingCode(double pixelMeters) {
  const double code = std::round((std::log2(std::max(pixelMeters, 1e-9)) + 32.0) * 8192.0);
  return static_cast<std::uint32_t>(std::clamp(code, 0.0, 1048575.0)) << PlaceInPixel::kBits;
}

float decodedSpacing(std::uint32_t payload) {
  return std::exp2(static_cast<float>(payload >> PlaceInPixel::kBits) / 8192.0f - 32.0f);
}

/// The nearest dot a pixel, with its surface's spacing in pixels.
DotImage drawDots(const std::vector<SplatLayer>& layers, const Camera& camera,
                  const RigidTransform& cameraFromWorld) {
  SplatOptions options;
  options.maximumSizePx = 1.0;
  const SplatView base = baseView(camera, options);
  const double focal = std::sqrt(std::abs(camera.intrinsics().fx * camera.intrinsics().fy));
  std::vector<SplatRun> runs;
  for (const SplatLayer& layer : layers) {
    if (!layer.store) continue;
    for (const SelectedRange& range : layer.selection.ranges) {
      runs.push_back(makeRun(*layer.store, range, cameraFromWorld, base, options));
      runs.back().payloadBase = spacingCode(range.spacing * focal);
    }
  }
  DotImage dots(camera.width(), camera.height());
  const auto merge = [&](const SplatPlanes<std::uint64_t>& planes, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::uint64_t pixel = planes.nearest(i);
      const float z = std::bit_cast<float>(static_cast<std::uint32_t>(pixel >> 32));
      if (!(z > 0.0f)) continue;
      dots.inverseDepth.data()[i] = 1.0f / z;
      const auto payload = static_cast<std::uint32_t>(pixel);
      dots.spacingPx.data()[i] = decodedSpacing(payload) / z;
      dots.place.data()[i] = static_cast<std::uint16_t>(payload & ((1u << PlaceInPixel::kBits) - 1));
    }
  };
  drawRuns(runs, camera.width(), camera.height(), SplatPayload::Place, {}, merge);
  return dots;
}

}  // namespace

OcclusionDepth occlusionDepth(const std::vector<SplatLayer>& layers, const Camera& camera,
                              const RigidTransform& cameraFromWorld) {
  OcclusionDepth occlusion;
  if (camera.width() <= 0 || camera.height() <= 0) return occlusion;
  DotImage dots = drawDots(layers, camera, cameraFromWorld);
  removeHiddenDots(dots);
  peelToFront(dots);
  fillBetweenDots(dots);
  for (const SplatLayer& layer : layers) occlusion.pointsDrawn += layer.selection.pointCount;
  occlusion.depth = DepthImage(camera.width(), camera.height());
  parallelFor(occlusion.depth.size(), 1 << 16, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      const float w = dots.inverseDepth.data()[i];
      occlusion.depth.data()[i] = w > 0.0f ? 1.0f / w : std::numeric_limits<float>::quiet_NaN();
    }
  });
  return occlusion;
}

Visibility visibilityAt(const DepthImage& occlusion, const glm::dvec2& pixel, double z, double toleranceM) {
  const glm::dvec2 nearest = glm::floor(pixel + 0.5);
  const bool inside = z > 0.0 && nearest.x >= 0.0 && nearest.y >= 0.0 && nearest.x < occlusion.width() &&
                      nearest.y < occlusion.height();
  if (!inside) return Visibility::Outside;
  const double depth = occlusion.at(static_cast<int>(nearest.x), static_cast<int>(nearest.y));
  if (std::isnan(depth)) return Visibility::Unknown;
  return z <= depth + toleranceM + 0.0005 * z ? Visibility::Visible : Visibility::Hidden;
}

}  // namespace alidade

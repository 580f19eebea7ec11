// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/occlusion.h"

#include <bit>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "raster/splat_pass.h"
#include "raster/surface_fill.h"

namespace alidade {

namespace {

/// The nearest dot a pixel, with its surface's spacing in pixels.
DotImage drawDots(const std::vector<SplatLayer>& layers, const Camera& camera,
                  const RigidTransform& cameraFromWorld) {
  SplatOptions options;
  options.maximumSizePx = 1.0;
  const SplatView base = baseView(camera, options);
  const auto focal = static_cast<float>(std::sqrt(std::abs(camera.intrinsics().fx * camera.intrinsics().fy)));
  std::vector<SplatRun> runs;
  std::vector<float> spacing;
  for (const SplatLayer& layer : layers) {
    if (!layer.store) continue;
    for (const SelectedRange& range : layer.selection.ranges) {
      runs.push_back(makeRun(*layer.store, range, cameraFromWorld, base, options));
      runs.back().payloadBase = static_cast<std::uint32_t>(spacing.size());
      spacing.push_back(static_cast<float>(range.spacing) * focal);
    }
  }
  DotImage dots{Image<float>(camera.width(), camera.height()), Image<float>(camera.width(), camera.height())};
  const auto merge = [&](const SplatPlanes<std::uint64_t>& planes, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::uint64_t pixel = planes.nearest(i);
      const float z = std::bit_cast<float>(static_cast<std::uint32_t>(pixel >> 32));
      if (!(z > 0.0f)) continue;
      dots.inverseDepth.data()[i] = 1.0f / z;
      dots.spacingPx.data()[i] = spacing[static_cast<std::uint32_t>(pixel)] / z;
    }
  };
  drawRuns(runs, camera.width(), camera.height(), SplatPayload::Constant, {}, merge);
  return dots;
}

}  // namespace

OcclusionDepth occlusionDepth(const std::vector<SplatLayer>& layers, const Camera& camera,
                              const RigidTransform& cameraFromWorld) {
  OcclusionDepth occlusion;
  if (camera.width() <= 0 || camera.height() <= 0) return occlusion;
  DotImage dots = drawDots(layers, camera, cameraFromWorld);
  removeHiddenDots(dots);
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

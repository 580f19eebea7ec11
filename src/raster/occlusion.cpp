// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/occlusion.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "raster/mesh_pass.h"
#include "raster/splat_merge.h"
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

/// Points nearer to each other on screen than so many pixels tell nothing that four a pixel do not.
constexpr double kFinestSpacingPx = 0.5;

/// The part of a range that gives that spacing where the node is nearest; points of a range are in the order
/// of their levels, so that a prefix is evenly spaced.
SelectedRange thinned(const PointStore& store, const SelectedRange& range, double focal,
                      const RigidTransform& cameraFromWorld) {
  const double nearest = nearestDepth(store.nodes()[range.node].bounds, cameraFromWorld);
  const double finest = kFinestSpacingPx * nearest / focal;
  if (!(range.spacing > 0.0) || range.spacing >= finest) return range;
  const double share = range.spacing * range.spacing / (finest * finest);
  SelectedRange part = range;
  part.count = static_cast<std::uint32_t>(std::ceil(share * range.count));
  part.spacing = finest;
  return part;
}

/// The nearest dot a pixel, with its surface's spacing in pixels.
DotImage drawDots(const std::vector<SplatLayer>& layers, const Camera& camera,
                  const RigidTransform& cameraFromWorld, std::uint64_t& drawn) {
  SplatOptions options;
  options.maximumSizePx = 1.0;
  const SplatView base = baseView(camera, options);
  const double focal = std::sqrt(std::abs(camera.intrinsics().fx * camera.intrinsics().fy));
  std::vector<SplatRun> runs;
  for (const SplatLayer& layer : layers) {
    if (!layer.store) continue;
    for (const SelectedRange& selected : layer.selection.ranges) {
      const SelectedRange range = thinned(*layer.store, selected, focal, cameraFromWorld);
      drawn += range.count;
      runs.push_back(makeRun(*layer.store, range, cameraFromWorld, base, options));
      runs.back().payloadBase = spacingCode(range.spacing * focal);
    }
  }
  DotImage dots(camera.width(), camera.height());
  const auto merge = [&](const SplatPlanes<std::uint64_t>& planes, const SplatLevels&, const LevelSurface*, int first, int last) {
    const auto width = static_cast<std::size_t>(camera.width());
    for (int y = first; y < last; ++y) {
      takeNearest(planes, static_cast<std::size_t>(y) * width, width, [&](std::size_t at, std::size_t count, const std::uint64_t* pixels) {
        for (std::size_t i = 0; pixels != nullptr && i < count; ++i) {
          const float z = std::bit_cast<float>(static_cast<std::uint32_t>(pixels[i] >> 32));
          if (!(z > 0.0f)) continue;
          const int x = static_cast<int>(at + i);
          dots.inverseDepth.at(x, y) = 1.0f / z;
          const auto payload = static_cast<std::uint32_t>(pixels[i]);
          dots.spacingPx.at(x, y) = decodedSpacing(payload) / z;
          dots.place.at(x, y) = static_cast<std::uint16_t>(payload & ((1u << PlaceInPixel::kBits) - 1));
        }
      });
    }
  };
  drawRuns(runs, camera.width(), camera.height(), {.payload = SplatPayload::Place}, {}, merge);
  return dots;
}

/// Inverse depth, 0 where unknown.
Image<float> surfacesOf(const std::vector<SplatLayer>& layers, const Camera& camera,
                        const RigidTransform& cameraFromWorld, std::uint64_t& drawn) {
  DotImage dots = drawDots(layers, camera, cameraFromWorld, drawn);
  removeHiddenDots(dots);
  peelToFront(dots);
  fillBetweenDots(dots);
  return std::move(dots.inverseDepth);
}

}  // namespace

OcclusionDepth occlusionDepth(const Occluders& occluders, const Camera& camera,
                              const RigidTransform& cameraFromWorld) {
  OcclusionDepth occlusion;
  if (camera.width() <= 0 || camera.height() <= 0) return occlusion;
  Image<float> inverse = drawMeshes(occluders.meshes, camera, cameraFromWorld);
  std::uint64_t selected = 0;
  for (const SplatLayer& layer : occluders.layers) selected += layer.selection.pointCount;
  if (selected > 0) {
    const Image<float> surfaces = surfacesOf(occluders.layers, camera, cameraFromWorld, occlusion.pointsDrawn);
    for (std::size_t i = 0; i < inverse.size(); ++i)
      inverse.data()[i] = std::max(inverse.data()[i], surfaces.data()[i]);
  }
  occlusion.depth = DepthImage(camera.width(), camera.height(), Uncleared{});
  parallelFor(occlusion.depth.size(), 1 << 16, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      const float w = inverse.data()[i];
      occlusion.depth.data()[i] = w > 0.0f ? 1.0f / w : std::numeric_limits<float>::quiet_NaN();
    }
  });
  return occlusion;
}

OcclusionDepth occlusionDepth(const std::vector<SplatLayer>& layers, const Camera& camera,
                              const RigidTransform& cameraFromWorld) {
  return occlusionDepth(Occluders{layers, {}}, camera, cameraFromWorld);
}

OcclusionDepth squareOcclusionDepth(const std::vector<SplatLayer>& layers, const Camera& camera,
                                    const RigidTransform& cameraFromWorld, double sizePx) {
  SplatImages images = splat(layers, camera, cameraFromWorld, {.pointSize = sizePx, .fixedSize = true});
  for (std::size_t i = 0; i < images.depth.size(); ++i) {
    float& z = images.depth.data()[i];
    if (std::isinf(z)) z = std::numeric_limits<float>::quiet_NaN();
  }
  return {std::move(images.depth), images.drawn};
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

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/splatter.h"

#include <bit>
#include <limits>

#include "raster/splat_pass.h"

namespace alidade {

namespace {

/// Layers [first, last) whose points together count below 2^32, so that 32 bits name one.
struct LayerGroup {
  std::size_t first = 0;
  std::size_t last = 0;
  std::uint64_t pointsBefore = 0;
};

std::vector<LayerGroup> groupsOf(const std::vector<SplatLayer>& layers) {
  std::vector<LayerGroup> groups;
  std::uint64_t before = 0, inGroup = 0;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const std::uint64_t count = layers[i].store ? layers[i].store->pointCount() : 0;
    if (groups.empty() || inGroup + count >= std::numeric_limits<std::uint32_t>::max()) {
      groups.push_back({i, i, before});
      inGroup = 0;
    }
    groups.back().last = i + 1;
    inGroup += count;
    before += count;
  }
  return groups;
}

Rgba8 colourOf(std::uint32_t rgb565) {
  const std::uint32_t r = rgb565 >> 11 & 31, g = rgb565 >> 5 & 63, b = rgb565 & 31;
  return {static_cast<std::uint8_t>(r << 3 | r >> 2), static_cast<std::uint8_t>(g << 2 | g >> 4),
          static_cast<std::uint8_t>(b << 3 | b >> 2), 255};
}

/// Looks a group's point up again: for colour where ids were asked for as well.
class GroupPoints {
 public:
  GroupPoints(const std::vector<SplatLayer>& layers, const LayerGroup& group) {
    for (std::size_t i = group.first; i < group.last; ++i) {
      m_points.push_back(layers[i].store ? layers[i].store->points() : std::span<const DisplayPoint>());
    }
  }

  std::uint16_t colour(std::uint64_t index) const {
    std::size_t layer = 0;
    while (index >= m_points[layer].size()) index -= m_points[layer++].size();
    return m_points[layer][index].rgb565;
  }

 private:
  std::vector<std::span<const DisplayPoint>> m_points;
};

std::vector<SplatRun> runsOf(const std::vector<SplatLayer>& layers, const LayerGroup& group,
                             const Camera& camera, const RigidTransform& cameraFromWorld,
                             const SplatOptions& options) {
  std::vector<SplatRun> runs;
  const SplatView base = baseView(camera, options);
  std::uint64_t before = 0;
  for (std::size_t i = group.first; i < group.last; ++i) {
    if (!layers[i].store) continue;
    for (const SelectedRange& range : layers[i].selection.ranges) {
      runs.push_back(makeRun(*layers[i].store, range, cameraFromWorld, base, options));
      runs.back().payloadBase = static_cast<std::uint32_t>(before + range.first);
    }
    before += layers[i].store->pointCount();
  }
  return runs;
}

void splatGroup(const std::vector<SplatLayer>& layers, const LayerGroup& group, const Camera& camera,
                const RigidTransform& cameraFromWorld, const SplatOptions& options, SplatImages& images) {
  std::vector<SplatRun> runs = runsOf(layers, group, camera, cameraFromWorld, options);
  const std::vector<CellNormals> normals = options.planar && !options.fixedSize
                                               ? layFootprints(runs, cameraFromWorld)
                                               : std::vector<CellNormals>();
  const GroupPoints points(layers, group);
  const SplatPayload payload = options.ids      ? SplatPayload::Index
                               : options.colour ? SplatPayload::Colour
                                                : SplatPayload::None;
  float* depth = images.depth.data();
  const auto mergeDepth = [&](const SplatPlanes<std::uint32_t>& planes, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const float z = std::bit_cast<float>(planes.nearest(i));
      if (z < depth[i]) depth[i] = z;
    }
  };
  const auto mergePacked = [&](const SplatPlanes<std::uint64_t>& planes, std::size_t first,
                               std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::uint64_t pixel = planes.nearest(i);
      const float z = std::bit_cast<float>(static_cast<std::uint32_t>(pixel >> 32));
      if (!(z < depth[i])) continue;  // all ones is a NaN
      depth[i] = z;
      const auto value = static_cast<std::uint32_t>(pixel);
      if (options.ids) images.point.data()[i] = 1 + group.pointsBefore + value;
      if (options.colour) images.colour.data()[i] = colourOf(options.ids ? points.colour(value) : value);
    }
  };
  drawRuns(runs, camera.width(), camera.height(), payload, mergeDepth, mergePacked, options.device);
}

}  // namespace

SplatImages splat(const std::vector<SplatLayer>& layers, const Camera& camera,
                  const RigidTransform& cameraFromWorld, const SplatOptions& options) {
  SplatImages images;
  const int width = camera.width(), height = camera.height();
  if (width <= 0 || height <= 0) return images;
  images.depth = DepthImage(width, height, std::numeric_limits<float>::infinity());
  if (options.colour) images.colour = ColourImage(width, height, Rgba8{0, 0, 0, 0});
  if (options.ids) images.point = Image<std::uint64_t>(width, height, 0);
  for (const SplatLayer& layer : layers) images.drawn += layer.selection.pointCount;
  for (const LayerGroup& group : groupsOf(layers)) {
    splatGroup(layers, group, camera, cameraFromWorld, options, images);
  }
  return images;
}

const char* splatKernelName() {
  return splatKernel().name;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/splatter.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "base/widest.h"
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

/// RGB565 in full bytes, opaque; r in the lowest, as Rgba8 lies in memory.
inline std::uint32_t colourOf(std::uint32_t rgb565) {
  const std::uint32_t r = rgb565 >> 11 & 31, g = rgb565 >> 5 & 63, b = rgb565 & 31;
  return 0xff000000u | (b << 3 | b >> 2) << 16 | (g << 2 | g >> 4) << 8 | (r << 3 | r >> 2);
}
static_assert(sizeof(Rgba8) == 4 && std::endian::native == std::endian::little);

/// +inf where nothing is.
ALIDADE_WIDEST void depthsOf(const float* inverse, std::size_t count, float* depth) {
  for (std::size_t i = 0; i < count; ++i) depth[i] = 1.0f / inverse[i];
}

/// No colour where nothing is.
ALIDADE_WIDEST void coloursOf(const float* inverse, const std::uint32_t* payload, std::size_t count, std::uint32_t* colour) {
  for (std::size_t i = 0; i < count; ++i) colour[i] = inverse[i] > 0.0f ? payload[i] : 0u;
}

/// Takes what is nearer than the depth that is there.
ALIDADE_WIDEST void takeColours(const float* from, const std::uint32_t* colours, std::size_t count, float* depth, std::uint32_t* colour) {
  for (std::size_t i = 0; i < count; ++i) {
    const bool nearer = from[i] < depth[i];
    depth[i] = nearer ? from[i] : depth[i];
    colour[i] = nearer ? colours[i] : colour[i];
  }
}

ALIDADE_WIDEST void takeDepths(const float* from, std::size_t count, float* depth) {
  for (std::size_t i = 0; i < count; ++i) depth[i] = from[i] < depth[i] ? from[i] : depth[i];
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

/// Points as wide as they are apart make a surface; smaller ones, and those of one fixed size, are wanted as points.
bool closesHoles(const SplatOptions& options) {
  return options.closeHoles && !options.fixedSize && options.maximumSizePx > 1.0 && options.pointSize >= 1.0;
}

/// Row by row, just before it is written: faster than the whole pictures before.
void clearRow(SplatImages& images, int y) {
  const int width = images.depth.width();
  std::fill_n(images.depth.row(y), width, std::numeric_limits<float>::infinity());
  if (!images.colour.empty()) std::fill_n(images.colour.row(y), width, Rgba8{0, 0, 0, 0});
  if (!images.point.empty()) std::fill_n(images.point.row(y), width, std::uint64_t{0});
}

void splatGroup(const std::vector<SplatLayer>& layers, const LayerGroup& group, const Camera& camera,
                const RigidTransform& cameraFromWorld, const SplatOptions& options, bool isFirst, SplatImages& images) {
  std::vector<SplatRun> runs = runsOf(layers, group, camera, cameraFromWorld, options);
  const GroupPoints points(layers, group);
  // Surfaces of levels are truer with the places that colours carry.
  const SplatPayload payload = options.ids                              ? SplatPayload::Index
                               : options.colour || usesLevels(options) ? SplatPayload::Colour
                                                                        : SplatPayload::None;
  const int width = camera.width(), height = camera.height();
  const auto rowSize = static_cast<std::size_t>(width);
  const bool closeHoles = closesHoles(options);
  const auto takeIds = [&](const float* from, const std::uint32_t* indices, int y) {
    float* depth = images.depth.row(y);
    for (int x = 0; x < width; ++x) {
      if (!(from[x] < depth[x])) continue;
      depth[x] = from[x];
      const std::uint32_t index = indices[x];
      images.point.at(x, y) = 1 + group.pointsBefore + index;
      if (options.colour) images.colour.at(x, y) = std::bit_cast<Rgba8>(colourOf(points.colour(index)));
    }
  };
  const auto merge = [&](const auto& planes, const SplatLevels& levels, const LevelSurface* coarse, int first, int last) {
    SurfaceRows rows(planes, levels, 0, closeHoles, surfacePayloadOf(payload), coarse);
    std::vector<float> depth(rowSize);
    for (int y = first; y < last; ++y) {
      const SurfaceCells cells = rows.row(y);
      auto* colours = options.colour ? reinterpret_cast<std::uint32_t*>(images.colour.row(y)) : nullptr;
      if (isFirst && !options.ids) {
        depthsOf(cells.inverse, rowSize, images.depth.row(y));
        if (colours) coloursOf(cells.inverse, cells.payload, rowSize, colours);
        continue;
      }
      depthsOf(cells.inverse, rowSize, depth.data());
      if (isFirst) clearRow(images, y);
      if (options.ids) takeIds(depth.data(), cells.payload, y);
      else if (colours) takeColours(depth.data(), cells.payload, rowSize, images.depth.row(y), colours);
      else takeDepths(depth.data(), rowSize, images.depth.row(y));
    }
  };
  const SplatDrawing drawing{payload, closeHoles, options.planar && !options.fixedSize ? &cameraFromWorld : nullptr, usesLevels(options)};
  drawRuns(runs, width, height, drawing, merge, merge, options.device);
}

}  // namespace

SplatImages splat(const std::vector<SplatLayer>& layers, const Camera& camera,
                  const RigidTransform& cameraFromWorld, const SplatOptions& options) {
  SplatImages images;
  const int width = camera.width(), height = camera.height();
  if (width <= 0 || height <= 0) return images;
  images.depth = DepthImage(width, height, Uncleared{});
  if (options.colour) images.colour = ColourImage(width, height, Uncleared{});
  if (options.ids) images.point = Image<std::uint64_t>(width, height, Uncleared{});
  for (const SplatLayer& layer : layers) images.drawn += layer.selection.pointCount;
  const std::vector<LayerGroup> groups = groupsOf(layers);
  for (const LayerGroup& group : groups) splatGroup(layers, group, camera, cameraFromWorld, options, &group == &groups.front(), images);
  for (int y = 0; groups.empty() && y < height; ++y) clearRow(images, y);
  return images;
}

const char* splatKernelName() {
  return splatKernel().name;
}

}  // namespace alidade

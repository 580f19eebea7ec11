// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/store_data.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "cloud/byte_pack.h"

namespace alidade {

/// Nodes above hold the coarser of a surface's points: a quarter an octave, a third of what is here in all.
constexpr double kWithCoarser = 4.0 / 3.0;

PointStoreData storeDataOf(const PartTree& part) {
  PointStoreData data;
  data.lattice = part.lattice;
  data.schema = part.schema;
  data.levelKind = part.tree.kind;
  data.law = part.tree.law;
  data.lawShift = part.tree.lawShift;
  const std::int32_t rootDepth = part.nodes.empty() ? 0 : part.nodes[0].depth;
  const double half = part.lattice.exact == ExactCoordinates::Lattice ? 0.0 : 0.5 * part.lattice.step;
  for (const BuildNode& built : part.nodes) {
    PointStoreData::NodePlace place;
    place.corner = part.lattice.corner + (glm::i64vec3(built.tile) << std::int64_t{16});
    place.firstStep = built.firstBucket;
    place.stepCount = built.bucketCount;
    place.tableOffset = built.tableOffset;
    CloudNode node;
    node.origin = part.lattice.positionOf(place.corner);
    node.step = part.lattice.step;
    node.size = std::ldexp(part.lattice.step * 65536.0, -built.depth);
    if (built.hasBounds()) {
      // Where points are shown at their cells' middle, the source lies up to half a unit away.
      node.bounds.add(part.lattice.positionOf(part.lattice.corner + built.low) - half);
      node.bounds.add(part.lattice.positionOf(part.lattice.corner + built.high) + half);
    }
    node.depth = static_cast<std::uint32_t>(built.depth - rootDepth);
    node.firstChild = built.firstChild;
    node.childCount = built.childCount;
    node.first = built.first;
    node.count = built.count;
    node.spacing = built.spacingUnits * part.lattice.step;
    node.slab = built.slab;
    openUp(node.slab, kWithCoarser * static_cast<double>(built.pointsBelow) * built.spacingUnits * built.spacingUnits);
    node.slab.area = static_cast<float>(built.slab.area * part.lattice.step * part.lattice.step);
    node.slab.along = static_cast<float>(built.slab.along * part.lattice.step);
    node.slab.thickness = static_cast<float>(built.slab.thickness * part.lattice.step);
    data.nodes.push_back(node);
    data.places.push_back(place);
  }
  return data;
}

static_assert(std::endian::native == std::endian::little, "stores are little endian");

std::vector<std::byte> packNodes(const PointStoreData& data) {
  BytePacker out;
  out.bytes.reserve(data.nodes.size() * kNodeBytes);
  for (std::size_t n = 0; n < data.nodes.size(); ++n) {
    const CloudNode& node = data.nodes[n];
    const PointStoreData::NodePlace& place = data.places[n];
    out.put(node.origin), out.put(node.step), out.put(node.size), out.put(node.bounds.min), out.put(node.bounds.max);
    out.put(node.depth), out.put(node.firstChild), out.put(node.childCount), out.put(node.count), out.put(place.firstStep);
    out.put(node.first), out.put(node.spacing), out.put(place.corner);
    out.put(place.stepCount), out.put(place.tableOffset), out.put(node.slab);
  }
  return std::move(out.bytes);
}

void unpackNodes(std::span<const std::byte> bytes, PointStoreData& data) {
  ByteUnpacker in(bytes);
  data.nodes.resize(bytes.size() / kNodeBytes);
  data.places.resize(data.nodes.size());
  for (std::size_t n = 0; n < data.nodes.size(); ++n) {
    CloudNode& node = data.nodes[n];
    PointStoreData::NodePlace& place = data.places[n];
    node.origin = in.get<glm::dvec3>(), node.step = in.get<double>(), node.size = in.get<double>();
    node.bounds.min = in.get<glm::dvec3>(), node.bounds.max = in.get<glm::dvec3>();
    node.depth = in.get<std::uint32_t>(), node.firstChild = in.get<std::int32_t>(), node.childCount = in.get<std::uint32_t>();
    node.count = in.get<std::uint32_t>(), place.firstStep = in.get<std::int32_t>();
    node.first = in.get<std::uint64_t>(), node.spacing = in.get<double>(), place.corner = in.get<glm::i64vec3>();
    place.stepCount = in.get<std::uint32_t>(), place.tableOffset = in.get<std::uint64_t>();
    node.slab = in.get<NodeSlab>();
  }
}

namespace {

bool isFinite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool isSoundSlab(const NodeSlab& slab) {
  return isFinite(slab.normal) && std::isfinite(slab.along) && slab.thickness >= 0 && std::isfinite(slab.thickness) && slab.roughness >= 0 && slab.roughness <= 1 && slab.area >= 0 && std::isfinite(slab.area);
}

bool isSoundNode(const CloudNode& node, const PointStoreData::NodePlace& place, const PointStoreData& data) {
  constexpr std::int64_t kFarthest = std::int64_t{1} << 60;
  constexpr std::int32_t kMostSteps = 1 << 16;
  constexpr std::uint32_t kDeepest = 256;
  if (!isFinite(node.origin) || !std::isfinite(node.step) || !(node.step > 0) || !std::isfinite(node.size) || !std::isfinite(node.spacing) ||
      node.depth > kDeepest || !isSoundSlab(node.slab))
    return false;
  if (node.count > 0 && !(isFinite(node.bounds.min) && isFinite(node.bounds.max) && !node.bounds.empty())) return false;
  if (!node.bounds.empty() && !(isFinite(node.bounds.min) && isFinite(node.bounds.max))) return false;
  for (int axis = 0; axis < 3; ++axis)
    if (place.corner[axis] > kFarthest || place.corner[axis] < -kFarthest) return false;
  if (place.firstStep < -kMostSteps || place.firstStep > kMostSteps || place.stepCount > kMostSteps) return false;
  if (place.tableOffset > data.tables.size() || place.stepCount > data.tables.size() - place.tableOffset) return false;
  const auto table = data.tables.subspan(place.tableOffset, place.stepCount);
  if (!std::ranges::is_sorted(table) || (table.empty() ? 0 : table.back()) != node.count) return false;
  return node.first <= data.points.size() && node.count <= data.points.size() - node.first;
}

}  // namespace

bool isSound(const PointStoreData& data) {
  if (data.nodes.empty()) return data.points.empty();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> runs;
  std::uint64_t nextChild = 1;
  for (std::size_t n = 0; n < data.nodes.size(); ++n) {
    const CloudNode& node = data.nodes[n];
    if (!isSoundNode(node, data.places[n], data)) return false;
    if (node.count > 0) runs.push_back({node.first, node.count});
    if (node.childCount == 0) continue;
    // Each node but the root is the child of one before it: there are no loops.
    const std::int64_t first = node.firstChild, count = static_cast<std::int64_t>(data.nodes.size());
    if (first <= static_cast<std::int64_t>(n) || first > count || node.childCount > count - first) return false;
    nextChild += node.childCount;
  }
  if (nextChild != data.nodes.size()) return false;
  std::vector<char> taken(data.nodes.size(), 0);
  for (const CloudNode& node : data.nodes)
    for (std::uint32_t c = 0; c < node.childCount; ++c)
      if (std::exchange(taken[static_cast<std::size_t>(node.firstChild) + c], 1)) return false;
  std::ranges::sort(runs);
  std::uint64_t end = 0;
  for (const auto& [first, count] : runs) {
    if (first != end) return false;
    end += count;
  }
  return end == data.points.size();
}

}  // namespace alidade

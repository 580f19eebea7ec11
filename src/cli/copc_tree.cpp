// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/copc_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <unordered_set>

namespace alidade::cli {

namespace {

constexpr int kGrid = 128, kDeepest = 20;
constexpr std::size_t kLeafPoints = 20000;

/// Where a point stands.
struct Place {
  std::uint32_t batch, index;
};

/// The points at these places, with all columns of the first one's batch.
PointBatch gather(const std::vector<PointBatch>& batches, const std::vector<Place>& places) {
  PointBatch out;
  const PointBatch& like = batches[places.front().batch];
  const auto pick = [&](auto member) {
    if ((like.*member).empty()) return;
    (out.*member).resize(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) (out.*member)[i] = (batches[places[i].batch].*member)[places[i].index];
  };
  pick(&PointBatch::position);
  pick(&PointBatch::rgb);
  out.rgbWhite = like.rgbWhite;
  pick(&PointBatch::intensity);
  pick(&PointBatch::classification);
  pick(&PointBatch::returnNumber);
  pick(&PointBatch::returnCount);
  pick(&PointBatch::gpsTime);
  pick(&PointBatch::normal);
  pick(&PointBatch::scanner);
  pick(&PointBatch::pointSource);
  pick(&PointBatch::row);
  pick(&PointBatch::column);
  for (std::size_t c = 0; c < like.extra.size(); ++c) {
    const ExtraColumn& column = like.extra[c];
    ExtraColumn& copy = out.extra.emplace_back(ExtraColumn{column.name, column.type, column.components, {}});
    const std::size_t bytes = column.bytesPerPoint();
    copy.data.resize(places.size() * bytes);
    for (std::size_t i = 0; i < places.size(); ++i)
      std::memcpy(copy.data.data() + i * bytes, batches[places[i].batch].extra[c].data.data() + places[i].index * bytes, bytes);
  }
  return out;
}

/// Batches of different columns would not do for one node.
bool alike(const PointBatch& a, const PointBatch& b) {
  const auto same = [](const auto& x, const auto& y) { return x.empty() == y.empty(); };
  bool ok = same(a.rgb, b.rgb) && a.rgbWhite == b.rgbWhite && same(a.intensity, b.intensity) &&
            same(a.classification, b.classification) && same(a.returnNumber, b.returnNumber) &&
            same(a.returnCount, b.returnCount) && same(a.gpsTime, b.gpsTime) && same(a.normal, b.normal) &&
            same(a.scanner, b.scanner) && same(a.pointSource, b.pointSource) && same(a.row, b.row) &&
            a.extra.size() == b.extra.size();
  for (std::size_t i = 0; ok && i < a.extra.size(); ++i)
    ok = a.extra[i].name == b.extra[i].name && a.extra[i].type == b.extra[i].type &&
         a.extra[i].components == b.extra[i].components;
  return ok;
}

class TreeWriter {
 public:
  TreeWriter(const std::vector<PointBatch>& batches, ScanSink& sink, const ScanWriteOptions& options, std::uint64_t total,
             const Progress& progress)
      : m_batches(batches), m_sink(sink), m_options(options), m_total(total), m_progress(progress) {}

  Result<void> write(const OctreeCell& cell, std::vector<Place> places) {
    if (m_progress.cancelled()) return fail(cancelledError());
    m_progress.report(static_cast<double>(m_done) / static_cast<double>(m_total), "Writing the octree");
    std::array<std::vector<Place>, 8> below;
    if (places.size() > kLeafPoints && cell.depth < kDeepest) {
      std::vector<Place> here;
      split(cell, places, here, below);
      places = std::move(here);
    }
    m_done += places.size();
    if (auto ok = m_sink.add(gather(m_batches, places), cell); !ok) return ok;
    std::vector<Place>().swap(places);
    for (int child = 0; child < 8; ++child) {
      if (below[child].empty()) continue;
      const OctreeCell next{cell.depth + 1, 2 * cell.x + (child & 1), 2 * cell.y + (child >> 1 & 1), 2 * cell.z + (child >> 2)};
      if (auto ok = write(next, std::move(below[child])); !ok) return ok;
    }
    return {};
  }

 private:
  void split(const OctreeCell& cell, const std::vector<Place>& places, std::vector<Place>& here,
             std::array<std::vector<Place>, 8>& below) const {
    const double edge = std::ldexp(m_options.cubeSize, -cell.depth);
    const glm::dvec3 corner = m_options.cubeCorner + edge * glm::dvec3(cell.x, cell.y, cell.z);
    std::unordered_set<std::uint32_t> taken;
    for (const Place& place : places) {
      const glm::dvec3 at = (m_batches[place.batch].position[place.index] - corner) * (kGrid / edge);
      const glm::ivec3 grid = glm::clamp(glm::ivec3(at), glm::ivec3(0), glm::ivec3(kGrid - 1));
      if (taken.insert(static_cast<std::uint32_t>((grid.z * kGrid + grid.y) * kGrid + grid.x)).second) {
        here.push_back(place);
        continue;
      }
      constexpr int kHalf = kGrid / 2;
      below[(grid.x >= kHalf) | (grid.y >= kHalf) << 1 | (grid.z >= kHalf) << 2].push_back(place);
    }
  }

  const std::vector<PointBatch>& m_batches;
  ScanSink& m_sink;
  const ScanWriteOptions& m_options;
  std::uint64_t m_total, m_done = 0;
  const Progress& m_progress;
};

}  // namespace

void CopcTree::add(PointBatch&& batch) {
  m_count += batch.size();
  if (batch.size() > 0) m_batches.push_back(std::move(batch));
}

Result<void> CopcTree::write(const ScanWriter& writer, const std::string& path, ScanWriteOptions options,
                             const Progress& progress) {
  Bounds bounds;
  std::vector<Place> places;
  places.reserve(m_count);
  for (std::size_t b = 0; b < m_batches.size(); ++b) {
    if (!alike(m_batches.front(), m_batches[b]))
      return fail("The scans have different columns", path, "Convert them to files of their own");
    for (std::size_t i = 0; i < m_batches[b].size(); ++i) {
      bounds.add(m_batches[b].position[i]);
      places.push_back({static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(i)});
    }
  }
  if (bounds.empty()) return fail("There are no points to make a tree of", path, "Write an empty scan as LAS or LAZ");
  const glm::dvec3 size = bounds.size();
  // A little more than the points take, so that none stands on the far faces.
  options.cubeSize = std::max({size.x, size.y, size.z, 1e-3}) * (1 + 1e-6);
  options.cubeCorner = bounds.min;
  options.rootSpacing = options.cubeSize / kGrid;
  auto sink = writer.create(path, options);
  if (!sink) return fail(sink.error());
  if (auto ok = TreeWriter(m_batches, **sink, options, m_count, progress).write({}, std::move(places)); !ok) return ok;
  return (*sink)->finish();
}

}  // namespace alidade::cli

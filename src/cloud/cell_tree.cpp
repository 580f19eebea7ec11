// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/cell_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

#include "base/widest.h"
#include "cloud/morton.h"
#include "cloud/node_spacing.h"
#include "cloud/key_sort.h"

namespace alidade {

namespace {

/// Sebastiano Vigna's SplitMix64 (public domain algorithm): a counter-based draw, so that a level depends on
/// the seed and the point's place in its cell alone, not on threads.
class Draws {
 public:
  Draws(std::uint32_t seed, const PlanCell& cell) {
    m_key = mix((static_cast<std::uint64_t>(seed) << 32) ^ static_cast<std::uint32_t>(cell.tile.x));
    m_key = mix(m_key ^ (static_cast<std::uint64_t>(static_cast<std::uint32_t>(cell.tile.y)) << 32) ^
                static_cast<std::uint32_t>(cell.tile.z));
    m_key = mix(m_key ^ cell.depth ^ mortonOf(cell.cell.x, cell.cell.y, cell.cell.z) << 8);
  }
  /// Uniform in [0,1).
  double at(std::uint64_t index) const {
    return static_cast<double>(mix(m_key + (index + 1) * 0x9e3779b97f4a7c15ull) >> 11) * 0x1p-53;
  }

 private:
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  std::uint64_t m_key;
};

/// Above a tile's own size every octave keeps one in four, drawn: there is nothing left to space out.
std::int16_t levelAboveTile(double u) {
  const double octaves = std::min(20.0, -std::log2(std::max(u, 1e-12)) / 2.0);
  return static_cast<std::int16_t>(kCoarsestPass * kLevelSteps - 1 - static_cast<int>(octaves * kLevelSteps));
}

std::uint64_t codeOf(std::uint64_t packed) {
  return mortonOf(packed & 0xffff, packed >> 16 & 0xffff, packed >> 32 & 0xffff);
}

/// Sort keys: what is wanted of the Morton code, above the row.
ALIDADE_WIDEST void makeKeys(const std::uint64_t* __restrict packed, std::size_t count, std::uint64_t inCell, int drop, int rowBits,
                             std::uint64_t* __restrict keys) {
  for (std::size_t i = 0; i < count; ++i) keys[i] = (codeOf(packed[i]) & inCell) >> drop << rowBits | i;
}

/// Codes, rows and places from keys that hold the whole code within the cell.
ALIDADE_WIDEST void readKeys(const std::uint64_t* keys, std::size_t count, std::uint64_t cellCode, int rowBits, std::uint64_t* code,
                             std::uint32_t* row, std::uint16_t* x, std::uint16_t* y, std::uint16_t* z) {
  const std::uint64_t rowMask = (std::uint64_t{1} << rowBits) - 1;
  for (std::size_t i = 0; i < count; ++i) {
    row[i] = static_cast<std::uint32_t>(keys[i] & rowMask);
    code[i] = keys[i] >> rowBits | cellCode;
  }
  for (std::size_t i = 0; i < count; ++i) x[i] = static_cast<std::uint16_t>(gatherBits(code[i]));
  for (std::size_t i = 0; i < count; ++i) y[i] = static_cast<std::uint16_t>(gatherBits(code[i] >> 1));
  for (std::size_t i = 0; i < count; ++i) z[i] = static_cast<std::uint16_t>(gatherBits(code[i] >> 2));
}

/// The coarsest pass at which a point of this level was accepted: it was rejected at the one after.
inline int coarsestPassOf(std::int16_t level) {
  return std::max((level >> 6) + 1, kCoarsestPass);
}

/// How far a point that is accepted from this pass on keeps others away, units.
inline std::int32_t reachOf(int from) {
  return from > kFinestPass ? 0 : std::int32_t{1} << (kFinestPass - from);
}

constexpr std::size_t kMarked = 512;

/// Sets to 1 what stands for points nearer to a face of a cell than they keep others away. A point whose level is
/// undecided has level 0, and reaches as far or farther by it.
ALIDADE_WIDEST void markNearFaces(const std::array<std::int32_t, 3>& low, const std::array<std::int32_t, 3>& high, const std::uint16_t* x,
                                  const std::uint16_t* y, const std::uint16_t* z, const std::int16_t* level, std::size_t count,
                                  std::uint8_t* near) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t fromX = std::min(x[i] - low[0], high[0] - x[i]), fromY = std::min(y[i] - low[1], high[1] - y[i]),
                       fromZ = std::min(z[i] - low[2], high[2] - z[i]);
    near[i] = static_cast<std::uint8_t>(std::min(std::min(fromX, fromY), fromZ) < reachOf(coarsestPassOf(level[i])));
  }
}

/// A run of the list that becomes the node `node`.
struct Pending {
  std::size_t first, last;
  std::uint32_t node;
};

/// Places of a settled node that lie evenly over all of it: of its coarsest level steps, as many as hold enough, each in the order of
/// space, one after every few.
std::vector<glm::vec3> coarsePlaces(const BuildNode& node, const CellPoints& points, const SubTree& tree) {
  constexpr std::uint32_t kEnough = 256;  // more tell no more of how flat a node is
  const std::span<const std::uint32_t> upTo(tree.tables.data() + node.tableOffset, node.bucketCount);
  const auto last = std::ranges::lower_bound(upTo, std::min(kEnough, node.count));
  const std::uint32_t among = *last, count = std::min(kEnough, among);
  std::vector<glm::vec3> places;
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t i = tree.order[node.first + std::uint64_t{k} * among / count];
    places.push_back(glm::vec3(points.x[i], points.y[i], points.z[i]));
  }
  return places;
}

/// Appends `kept` to the tree as the node's points, sorted by level step, and its table.
void settle(BuildNode& node, std::span<const std::uint32_t> kept, const CellPoints& points, SubTree& tree) {
  node.first = tree.order.size();
  node.count = static_cast<std::uint32_t>(kept.size());
  node.tableOffset = tree.tables.size();
  if (kept.empty()) return;
  int low = points.level[kept[0]], high = low;
  glm::ivec3 least(65535), most(0);
  const std::uint16_t *x = points.x.data(), *y = points.y.data(), *z = points.z.data();
  const std::int16_t* level = points.level.data();
  for (const std::uint32_t i : kept) {
    low = std::min<int>(low, level[i]), high = std::max<int>(high, level[i]);
    const glm::ivec3 place(x[i], y[i], z[i]);
    least = glm::min(least, place), most = glm::max(most, place);
  }
  const glm::i64vec3 base = glm::i64vec3(node.tile) << std::int64_t{16};
  node.low = base + glm::i64vec3(least), node.high = base + glm::i64vec3(most);
  node.firstBucket = low;
  node.bucketCount = static_cast<std::uint32_t>(high - low + 1);
  std::vector<std::uint32_t> next(node.bucketCount + 1, 0);
  for (const std::uint32_t i : kept) ++next[static_cast<std::size_t>(points.level[i] - low) + 1];
  for (std::size_t b = 1; b < next.size(); ++b) next[b] += next[b - 1];
  tree.tables.insert(tree.tables.end(), next.begin() + 1, next.end());
  tree.order.resize(node.first + kept.size());
  for (const std::uint32_t i : kept) tree.order[node.first + next[static_cast<std::size_t>(points.level[i] - low)]++] = i;
  node.slab = slabOf(coarsePlaces(node, points, tree));
}

glm::ivec3 cornerOf(std::uint64_t code, int depth) {
  const int drop = 16 - depth;
  const auto part = [drop](std::uint64_t bits) { return static_cast<std::int32_t>(gatherBits(bits) >> drop << drop); };
  return {part(code), part(code >> 1), part(code >> 2)};
}

/// All of the cell's points that lie in the node's cube, whichever node holds them.
std::size_t pointsInCube(const CellPoints& points, const BuildNode& node) {
  const int shift = 3 * (16 - node.depth);
  const std::uint64_t cube = mortonOf(static_cast<std::uint64_t>(node.corner.x), static_cast<std::uint64_t>(node.corner.y),
                                      static_cast<std::uint64_t>(node.corner.z)) >> shift;
  const auto from = std::partition_point(points.code.begin(), points.code.end(), [&](std::uint64_t c) { return c >> shift < cube; });
  const auto to = std::partition_point(from, points.code.end(), [&](std::uint64_t c) { return c >> shift == cube; });
  return static_cast<std::size_t>(to - from);
}

}  // namespace

void BuildNode::addBounds(const BuildNode& other) {
  if (!other.hasBounds()) return;
  if (!hasBounds()) low = other.low, high = other.high;
  low = glm::min(low, other.low);
  high = glm::max(high, other.high);
}

void sumUp(std::vector<BuildNode>& nodes) {
  for (std::size_t n = nodes.size(); n-- > 0;) {
    BuildNode& node = nodes[n];
    node.pointsBelow = node.count;
    double weighted = 0, weight = 0;
    for (std::uint32_t c = 0; c < node.childCount && node.firstChild >= 0; ++c) {
      const BuildNode& child = nodes[static_cast<std::size_t>(node.firstChild) + c];
      node.pointsBelow += child.pointsBelow;
      node.addBounds(child);
      if (child.spacingUnits <= 0) continue;
      weighted += static_cast<double>(child.spacingUnits) * static_cast<double>(child.pointsBelow);
      weight += static_cast<double>(child.pointsBelow);
    }
    if (weight > 0) node.spacingUnits = static_cast<float>(weighted / weight);
  }
}

void sortCell(const PlanCell& cell, std::span<const std::uint64_t> packed, RawVector<std::uint64_t>& keys, CellPoints& points) {
  const std::size_t count = packed.size();
  const int axisBits = 16 - cell.depth;
  const int rowBits = std::bit_width(count);
  points.droppedBits = std::max(0, (3 * axisBits + rowBits - 64 + 2) / 3);
  const int drop = 3 * points.droppedBits;
  const std::uint64_t inCell = axisBits == 16 ? 0xffffffffffffull : (std::uint64_t{1} << 3 * axisBits) - 1;
  keys.resize(count);
  makeKeys(packed.data(), count, inCell, drop, rowBits, keys.data());
  sortKeys(keys);
  points.code.resize(count), points.row.resize(count);
  points.x.resize(count), points.y.resize(count), points.z.resize(count);
  points.level.assign(count, 0);
  if (drop == 0 && count > 0) {
    readKeys(keys.data(), count, codeOf(packed[0]) & ~inCell, rowBits, points.code.data(), points.row.data(), points.x.data(),
             points.y.data(), points.z.data());
    return;
  }
  const std::uint64_t rowMask = (std::uint64_t{1} << rowBits) - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t row = keys[i] & rowMask, place = packed[row];
    points.row[i] = static_cast<std::uint32_t>(row);
    points.x[i] = static_cast<std::uint16_t>(place);
    points.y[i] = static_cast<std::uint16_t>(place >> 16);
    points.z[i] = static_cast<std::uint16_t>(place >> 32);
    points.code[i] = codeOf(place);
  }
}

std::vector<std::uint32_t> assignLevels(const PlanCell& cell, CellPoints& points, std::span<const Obstacle> obstacles,
                                        const TreeOptions& options, BlueNoise& noise) {
  const Draws draws(options.seed, cell);
  if (options.kind == LevelKind::Random) {
    std::vector<std::uint32_t> undecided;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double level = (options.law.levelOfUniform(draws.at(points.row[i])) - options.lawShift) * kLevelSteps;
      points.level[i] = static_cast<std::int16_t>(std::clamp(std::floor(level), -16.0 * kLevelSteps, 16.0 * kLevelSteps));
      if (cell.depth > 0 && points.level[i] < cell.depth * kLevelSteps) undecided.push_back(static_cast<std::uint32_t>(i));
    }
    return undecided;
  }
  const int coarsest = cell.depth > 0 ? cell.depth : kCoarsestPass;
  const int finest = std::max(coarsest, finestPassOf(points.code, points.droppedBits));
  std::vector<std::uint32_t> survivors = noise.thin(points.places(), obstacles, finest, coarsest, points.level);
  if (cell.depth > 0) return survivors;
  for (const std::uint32_t i : survivors) points.level[i] = levelAboveTile(draws.at(points.row[i]));
  return {};
}

std::vector<BorderSample> borderSamples(const PlanCell& cell, const CellPoints& points, std::span<const std::uint32_t> undecided) {
  std::vector<BorderSample> samples;
  const glm::ivec3 low = cell.corner(), high = low + cell.size() - 1;
  std::size_t next = 0;
  const auto look = [&](std::size_t i) {
    int from = coarsestPassOf(points.level[i]);
    while (next < undecided.size() && undecided[next] < i) ++next;
    if (next < undecided.size() && undecided[next] == i) from = std::max<int>(cell.depth, kCoarsestPass);
    const std::int32_t x = points.x[i], y = points.y[i], z = points.z[i];
    const std::int32_t inside = std::min({x - low.x, y - low.y, z - low.z, high.x - x, high.y - y, high.z - z});
    if (inside < reachOf(from)) samples.push_back({points.x[i], points.y[i], points.z[i], static_cast<std::int16_t>(from)});
  };
  std::array<std::uint8_t, kMarked> near;
  for (std::size_t first = 0; first < points.size(); first += kMarked) {
    const std::size_t count = std::min(kMarked, points.size() - first);
    near.fill(0);
    markNearFaces({low.x, low.y, low.z}, {high.x, high.y, high.z}, points.x.data() + first, points.y.data() + first,
                  points.z.data() + first, points.level.data() + first, count, near.data());
    for (std::size_t at = 0; at < count; at += sizeof(std::uint64_t)) {
      std::uint64_t some;
      std::memcpy(&some, near.data() + at, sizeof some);
      for (; some != 0; some &= some - 1) look(first + at + static_cast<std::size_t>(std::countr_zero(some)) / 8);
    }
  }
  return samples;
}

SubTree buildCellTree(const PlanCell& cell, const CellPoints& points, std::span<const std::uint32_t> undecided,
                      const TreeOptions& options) {
  SubTree tree;
  if (points.size() == undecided.size()) return tree;
  std::vector<std::uint32_t> list(points.size() - undecided.size());
  auto decided = list.begin();
  std::uint32_t first = 0;
  const auto addUntil = [&](std::uint32_t end) {
    std::iota(decided, decided + (end - first), first);
    decided += end - first;
    first = end + 1;
  };
  for (const std::uint32_t i : undecided) addUntil(i);
  addUntil(static_cast<std::uint32_t>(points.size()));
  tree.order.reserve(list.size());
  const std::vector<PlaceBox> boxes = boxesOf(points);
  const int deepest = 15 - points.droppedBits;
  std::vector<std::uint32_t> keptHere;
  std::vector<Pending> generation{{0, list.size(), 0}};
  tree.nodes.resize(1);
  while (!generation.empty()) {
    std::vector<Pending> next;
    for (const Pending& pending : generation) {
      BuildNode node;
      std::size_t end = pending.last;
      node.tile = cell.tile;
      node.depth = pending.node == 0 ? cell.depth : tree.nodes[pending.node].depth;
      node.corner = cornerOf(points.code[list[pending.first]], node.depth);
      const std::span<const std::uint32_t> run(list.data() + pending.first, pending.last - pending.first);
      if (run.size() <= options.leafPoints || node.depth >= deepest) {
        settle(node, run, points, tree);
        node.spacingUnits = spacingOf(run, points, boxes, pointsInCube(points, node));
        tree.nodes[pending.node] = node;
        continue;
      }
      end = pending.first;
      keptHere.resize(std::max(keptHere.size(), run.size()));
      const int limit = (node.depth + 1) * kLevelSteps;
      std::size_t keptCount = 0;
      for (std::size_t i = pending.first; i < pending.last; ++i) {  // both are written, one goes on: nothing to predict
        const std::uint32_t point = list[i];
        const bool below = points.level[point] < limit;
        keptHere[keptCount] = point, list[end] = point;
        keptCount += below, end += !below;
      }
      const std::span<const std::uint32_t> kept(keptHere.data(), keptCount);
      settle(node, kept, points, tree);
      if (end == pending.first) node.spacingUnits = spacingOf(kept, points, boxes, pointsInCube(points, node));
      const int shift = 3 * (15 - node.depth);
      const auto octantOf = [&](std::uint32_t i) { return points.code[i] >> shift & 7; };
      for (std::size_t from = pending.first; from < end;) {
        const std::uint64_t octant = octantOf(list[from]);
        const auto to = static_cast<std::size_t>(
            std::partition_point(list.begin() + static_cast<std::ptrdiff_t>(from), list.begin() + static_cast<std::ptrdiff_t>(end),
                                 [&](std::uint32_t i) { return octantOf(i) <= octant; }) - list.begin());
        const auto child = static_cast<std::uint32_t>(tree.nodes.size());
        if (node.childCount++ == 0) node.firstChild = static_cast<std::int32_t>(child);
        tree.nodes.emplace_back().depth = node.depth + 1;
        next.push_back({from, to, child});
        from = to;
      }
      tree.nodes[pending.node] = node;
    }
    generation = std::move(next);
  }
  sumUp(tree.nodes);
  return tree;
}

void assignTopLevels(const glm::ivec3& tile, TopPoints& top, std::span<const Obstacle> obstacles, const TreeOptions& options,
                     BlueNoise& noise) {
  if (options.kind == LevelKind::Random || top.points.size() == 0) return;  // drawn already
  const int finest = *std::max_element(top.cellDepth.begin(), top.cellDepth.end()) - 1;
  const std::vector<std::uint32_t> survivors =
      noise.thin(top.points.places(), obstacles, finest, kCoarsestPass, top.points.level, top.cellDepth);
  const Draws draws(options.seed, PlanCell{tile, 0, {}});
  for (const std::uint32_t i : survivors) top.points.level[i] = levelAboveTile(draws.at(i));
  // Two cells of which neither saw the other may have kept points closer than their own last spacing.
  for (std::size_t i = 0; i < top.points.size(); ++i) {
    const int most = top.cellDepth[i] * kLevelSteps - 1;
    top.points.level[i] = static_cast<std::int16_t>(std::min<int>(top.points.level[i], most));
  }
}

SubTree buildTopTree(const glm::ivec3& tile, std::span<const PlanCell> cells, const TopPoints& top) {
  SubTree tree;
  if (cells.empty()) return tree;
  struct Above {
    std::size_t firstCell, lastCell;
    std::vector<std::uint32_t> list;
    std::uint32_t node;
  };
  const auto codeOfCell = [](const PlanCell& c) { return mortonOf(c.cell.x, c.cell.y, c.cell.z) << 3 * (16 - c.depth); };
  tree.nodes.resize(1);
  std::vector<Above> generation(1);
  generation[0] = {0, cells.size(), std::vector<std::uint32_t>(top.points.size()), 0};
  for (std::uint32_t i = 0; i < top.points.size(); ++i) generation[0].list[i] = i;
  for (int depth = 0; !generation.empty(); ++depth) {
    std::vector<Above> next;
    for (Above& above : generation) {
      BuildNode node;
      node.tile = tile;
      node.depth = depth;
      node.corner = cornerOf(codeOfCell(cells[above.firstCell]), depth);
      if (cells[above.firstCell].depth == depth) {
        node.firstChild = -1 - static_cast<std::int32_t>(above.firstCell);
        node.childCount = 1;
        tree.nodes[above.node] = node;
        continue;
      }
      std::vector<std::uint32_t> kept, rest;
      for (const std::uint32_t i : above.list)
        (top.points.level[i] < (depth + 1) * kLevelSteps ? kept : rest).push_back(i);
      settle(node, kept, top.points, tree);
      const int shift = 3 * (15 - depth);
      std::size_t cellAt = above.firstCell, pointAt = 0;
      while (cellAt < above.lastCell) {
        const std::uint64_t octant = codeOfCell(cells[cellAt]) >> shift & 7;
        std::size_t cellEnd = cellAt;
        while (cellEnd < above.lastCell && (codeOfCell(cells[cellEnd]) >> shift & 7) == octant) ++cellEnd;
        std::size_t pointEnd = pointAt;
        while (pointEnd < rest.size() && (top.points.code[rest[pointEnd]] >> shift & 7) == octant) ++pointEnd;
        const auto child = static_cast<std::uint32_t>(tree.nodes.size());
        if (node.childCount++ == 0) node.firstChild = static_cast<std::int32_t>(child);
        tree.nodes.emplace_back();
        next.push_back({cellAt, cellEnd,
                        std::vector<std::uint32_t>(rest.begin() + static_cast<std::ptrdiff_t>(pointAt),
                                                   rest.begin() + static_cast<std::ptrdiff_t>(pointEnd)), child});
        cellAt = cellEnd;
        pointAt = pointEnd;
      }
      tree.nodes[above.node] = node;
    }
    generation = std::move(next);
  }
  return tree;
}

void addObstacles(const PlanCell& neighbour, std::span<const BorderSample> samples, const PlanCell& cell, int coarsest,
                  std::vector<Obstacle>& out) {
  const glm::i64vec3 apart = (glm::i64vec3(neighbour.tile) - glm::i64vec3(cell.tile)) << std::int64_t{16};
  if (glm::any(glm::greaterThan(glm::abs(apart), glm::i64vec3(65536)))) return;
  const glm::ivec3 shift(apart), low = cell.corner(), high = low + cell.size() - 1;
  for (const BorderSample& sample : samples) {
    const glm::ivec3 at = shift + glm::ivec3(sample.x, sample.y, sample.z);
    // The largest spacing at which it matters here.
    const std::int32_t reach = std::int32_t{1} << (kFinestPass - std::max<int>(sample.from, coarsest));
    const glm::ivec3 outside = glm::max(glm::max(low - at, at - high), glm::ivec3(0));
    if (std::max({outside.x, outside.y, outside.z}) < reach) out.push_back({at.x, at.y, at.z, sample.from});
  }
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/blue_noise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include <glm/glm.hpp>

#include "cloud/morton.h"

// The hot loops in the widest registers the processor has.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define ALIDADE_WIDEST __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define ALIDADE_WIDEST
#endif
#define ALIDADE_INLINE inline __attribute__((always_inline))

namespace alidade {

namespace {

constexpr std::size_t kLanes = 16;
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

/// Spacings above are scaled down to this many bits, so that squares below the spacing's are exact in floats.
/// Larger ones are rounded, and stay larger.
constexpr int kSpacingBits = 12;
/// Added to coordinates before they are cut into bricks: none is negative then, and no block straddles a tile's edge.
constexpr std::int32_t kBias = 1 << 19;
constexpr std::uint32_t kNone = 0xffffffff;
/// Bricks with fewer points than this on average are taken in groups: registers are to be filled.
constexpr std::size_t kFewInBrick = 5;
constexpr float kAccepted = -1;  ///< in place of a squared distance

/// The bricks about a brick or about a group of 2³, itself among them, by its place in its block: which bricks of
/// which blocks.
struct Neighbourhood {
  struct Entry {
    std::uint8_t block = 0;  ///< (dz+1) * 9 + (dy+1) * 3 + dx+1
    std::uint64_t bricks = 0;
  };
  std::array<Entry, 8> entries;
  std::uint8_t count = 0;
};

/// Where a brick stands in its block.
std::uint32_t placeInBlock(std::int32_t x, std::int32_t y, std::int32_t z) {
  return static_cast<std::uint32_t>(mortonOf(static_cast<std::uint64_t>(x & 3), static_cast<std::uint64_t>(y & 3), static_cast<std::uint64_t>(z & 3)));
}

/// By the Morton code of the first brick of the group, whose edge is `edge` bricks.
std::array<Neighbourhood, 64> findNeighbourhoods(int edge) {
  std::array<Neighbourhood, 64> all;
  for (std::uint32_t place = 0; place < 64; ++place) {
    Neighbourhood& here = all[place];
    const int x = static_cast<int>(gatherBits(place)), y = static_cast<int>(gatherBits(place >> 1)), z = static_cast<int>(gatherBits(place >> 2));
    for (int nz = z - 1; nz <= z + edge; ++nz) {
      for (int ny = y - 1; ny <= y + edge; ++ny) {
        for (int nx = x - 1; nx <= x + edge; ++nx) {
          if ((x | y | z) % edge != 0) continue;  // no group begins here
          const auto block = static_cast<std::uint8_t>(((nz >> 2) + 1) * 9 + ((ny >> 2) + 1) * 3 + (nx >> 2) + 1);
          std::uint8_t e = 0;
          while (e < here.count && here.entries[e].block != block) ++e;
          if (e == here.count) here.entries[here.count++].block = block;
          here.entries[e].bricks |= std::uint64_t{1} << placeInBlock(nx, ny, nz);
        }
      }
    }
  }
  return all;
}

const std::array<Neighbourhood, 64>& neighbourhoods(int edge) {
  static const std::array<Neighbourhood, 64> ofBricks = findNeighbourhoods(1), ofGroups = findNeighbourhoods(2);
  return edge == 1 ? ofBricks : ofGroups;
}

/// 32 log2(m) for m = 1 + (i + 0.5) / 256.
std::array<std::int16_t, 256> logTable() {
  std::array<std::int16_t, 256> table{};
  for (int i = 0; i < 256; ++i) table[i] = static_cast<std::int16_t>(std::lround(32.0 * std::log2(1.0 + (i + 0.5) / 256.0)));
  return table;
}

const std::array<std::int16_t, 256> kLogTable = logTable();

/// 64 (10 - log2(d)) for d² = squared << 2 shift units².
ALIDADE_INLINE int levelStepOf(float squared, int shift) {
  if (squared <= 0) return kDeepestLevelStep;
  const auto bits = std::bit_cast<std::uint32_t>(squared);
  const int log32 = (static_cast<int>(bits >> 23) - 127) * 32 + kLogTable[bits >> 15 & 255];
  return kFinestPass * kLevelSteps - log32 - shift * kLevelSteps;
}

}  // namespace

struct BlueNoise::Pass {
  int q = 0;
  int brickBits = 0;  ///< a brick's edge is twice the spacing
  int shift = 0;      ///< units are halved this often before they are squared

  /// Where a survivor's coordinate lies, in bricks.
  std::int32_t brickOf(float shifted) const {
    return (static_cast<std::int32_t>(shifted) + (kBias >> shift)) >> (brickBits - shift);
  }
};

void BlueNoise::Survivors::reserve(std::size_t points) {
  const std::size_t size = points + kLanes;
  if (x.size() >= size) return;
  x.resize(size), y.resize(size), z.resize(size);
  splitBits.resize(size);
  index.resize(size);
}

std::uint32_t* BlueNoise::slotOf(std::int32_t x, std::int32_t y, std::int32_t z) {
  const auto part = [](std::int32_t v) { return static_cast<std::uint64_t>(v) & 0x1fffff; };
  const std::uint64_t key = part(x) | part(y) << 21 | part(z) << 42;
  // The product's upper bits depend on all of the key's.
  std::uint64_t at = (key * 0x9e3779b97f4a7c15ull) >> m_tableShift;
  for (;; ++at) {
    std::uint32_t* slot = &m_table[at & m_tableMask];
    if (*slot == 0) return slot;
    const Block& block = m_blocks[*slot - 1];
    if (block.x == x && block.y == y && block.z == z) return slot;
  }
}

std::array<std::uint32_t, 27> BlueNoise::blocksAround(std::int32_t x, std::int32_t y, std::int32_t z) {
  std::array<std::uint32_t, 27> around;
  for (int n = 0; n < 27; ++n) around[static_cast<std::size_t>(n)] = *slotOf(x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1) - 1;
  return around;
}

/// Cuts the survivors into bricks, and the bricks into blocks.
void BlueNoise::layBricks(const Pass& pass) {
  m_bricks.clear();
  m_blocks.clear();
  for (std::uint32_t i = 0; i < m_alive.count; ++i) {
    if (i > 0 && m_alive.splitBits[i] <= pass.brickBits) continue;
    if (i > 0) m_bricks.back().last = i;
    const std::int32_t x = pass.brickOf(m_alive.x[i]), y = pass.brickOf(m_alive.y[i]), z = pass.brickOf(m_alive.z[i]);
    if (i == 0 || m_alive.splitBits[i] > pass.brickBits + 2)
      m_blocks.push_back({x >> 2, y >> 2, z >> 2, static_cast<std::uint32_t>(m_bricks.size()), 0, {}});
    m_blocks.back().filled |= std::uint64_t{1} << placeInBlock(x, y, z);
    m_bricks.push_back({i, 0});
  }
  m_bricks.back().last = static_cast<std::uint32_t>(m_alive.count);
  m_tableMask = std::bit_ceil(2 * m_blocks.size() + 16) - 1;
  m_tableShift = std::countl_zero(m_tableMask);
  m_table.assign(m_tableMask + 1, 0);
  for (std::size_t b = 0; b < m_blocks.size(); ++b)
    *slotOf(m_blocks[b].x, m_blocks[b].y, m_blocks[b].z) = static_cast<std::uint32_t>(b + 1);
  for (Block& block : m_blocks) block.around = blocksAround(block.x, block.y, block.z);
}

/// The parts of a pass that are compiled for each instruction set.
struct BlueNoise::Kernel {
  const Survivors& alive;
  Survivors& accepted;
  float* squared;
  std::vector<Brick>& bricks;
  const std::vector<Block>& blocks;
  const std::array<Neighbourhood, 64>& neighbourhoods;
  int groupBricks;  ///< 1 or 8
  float spacingSquared;
  int shift;

  /// Bricks that are worked on together, as one register's worth of points. All of one brick or of a group of 2³.
  struct Group {
    std::uint64_t bricks;  ///< of the block, filled or not
    std::uint32_t place;   ///< of its first brick
    std::uint32_t firstBrick, lastBrick;
  };
  ALIDADE_INLINE Group groupAt(std::uint64_t bitsLeft, std::uint32_t firstBrick) const {
    const auto place = static_cast<std::uint32_t>(__builtin_ctzll(bitsLeft));
    if (groupBricks == 1) return {bitsLeft & -bitsLeft, place, firstBrick, firstBrick + 1};
    const std::uint64_t bricksOfGroup = std::uint64_t{255} << (place & ~7u);
    return {bricksOfGroup, place & ~7u, firstBrick, firstBrick + static_cast<std::uint32_t>(__builtin_popcountll(bitsLeft & bricksOfGroup))};
  }

  /// Runs of the accepted samples.
  struct Run {
    std::uint32_t from, to;
  };
  struct Runs {
    std::array<Run, 64> runs;  // left as it is: setting it costs more than using it
    std::size_t count;
    ALIDADE_INLINE void add(const Brick& brick) {
      if (count > 0 && runs[count - 1].to == brick.acceptedFirst) runs[count - 1].to = brick.acceptedLast;
      else if (brick.acceptedFirst < brick.acceptedLast) runs[count++] = {brick.acceptedFirst, brick.acceptedLast};
    }
  };
  /// What was accepted in the bricks around a group that come before it, or after it.
  template <bool kBefore>
  ALIDADE_INLINE void findRuns(const std::uint32_t* around, const Group& group, Runs& found) const {
    found.count = 0;
    const Neighbourhood& neighbours = neighbourhoods[group.place];
    for (std::uint8_t e = 0; e < neighbours.count; ++e) {
      const std::uint32_t at = around[neighbours.entries[e].block];
      if (at == kNone) continue;
      const std::uint64_t filled = blocks[at].filled;
      for (std::uint64_t bits = filled & neighbours.entries[e].bricks; bits != 0; bits &= bits - 1) {
        const std::uint64_t below = filled & ((bits & -bits) - 1);
        const std::uint32_t n = blocks[at].firstBrick + static_cast<std::uint32_t>(__builtin_popcountll(below));
        if (kBefore ? n < group.firstBrick : n >= group.lastBrick) found.add(bricks[n]);
      }
    }
  }
  /// Lowers the squared distances of the points from i on to what accepted samples make them.
  ALIDADE_INLINE void lower(std::size_t i, const Run* runs, std::size_t count, Lanes& least) const {
    Lanes px, py, pz;
    std::memcpy(&px, &alive.x[i], sizeof px), std::memcpy(&py, &alive.y[i], sizeof py), std::memcpy(&pz, &alive.z[i], sizeof pz);
    const float *ax = accepted.x.data(), *ay = accepted.y.data(), *az = accepted.z.data();
    for (std::size_t r = 0; r < count; ++r) {
      for (std::uint32_t a = runs[r].from; a < runs[r].to; ++a) {
        const Lanes dx = px - ax[a], dy = py - ay[a], dz = pz - az[a];
        const Lanes here = dx * dx + dy * dy + dz * dz;
        least = here < least ? here : least;
      }
    }
  }

  /// Goes over the points in their order and accepts. What a register holds beyond a brick's end is written
  /// again by the bricks that follow.
  ALIDADE_WIDEST std::size_t choose(const float* nearSquared, const char* given) {
    std::uint32_t kept = 0;
    std::uint8_t split = 0;
    for (const Block& block : blocks) {
      std::uint32_t b = block.firstBrick;
      for (std::uint64_t bits = block.filled; bits != 0;) {
        const Group group = groupAt(bits, b);
        bits &= ~group.bricks, b = group.lastBrick;
        Runs runs;
        findRuns<true>(block.around.data(), group, runs);
        const std::uint32_t first = bricks[group.firstBrick].first, last = bricks[group.lastBrick - 1].last;
        for (std::uint32_t v = first; v < last; v += kLanes) {
          Lanes least = Lanes{} + std::numeric_limits<float>::max();
          lower(v, runs.runs.data(), runs.count, least);
          std::memcpy(squared + v, &least, sizeof least);
        }
        for (std::uint32_t member = group.firstBrick; member < group.lastBrick; ++member) {
          Brick& brick = bricks[member];
          if (brick.nearAt != kNoObstacle)
            for (std::uint32_t i = brick.first; i < brick.last; ++i)
              squared[i] = std::min(squared[i], nearSquared[brick.nearAt + (i - brick.first)]);
          brick.acceptedFirst = kept;
          for (std::uint32_t i = brick.first; i < brick.last; ++i) {
            split = std::max(split, alive.splitBits[i]);
            if (squared[i] < spacingSquared && (given == nullptr || given[i] == 0)) continue;
            accepted.index[kept] = alive.index[i];
            accepted.x[kept] = alive.x[i], accepted.y[kept] = alive.y[i], accepted.z[kept] = alive.z[i];
            accepted.splitBits[kept] = split;
            split = 0;
            const Run own{kept, kept + 1};
            ++kept;
            for (std::uint32_t v = first; v < last; v += kLanes) {
              Lanes least;
              std::memcpy(&least, squared + v, sizeof least);
              lower(v, &own, 1, least);
              std::memcpy(squared + v, &least, sizeof least);
            }
            squared[i] = kAccepted;
          }
          brick.acceptedLast = kept;
        }
      }
    }
    return kept;
  }
  /// Once all are chosen: how far a rejected point is from the nearest of them.
  ALIDADE_WIDEST void rate(std::int16_t* levels, int shallowest, int deepest) const {
    for (const Block& block : blocks) {
      std::uint32_t b = block.firstBrick;
      for (std::uint64_t bits = block.filled; bits != 0;) {
        const Group group = groupAt(bits, b);
        bits &= ~group.bricks, b = group.lastBrick;
        const std::uint32_t first = bricks[group.firstBrick].first, last = bricks[group.lastBrick - 1].last;
        if (bricks[group.lastBrick - 1].acceptedLast - bricks[group.firstBrick].acceptedFirst == last - first) continue;
        Runs runs;
        findRuns<false>(block.around.data(), group, runs);
        for (std::uint32_t v = first; v < last; v += kLanes) {
          Lanes least;
          std::memcpy(&least, squared + v, sizeof least);
          lower(v, runs.runs.data(), runs.count, least);
          std::array<float, kLanes> each;
          std::memcpy(each.data(), &least, sizeof least);
          const std::size_t n = std::min<std::size_t>(kLanes, last - v);
          for (std::size_t lane = 0; lane < n; ++lane)
            if (each[lane] >= 0)
              levels[alive.index[v + lane]] = static_cast<std::int16_t>(std::clamp(levelStepOf(each[lane], shift), shallowest, deepest));
        }
      }
    }
  }
};

/// Sets how far the points of bricks about obstacles are from them.
void BlueNoise::obstruct(const Pass& pass, std::span<const Obstacle> obstacles) {
  m_nearSquared.clear();
  const auto cut = [&](std::int32_t v) { return (v + kBias) >> pass.brickBits; };
  const auto sameBrick = [&](const Obstacle& a, const Obstacle& b) {
    return cut(a.x) == cut(b.x) && cut(a.y) == cut(b.y) && cut(a.z) == cut(b.z);
  };
  std::vector<glm::vec3> samples;
  for (std::size_t i = 0; i < obstacles.size();) {
    const Obstacle& first = obstacles[i];
    samples.clear();
    for (; i < obstacles.size() && sameBrick(obstacles[i], first); ++i)
      if (obstacles[i].from <= pass.q)
        samples.emplace_back(obstacles[i].x >> pass.shift, obstacles[i].y >> pass.shift, obstacles[i].z >> pass.shift);
    if (samples.empty()) continue;
    const std::int32_t x = cut(first.x), y = cut(first.y), z = cut(first.z);
    const auto around = blocksAround(x >> 2, y >> 2, z >> 2);
    const Neighbourhood& neighbours = neighbourhoods(1)[placeInBlock(x, y, z)];
    for (std::uint8_t e = 0; e < neighbours.count; ++e) {
      const std::uint32_t at = around[neighbours.entries[e].block];
      if (at == kNone) continue;
      const Block& block = m_blocks[at];
      for (std::uint64_t bits = block.filled & neighbours.entries[e].bricks; bits != 0; bits &= bits - 1) {
        Brick& brick = m_bricks[block.firstBrick + static_cast<std::uint32_t>(std::popcount(block.filled & ((bits & -bits) - 1)))];
        if (brick.nearAt == kNoObstacle) {
          brick.nearAt = static_cast<std::uint32_t>(m_nearSquared.size());
          m_nearSquared.resize(m_nearSquared.size() + (brick.last - brick.first), std::numeric_limits<float>::max());
        }
        for (std::uint32_t p = brick.first; p < brick.last; ++p) {
          float& least = m_nearSquared[brick.nearAt + (p - brick.first)];
          for (const glm::vec3& sample : samples) {
            const glm::vec3 apart = glm::vec3(m_alive.x[p], m_alive.y[p], m_alive.z[p]) - sample;
            least = std::min(least, glm::dot(apart, apart));
          }
        }
      }
    }
  }
}

void BlueNoise::runPass(int q, bool isFirst, std::span<const Obstacle> obstacles, std::span<std::int16_t> levels,
                        std::span<const std::int8_t> settled) {
  const int spacingBits = kFinestPass - q;
  Pass pass;
  pass.q = q;
  pass.brickBits = spacingBits + 1;
  pass.shift = std::max(0, spacingBits - kSpacingBits);
  if (pass.shift > 0) {  // one more than in the pass before
    for (auto* column : {&m_alive.x, &m_alive.y, &m_alive.z})
      for (std::size_t i = 0; i < m_alive.count; ++i) (*column)[i] = std::floor((*column)[i] * 0.5f);
  }
  layBricks(pass);
  obstruct(pass, obstacles);
  m_given.clear();
  for (std::size_t i = 0; i < m_alive.count && !settled.empty(); ++i) m_given.push_back(settled[m_alive.index[i]] <= q);
  m_accepted.reserve(m_alive.count);
  if (m_squared.size() < m_alive.count + kLanes) m_squared.resize(m_alive.count + kLanes);
  const float spacingSquared = static_cast<float>(std::int32_t{1} << 2 * (spacingBits - pass.shift));
  const bool grouped = m_alive.count < kFewInBrick * m_bricks.size();
  Kernel kernel{m_alive, m_accepted, m_squared.data(), m_bricks, m_blocks, neighbourhoods(grouped ? 2 : 1), grouped ? 8 : 1,
                spacingSquared, pass.shift};
  m_accepted.count = kernel.choose(m_nearSquared.data(), m_given.empty() ? nullptr : m_given.data());
  kernel.rate(levels.data(), q * kLevelSteps, isFirst ? kDeepestLevelStep : (q + 1) * kLevelSteps - 1);
  std::swap(m_alive, m_accepted);
}

std::vector<std::uint32_t> BlueNoise::thin(const TilePoints& points, std::span<const Obstacle> obstacles, int finest,
                                           int coarsest, std::span<std::int16_t> levels, std::span<const std::int8_t> settled) {
  const std::size_t count = points.x.size();
  m_alive.reserve(count);
  m_alive.count = count;
  for (std::size_t i = 0; i < count; ++i) {
    m_alive.index[i] = static_cast<std::uint32_t>(i);
    m_alive.x[i] = points.x[i], m_alive.y[i] = points.y[i], m_alive.z[i] = points.z[i];
  }
  for (std::size_t i = 1; i < count; ++i) {
    const auto differing = static_cast<std::uint32_t>((points.x[i] ^ points.x[i - 1]) | (points.y[i] ^ points.y[i - 1]) | (points.z[i] ^ points.z[i - 1]));
    m_alive.splitBits[i] = static_cast<std::uint8_t>(std::bit_width(differing));
  }
  const int shift = std::max(0, kFinestPass - finest - kSpacingBits);
  for (auto* column : {&m_alive.x, &m_alive.y, &m_alive.z})
    for (std::size_t i = 0; shift > 1 && i < count; ++i) (*column)[i] = std::floor(std::ldexp((*column)[i], 1 - shift));
  m_near.assign(obstacles.begin(), obstacles.end());
  const auto codeOf = [](const Obstacle& o) {
    return mortonOf(static_cast<std::uint64_t>(o.x + kBias), static_cast<std::uint64_t>(o.y + kBias), static_cast<std::uint64_t>(o.z + kBias));
  };
  std::sort(m_near.begin(), m_near.end(), [&](const Obstacle& a, const Obstacle& b) { return codeOf(a) < codeOf(b); });
  for (int q = finest; q >= coarsest && m_alive.count > 0; --q) runPass(q, q == finest, m_near, levels, settled);
  return {m_alive.index.begin(), m_alive.index.begin() + static_cast<std::ptrdiff_t>(m_alive.count)};
}

int finestPassOf(std::span<const std::uint64_t> codes, int droppedBits) {
  // alone[k]: points that share their cell of 2^k units with no other before them.
  std::array<std::uint64_t, 24> alone{};
  for (std::size_t i = 1; i < codes.size(); ++i) ++alone[(static_cast<std::size_t>(std::bit_width(codes[i] ^ codes[i - 1])) + 2) / 3];
  // So far by the highest axis bit in which a point and the one before it differ, counted from 1.
  for (std::size_t k = alone.size() - 1; k-- > 0;) alone[k] += alone[k + 1];
  std::rotate(alone.begin(), alone.begin() + 1, alone.end());
  const int finestBits = std::max(0, droppedBits - 1);
  int bits = finestBits;
  while (bits < kFinestPass - kCoarsestPass && static_cast<double>(alone[bits] + 1) > 0.75 * static_cast<double>(codes.size())) ++bits;
  return kFinestPass - bits;
}

}  // namespace alidade

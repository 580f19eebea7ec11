// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/blue_noise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

#include <glm/glm.hpp>

#include "base/widest.h"
#include "cloud/blue_noise_pass.h"
#include "cloud/morton.h"

namespace alidade {

using blue_noise::Block;
using blue_noise::Brick;
using blue_noise::kLanes;
using blue_noise::kNone;
using blue_noise::Neighbourhood;

namespace {

/// Spacings above are scaled down to this many bits, so that squares below the spacing's are exact in floats.
/// Larger ones are rounded, and stay larger.
constexpr int kSpacingBits = 12;
/// Added to coordinates before they are cut into bricks: none is negative then, and no block straddles a tile's edge.
constexpr std::int32_t kBias = 1 << 19;
/// Bricks with fewer points than this on average are taken in groups: registers are to be filled.
constexpr std::size_t kFewInBrick = 7;
constexpr std::uint64_t kEveryBlock = ~std::uint64_t{0};
constexpr std::uint64_t kAxisBits = spreadBits(~std::uint64_t{0});
constexpr std::uint64_t kScatter = 0x9e3779b97f4a7c15ull;
constexpr std::uint8_t kFirst = 127;  ///< split bits of a point without one before it

/// Where a brick stands in its block: the Morton code of two bits an axis.
std::uint32_t placeInBlock(std::int32_t x, std::int32_t y, std::int32_t z) {
  const auto spread = [](std::int32_t v) { return static_cast<std::uint32_t>((v & 1) | (v & 2) << 2); };
  return spread(x) | spread(y) << 1 | spread(z) << 2;
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
std::array<std::int32_t, 256> logTable() {
  std::array<std::int32_t, 256> table{};
  for (int i = 0; i < 256; ++i) table[i] = static_cast<std::int32_t>(std::lround(32.0 * std::log2(1.0 + (i + 0.5) / 256.0)));
  return table;
}

const std::array<std::int32_t, 256> kLogTable = logTable();

constexpr std::size_t kRated = 256;

/// Levels of points of a pass by their squared distances d² << 2 shift: 64 (10 - log2(d)), more than any for 0; of
/// accepted ones 0.
ALIDADE_WIDEST void levelsOf(const float* squared, std::size_t count, int shift, int shallowest, int deepest,
                             std::int32_t* __restrict levels) {
  const std::int32_t* __restrict table = kLogTable.data();
  const std::int32_t most = (kFinestPass - shift) * kLevelSteps + 127 * 32;
  for (std::size_t i = 0; i < count; ++i) {
    const auto bits = std::bit_cast<std::int32_t>(squared[i]);
    std::int32_t level = most - ((bits >> 23 & 255) * 32 + table[bits >> 15 & 255]);
    level = level < shallowest ? shallowest : level;
    level = level > deepest ? deepest : level;
    levels[i] = level & ~(bits >> 31);
  }
}

/// Levels of the rejected points of a pass.
void rate(const float* squared, const std::uint32_t* index, std::size_t count, int shift, int shallowest, int deepest,
          std::int16_t* levels) {
  std::array<std::int32_t, kRated> some;
  for (std::size_t first = 0; first < count; first += kRated) {
    const std::size_t n = std::min(kRated, count - first);
    levelsOf(squared + first, n, shift, shallowest, deepest, some.data());
    for (std::size_t i = 0; i < n; ++i) levels[index[first + i]] = static_cast<std::int16_t>(some[i]);
  }
}

/// A column of places as floats.
ALIDADE_WIDEST void widen(const std::uint16_t* from, std::size_t count, float* to) {
  for (std::size_t i = 0; i < count; ++i) to[i] = from[i];
}

/// Whole numbers times a power of two, cut to whole ones.
ALIDADE_WIDEST void scaleDown(float* column, std::size_t count, float by) {
  for (std::size_t i = 0; i < count; ++i) column[i] = static_cast<float>(static_cast<std::int32_t>(column[i] * by));
}

/// Axis bits up to the highest in which a point and the one before it differ; of the first point nothing.
ALIDADE_WIDEST void findSplits(const float* x, const float* y, const float* z, std::size_t count, std::uint8_t* bits) {
  const auto differingIn = [](const float* column, std::size_t i) {
    return static_cast<std::int32_t>(column[i]) ^ static_cast<std::int32_t>(column[i - 1]);
  };
  for (std::size_t i = 1; i < count; ++i) {
    const std::int32_t differing = differingIn(x, i) | differingIn(y, i) | differingIn(z, i);
    // A whole number below 2^16 is exact as a float, whose exponent is its highest bit.
    const std::int32_t width = (std::bit_cast<std::int32_t>(static_cast<float>(differing)) >> 23) - 126;
    bits[i] = static_cast<std::uint8_t>(width > 0 ? width : 0);
  }
}

/// One bit for each of 64 numbers that exceeds the limit; all below 128.
std::uint64_t exceeding(const std::uint8_t* numbers, int limit) {
  std::uint64_t bits = 0;
#if defined(__x86_64__)
  const __m128i limits = _mm_set1_epi8(static_cast<char>(limit));
  for (int part = 0; part < 4; ++part) {
    const __m128i some = _mm_loadu_si128(reinterpret_cast<const __m128i*>(numbers + 16 * part));
    bits |= static_cast<std::uint64_t>(static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpgt_epi8(some, limits)))) << 16 * part;
  }
#else
  for (int i = 0; i < 64; ++i) bits |= static_cast<std::uint64_t>(numbers[i] > limit) << i;
#endif
  return bits;
}

using Choose = std::size_t (*)(const blue_noise::Pass&);

Choose widestChoose() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("bmi2"))
    return blue_noise::chooseAvx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2")) return blue_noise::chooseAvx2;
#endif
  return blue_noise::chooseScalar;
}

}  // namespace

struct BlueNoise::Spacing {
  int q = 0;
  int brickBits = 0;  ///< a brick's edge is twice the spacing
  int shift = 0;      ///< units are halved this often before they are squared

  /// The Morton code of the brick that holds a place of this Morton code.
  std::uint64_t brickOf(std::uint64_t code) const { return (code | mortonOf(kBias, kBias, kBias)) >> 3 * brickBits; }
};

void BlueNoise::Survivors::reserve(std::size_t points) {
  if (apart >= points + kLanes) return;
  apart = points + kLanes;
  places.assign(3 * apart, 0);
  index.resize(apart);
}

void BlueNoise::Survivors::take(const blue_noise::Sample* samples, std::size_t points) {
  float *x = column(0), *y = column(1), *z = column(2);
  for (std::size_t i = 0; i < points; ++i)
    x[i] = samples[i].x, y[i] = samples[i].y, z[i] = samples[i].z, index[i] = samples[i].index;
  count = points;
}

BlueNoise::Slot* BlueNoise::slotOf(std::uint64_t code) {
  // The product's upper bits depend on all of the code's.
  for (std::uint64_t at = (code * kScatter) >> m_tableShift;; ++at) {
    Slot* slot = &m_table[at & m_tableMask];
    if (slot->key == 0 || slot->key == code + 1) return slot;
  }
}

std::array<std::uint32_t, 27> BlueNoise::blocksAround(std::uint64_t code, std::uint64_t limit) {
  // Each axis of the code one less, as it is and one more: what stands between its bits hands the carry on.
  std::array<std::array<std::uint64_t, 3>, 3> axes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint64_t bits = kAxisBits << axis, one = std::uint64_t{1} << axis, own = code & bits;
    axes[axis] = {(own - one) & bits, own, ((own | ~bits) + one) & bits};
  }
  std::array<std::uint64_t, 27> codes;
  for (std::size_t n = 0; n < 27; ++n) codes[n] = axes[0][n % 3] | axes[1][n / 3 % 3] | axes[2][n / 9];
  // What cannot be predicted is not: which of them are wanted, and what the first slot, which nearly always tells, says.
  std::array<std::uint8_t, 27> wanted;
  std::size_t count = 0;
  for (std::size_t n = 0; n < 27; ++n) wanted[count] = static_cast<std::uint8_t>(n), count += codes[n] < limit;
  std::array<std::uint32_t, 27> around;
  around.fill(kNone);
  std::uint32_t open = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t n = wanted[i];
    const Slot& slot = m_table[(codes[n] * kScatter) >> m_tableShift & m_tableMask];
    const bool isIt = slot.key == codes[n] + 1;
    around[n] = isIt ? slot.block : kNone;
    open |= static_cast<std::uint32_t>(!isIt & (slot.key != 0)) << n;
  }
  for (; open != 0; open &= open - 1) {
    const auto n = static_cast<std::size_t>(std::countr_zero(open));
    if (const Slot* slot = slotOf(codes[n]); slot->key != 0) around[n] = slot->block;
  }
  return around;
}

/// Cuts the survivors into bricks, and the bricks into blocks.
void BlueNoise::layBricks(const Spacing& spacing, std::span<const std::uint64_t> codes) {
  m_bricks.clear();
  m_blocks.clear();
  const int wholeBrick = spacing.brickBits - spacing.shift;
  const auto begin = [&](std::uint32_t i) {
    const std::uint64_t brick = spacing.brickOf(codes[m_alive.index[i]]);
    if (i == 0 || m_splitBits[i] > wholeBrick + 2) {
      Block& block = m_blocks.emplace_back();
      block.code = brick >> 6;
      block.firstBrick = static_cast<std::uint32_t>(m_bricks.size());
    }
    m_blocks.back().filled |= std::uint64_t{1} << (brick & 63);
    if (i > 0) m_bricks.back().last = i;
    m_bricks.push_back({i, 0});
  };
  m_splitBits.resize(std::max(m_splitBits.size(), m_alive.count + 64));  // 64 are looked at at a time
  findSplits(m_alive.column(0), m_alive.column(1), m_alive.column(2), m_alive.count, m_splitBits.data());
  m_splitBits[0] = kFirst;
  for (std::uint32_t first = 0; first < m_alive.count; first += 64) {
    std::uint64_t starts = exceeding(m_splitBits.data() + first, wholeBrick);
    if (m_alive.count - first < 64) starts &= (std::uint64_t{1} << (m_alive.count - first)) - 1;
    for (; starts != 0; starts &= starts - 1) begin(first + static_cast<std::uint32_t>(std::countr_zero(starts)));
  }
  m_bricks.back().last = static_cast<std::uint32_t>(m_alive.count);
  m_tableMask = std::bit_ceil(2 * m_blocks.size() + 16) - 1;
  m_tableShift = std::countl_zero(m_tableMask);
  m_table.assign(m_tableMask + 1, {});
  for (std::size_t b = 0; b < m_blocks.size(); ++b) *slotOf(m_blocks[b].code) = {m_blocks[b].code + 1, static_cast<std::uint32_t>(b)};
  for (Block& block : m_blocks) block.before = blocksAround(block.code, block.code + 1);
}

/// Sets how far the points of bricks about obstacles are from them.
void BlueNoise::obstruct(const Spacing& spacing, std::span<const Obstacle> obstacles) {
  m_nearSquared.clear();
  const auto cut = [&](std::int32_t v) { return (v + kBias) >> spacing.brickBits; };
  const auto sameBrick = [&](const Obstacle& a, const Obstacle& b) {
    return cut(a.x) == cut(b.x) && cut(a.y) == cut(b.y) && cut(a.z) == cut(b.z);
  };
  std::vector<glm::vec3> samples;
  for (std::size_t i = 0; i < obstacles.size();) {
    const Obstacle& first = obstacles[i];
    samples.clear();
    for (; i < obstacles.size() && sameBrick(obstacles[i], first); ++i)
      if (obstacles[i].from <= spacing.q)
        samples.emplace_back(obstacles[i].x >> spacing.shift, obstacles[i].y >> spacing.shift, obstacles[i].z >> spacing.shift);
    if (samples.empty()) continue;
    const std::uint64_t brickCode = mortonOf(static_cast<std::uint64_t>(cut(first.x)), static_cast<std::uint64_t>(cut(first.y)),
                                             static_cast<std::uint64_t>(cut(first.z)));
    const auto around = blocksAround(brickCode >> 6, kEveryBlock);
    const Neighbourhood& neighbours = neighbourhoods(1)[brickCode & 63];
    for (std::uint8_t e = 0; e < neighbours.count; ++e) {
      const std::uint32_t at = around[neighbours.entries[e].block];
      if (at == kNone) continue;
      const Block& block = m_blocks[at];
      for (std::uint64_t bits = block.filled & neighbours.entries[e].bricks; bits != 0; bits &= bits - 1) {
        Brick& brick = m_bricks[block.firstBrick + static_cast<std::uint32_t>(std::popcount(block.filled & ((bits & -bits) - 1)))];
        if (brick.nearAt == kNone) {
          brick.nearAt = static_cast<std::uint32_t>(m_nearSquared.size());
          m_nearSquared.resize(m_nearSquared.size() + (brick.last - brick.first), std::numeric_limits<float>::max());
        }
        for (std::uint32_t p = brick.first; p < brick.last; ++p) {
          float& least = m_nearSquared[brick.nearAt + (p - brick.first)];
          for (const glm::vec3& sample : samples) {
            const glm::vec3 apart = m_alive.at(p) - sample;
            least = std::min(least, glm::dot(apart, apart));
          }
        }
      }
    }
  }
}

void BlueNoise::runPass(int q, bool isFirst, const TilePoints& points, std::span<const Obstacle> obstacles, std::span<std::int16_t> levels,
                        std::span<const std::int8_t> settled) {
  const int spacingBits = kFinestPass - q;
  Spacing spacing;
  spacing.q = q;
  spacing.brickBits = spacingBits + 1;
  spacing.shift = std::max(0, spacingBits - kSpacingBits);
  if (spacing.shift > 0) {  // one more than in the pass before
    for (std::size_t axis = 0; axis < 3; ++axis) scaleDown(m_alive.column(axis), m_alive.count, 0.5f);
  }
  layBricks(spacing, points.code);
  obstruct(spacing, obstacles);
  m_given.clear();
  for (std::size_t i = 0; i < m_alive.count && !settled.empty(); ++i) m_given.push_back(settled[m_alive.index[i]] <= q);
  if (m_accepted.size() < m_alive.count + blue_noise::kSamples) {
    m_accepted.resize(m_alive.count + blue_noise::kSamples);
    m_samplesNear.resize(m_accepted.size());
  }
  if (m_squared.size() < m_alive.count + kLanes) m_squared.resize(m_alive.count + kLanes);
  const bool grouped = m_alive.count < kFewInBrick * m_bricks.size();
  blue_noise::Pass pass;
  pass.places = m_alive.places.data(), pass.apart = m_alive.apart;
  pass.index = m_alive.index.data();
  pass.accepted = m_accepted.data(), pass.near = m_samplesNear.data();
  pass.squared = m_squared.data();
  pass.bricks = m_bricks.data();
  pass.blocks = m_blocks.data(), pass.blockCount = m_blocks.size();
  pass.neighbourhoods = neighbourhoods(grouped ? 2 : 1).data();
  pass.groupBricks = grouped ? 8 : 1;
  pass.spacingSquared = static_cast<float>(std::int32_t{1} << 2 * (spacingBits - spacing.shift));
  pass.nearSquared = m_nearSquared.data();
  pass.given = m_given.empty() ? nullptr : m_given.data();
  static const Choose choose = widestChoose();
  const std::size_t accepted = choose(pass);
  rate(m_squared.data(), m_alive.index.data(), m_alive.count, spacing.shift, q * kLevelSteps,
       isFirst ? kDeepestLevelStep : (q + 1) * kLevelSteps - 1, levels.data());
  m_alive.take(m_accepted.data(), accepted);
}

std::vector<std::uint32_t> BlueNoise::thin(const TilePoints& points, std::span<const Obstacle> obstacles, int finest,
                                           int coarsest, std::span<std::int16_t> levels, std::span<const std::int8_t> settled) {
  const std::size_t count = points.x.size();
  m_alive.reserve(count);
  m_alive.count = count;
  std::iota(m_alive.index.begin(), m_alive.index.begin() + static_cast<std::ptrdiff_t>(count), 0u);
  const std::array columns{points.x, points.y, points.z};
  const int shift = std::max(0, kFinestPass - finest - kSpacingBits);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    widen(columns[axis].data(), count, m_alive.column(axis));
    if (shift > 1) scaleDown(m_alive.column(axis), count, std::ldexp(1.0f, 1 - shift));
  }
  m_near.assign(obstacles.begin(), obstacles.end());
  const auto codeOf = [](const Obstacle& o) {
    return mortonOf(static_cast<std::uint64_t>(o.x + kBias), static_cast<std::uint64_t>(o.y + kBias), static_cast<std::uint64_t>(o.z + kBias));
  };
  std::sort(m_near.begin(), m_near.end(), [&](const Obstacle& a, const Obstacle& b) { return codeOf(a) < codeOf(b); });
  for (int q = finest; q >= coarsest && m_alive.count > 0; --q) runPass(q, q == finest, points, m_near, levels, settled);
  return {m_alive.index.begin(), m_alive.index.begin() + static_cast<std::ptrdiff_t>(m_alive.count)};
}

int finestPassOf(std::span<const std::uint64_t> codes, int droppedBits) {
  // alone[k]: points that share their cell of 2^k units with no other before them.
  std::array<std::uint64_t, 24> alone{};
  // Counted by bits and by turns: the same counter twice running would wait for itself.
  std::array<std::array<std::uint32_t, 65>, 4> counts{};
  for (std::size_t i = 1; i < codes.size(); ++i) ++counts[i & 3][static_cast<std::size_t>(std::bit_width(codes[i] ^ codes[i - 1]))];
  for (const auto& turn : counts)
    for (std::size_t bits = 0; bits < turn.size(); ++bits) alone[(bits + 2) / 3] += turn[bits];
  // So far by the highest axis bit in which a point and the one before it differ, counted from 1.
  for (std::size_t k = alone.size() - 1; k-- > 0;) alone[k] += alone[k + 1];
  std::rotate(alone.begin(), alone.begin() + 1, alone.end());
  const int finestBits = std::max(0, droppedBits - 1);
  int bits = finestBits;
  while (bits < kFinestPass - kCoarsestPass && static_cast<double>(alone[bits] + 1) > 0.75 * static_cast<double>(codes.size())) ++bits;
  return kFinestPass - bits;
}

}  // namespace alidade

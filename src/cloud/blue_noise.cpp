// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/blue_noise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

// The hot loop in the widest registers the processor has; integers, so that all of them agree.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define ALIDADE_WIDEST __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define ALIDADE_WIDEST
#endif

namespace alidade {

namespace {

constexpr std::size_t kLanes = 16;
/// Farther from any point of a brick than any spacing, near enough for 32-bit squares.
constexpr std::int32_t kNowhere = 28000;
/// Spacings above are scaled down to this many bits, so that squares fit.
constexpr int kSpacingBits = 12;

/// Smallest squared distance from (px, py, pz) to `count` candidates, a multiple of kLanes.
ALIDADE_WIDEST std::int32_t nearestSquared(const std::int32_t* x, const std::int32_t* y, const std::int32_t* z,
                                           std::size_t count, std::int32_t px, std::int32_t py, std::int32_t pz) {
  std::int32_t best[kLanes];
  for (std::size_t lane = 0; lane < kLanes; ++lane) best[lane] = std::numeric_limits<std::int32_t>::max();
  for (std::size_t i = 0; i < count; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::int32_t dx = x[i + lane] - px, dy = y[i + lane] - py, dz = z[i + lane] - pz;
      const std::int32_t squared = dx * dx + dy * dy + dz * dz;
      best[lane] = squared < best[lane] ? squared : best[lane];
    }
  }
  std::int32_t least = best[0];
  for (std::size_t lane = 1; lane < kLanes; ++lane) least = best[lane] < least ? best[lane] : least;
  return least;
}

/// 32 log2(m) for m = 1 + (i + 0.5) / 256.
std::array<std::int16_t, 256> logTable() {
  std::array<std::int16_t, 256> table{};
  for (int i = 0; i < 256; ++i) table[i] = static_cast<std::int16_t>(std::lround(32.0 * std::log2(1.0 + (i + 0.5) / 256.0)));
  return table;
}

/// 64 (10 - log2(d)) for d² = squared << 2 shift units².
int levelStepOf(std::int32_t squared, int shift) {
  static const std::array<std::int16_t, 256> table = logTable();
  if (squared <= 0) return kDeepestLevelStep;
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(squared));
  const int log32 = (static_cast<int>(bits >> 23) - 127) * 32 + table[bits >> 15 & 255];
  return kFinestPass * kLevelSteps - log32 - shift * kLevelSteps;
}

}  // namespace

struct BlueNoise::Pass {
  int q = 0;
  int spacingBits = 0;     ///< of the spacing, units
  int brickBits = 0;       ///< a brick's edge is twice the spacing
  int shift = 0;           ///< units are halved this often before they are squared
  std::int32_t spacing = 0;
  std::int32_t spacingSquared = 0;  ///< shifted
};

void BlueNoise::Set::clear() {
  index.clear();
  x.clear(), y.clear(), z.clear();
}

void BlueNoise::Set::push(const Set& from, std::size_t i) {
  index.push_back(from.index[i]);
  x.push_back(from.x[i]), y.push_back(from.y[i]), z.push_back(from.z[i]);
}

std::uint32_t* BlueNoise::slotOf(std::int32_t x, std::int32_t y, std::int32_t z) {
  const auto part = [](std::int32_t v) { return static_cast<std::uint64_t>(v) & 0x1fffff; };
  const std::uint64_t key = part(x) | part(y) << 21 | part(z) << 42;
  // The product's upper bits depend on all of the key's.
  std::uint64_t at = (key * 0x9e3779b97f4a7c15ull) >> m_tableShift;
  for (;; ++at) {
    std::uint32_t* slot = &m_table[at & m_tableMask];
    if (*slot == 0) return slot;
    const Brick& brick = m_bricks[*slot - 1];
    if (brick.x == x && brick.y == y && brick.z == z) return slot;
  }
}

/// Cuts the survivors into bricks, and sorts the obstacles that matter in this pass into theirs.
void BlueNoise::layBricks(const Pass& pass, std::span<const Obstacle> obstacles) {
  m_bricks.clear();
  const int bits = pass.brickBits;
  for (std::size_t i = 0; i < m_alive.size(); ++i) {
    const std::int32_t x = m_alive.x[i] >> bits, y = m_alive.y[i] >> bits, z = m_alive.z[i] >> bits;
    if (m_bricks.empty() || m_bricks.back().x != x || m_bricks.back().y != y || m_bricks.back().z != z) {
      Brick brick;
      brick.x = x, brick.y = y, brick.z = z;
      brick.first = static_cast<std::uint32_t>(i);
      m_bricks.push_back(brick);
    }
    m_bricks.back().last = static_cast<std::uint32_t>(i + 1);
  }
  m_near.clear();
  for (const Obstacle& o : obstacles)
    if (o.from <= pass.q) m_near.push_back(o);
  const auto brickOf = [bits](const Obstacle& o) { return std::array{o.z >> bits, o.y >> bits, o.x >> bits}; };
  std::sort(m_near.begin(), m_near.end(), [&](const Obstacle& a, const Obstacle& b) {
    const auto left = brickOf(a), right = brickOf(b);
    if (left != right) return left < right;
    return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
  });
  const std::size_t most = m_bricks.size() + m_near.size();
  m_tableMask = std::bit_ceil(2 * most + 16) - 1;
  m_tableShift = std::countl_zero(m_tableMask);
  m_table.assign(m_tableMask + 1, 0);
  for (std::size_t b = 0; b < m_bricks.size(); ++b)
    *slotOf(m_bricks[b].x, m_bricks[b].y, m_bricks[b].z) = static_cast<std::uint32_t>(b + 1);
  for (std::size_t i = 0; i < m_near.size();) {
    const auto [z, y, x] = brickOf(m_near[i]);
    std::uint32_t* slot = slotOf(x, y, z);
    if (*slot == 0) {
      Brick brick;
      brick.x = x, brick.y = y, brick.z = z;
      m_bricks.push_back(brick);
      *slot = static_cast<std::uint32_t>(m_bricks.size());
    }
    Brick& brick = m_bricks[*slot - 1];
    brick.obstacleFirst = static_cast<std::uint32_t>(i);
    while (i < m_near.size() && brickOf(m_near[i]) == std::array{z, y, x}) ++i;
    brick.obstacleLast = static_cast<std::uint32_t>(i);
  }
}

void BlueNoise::addCandidate(std::int32_t x, std::int32_t y, std::int32_t z) {
  if (m_candidates % kLanes == 0) {
    const std::size_t size = m_candidates + kLanes;
    if (m_cx.size() < size) m_cx.resize(2 * size), m_cy.resize(2 * size), m_cz.resize(2 * size);
    std::fill_n(m_cx.begin() + static_cast<std::ptrdiff_t>(m_candidates), kLanes, kNowhere);
    std::fill_n(m_cy.begin() + static_cast<std::ptrdiff_t>(m_candidates), kLanes, 0);
    std::fill_n(m_cz.begin() + static_cast<std::ptrdiff_t>(m_candidates), kLanes, 0);
  }
  m_cx[m_candidates] = x, m_cy[m_candidates] = y, m_cz[m_candidates] = z;
  ++m_candidates;
}

/// Accepted samples and obstacles within the spacing of the brick, in (shifted) units from its corner.
void BlueNoise::gather(const Pass& pass, const Brick& brick, bool own) {
  m_candidates = 0;
  const std::int32_t cornerX = brick.x << pass.brickBits, cornerY = brick.y << pass.brickBits, cornerZ = brick.z << pass.brickBits;
  const std::int32_t low = -pass.spacing, high = (std::int32_t{1} << pass.brickBits) + pass.spacing;
  const auto consider = [&](std::int32_t px, std::int32_t py, std::int32_t pz) {
    const std::int32_t x = px - cornerX, y = py - cornerY, z = pz - cornerZ;
    if (x <= low || y <= low || z <= low || x >= high || y >= high || z >= high) return;
    addCandidate(x >> pass.shift, y >> pass.shift, z >> pass.shift);
  };
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const std::uint32_t slot = *slotOf(brick.x + dx, brick.y + dy, brick.z + dz);
        if (slot == 0) continue;
        const Brick& other = m_bricks[slot - 1];
        if (own || &other != &brick)
          for (std::uint32_t i = other.acceptedFirst; i < other.acceptedLast; ++i)
            consider(m_accepted.x[i], m_accepted.y[i], m_accepted.z[i]);
        for (std::uint32_t i = other.obstacleFirst; i < other.obstacleLast; ++i)
          consider(m_near[i].x, m_near[i].y, m_near[i].z);
      }
    }
  }
}

void BlueNoise::runPass(int q, bool isFirst, std::span<const Obstacle> obstacles, std::span<std::int16_t> levels,
                        std::span<const std::int8_t> settled) {
  Pass pass;
  pass.q = q;
  pass.spacingBits = kFinestPass - q;
  pass.brickBits = pass.spacingBits + 1;
  pass.shift = std::max(0, pass.spacingBits - kSpacingBits);
  pass.spacing = std::int32_t{1} << pass.spacingBits;
  pass.spacingSquared = std::int32_t{1} << 2 * (pass.spacingBits - pass.shift);
  layBricks(pass, obstacles);
  m_accepted.clear();
  m_rejected.assign(m_alive.size(), 0);
  const auto nearestTo = [&](std::size_t i, const Brick& brick) {
    const auto at = [&](std::uint16_t v, std::int32_t cell) { return (v - (cell << pass.brickBits)) >> pass.shift; };
    return nearestSquared(m_cx.data(), m_cy.data(), m_cz.data(), (m_candidates + kLanes - 1) / kLanes * kLanes,
                          at(m_alive.x[i], brick.x), at(m_alive.y[i], brick.y), at(m_alive.z[i], brick.z));
  };
  for (Brick& brick : m_bricks) {
    if (brick.first == brick.last) continue;
    brick.acceptedFirst = brick.acceptedLast = static_cast<std::uint32_t>(m_accepted.size());
    gather(pass, brick, false);
    for (std::size_t i = brick.first; i < brick.last; ++i) {
      const bool given = !settled.empty() && settled[m_alive.index[i]] <= q;
      if (!given && nearestTo(i, brick) < pass.spacingSquared) {
        m_rejected[i] = 1;
        continue;
      }
      m_accepted.push(m_alive, i);
      addCandidate((m_alive.x[i] - (brick.x << pass.brickBits)) >> pass.shift,
                   (m_alive.y[i] - (brick.y << pass.brickBits)) >> pass.shift,
                   (m_alive.z[i] - (brick.z << pass.brickBits)) >> pass.shift);
    }
    brick.acceptedLast = static_cast<std::uint32_t>(m_accepted.size());
  }
  // Once all are chosen: how far a rejected point is from the nearest of them.
  const int deepest = isFirst ? kDeepestLevelStep : (q + 1) * kLevelSteps - 1;
  for (const Brick& brick : m_bricks) {
    if (brick.last - brick.first == brick.acceptedLast - brick.acceptedFirst) continue;
    gather(pass, brick, true);
    for (std::size_t i = brick.first; i < brick.last; ++i) {
      if (!m_rejected[i]) continue;
      const int level = levelStepOf(nearestTo(i, brick), pass.shift);
      levels[m_alive.index[i]] = static_cast<std::int16_t>(std::clamp(level, q * kLevelSteps, deepest));
    }
  }
  std::swap(m_alive, m_accepted);
}

std::vector<std::uint32_t> BlueNoise::thin(const TilePoints& points, std::span<const Obstacle> obstacles, int finest,
                                           int coarsest, std::span<std::int16_t> levels, std::span<const std::int8_t> settled) {
  m_alive.index.resize(points.x.size());
  for (std::size_t i = 0; i < points.x.size(); ++i) m_alive.index[i] = static_cast<std::uint32_t>(i);
  m_alive.x.assign(points.x.begin(), points.x.end());
  m_alive.y.assign(points.y.begin(), points.y.end());
  m_alive.z.assign(points.z.begin(), points.z.end());
  for (int q = finest; q >= coarsest && m_alive.size() > 0; --q) runPass(q, q == finest, obstacles, levels, settled);
  return std::move(m_alive.index);
}

int finestPassOf(std::span<const std::uint64_t> codes, int droppedBits) {
  // alone[k]: points that share their cell of 2^k units with no other before them.
  std::array<std::uint64_t, 18> alone{};
  for (std::size_t i = 1; i < codes.size(); ++i) {
    const std::uint64_t differing = codes[i] ^ codes[i - 1];
    const int bit = differing == 0 ? -1 : (63 - std::countl_zero(differing)) / 3;
    for (int k = 0; k <= std::min(bit, 17); ++k) ++alone[k];
  }
  const int finestBits = std::max(0, droppedBits - 1);
  int bits = finestBits;
  while (bits < kFinestPass - kCoarsestPass && static_cast<double>(alone[bits] + 1) > 0.75 * static_cast<double>(codes.size())) ++bits;
  return kFinestPass - bits;
}

}  // namespace alidade

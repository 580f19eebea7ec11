// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Compiled once for each instruction set. Everything here belongs to its own translation unit.

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "cloud/blue_noise_pass.h"

namespace alidade::blue_noise {
namespace {

using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

inline Lanes lanesAt(const float* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

inline void put(const Lanes& lanes, float* to) {
  std::memcpy(to, &lanes, sizeof lanes);
}

/// One bit a lane that is at least the limit.
inline std::uint32_t atLeast(const Lanes& lanes, float limit) {
#if defined(__AVX512F__)
  return _mm512_cmp_ps_mask(reinterpret_cast<const __m512&>(lanes), _mm512_set1_ps(limit), _CMP_GE_OQ);
#elif defined(__AVX__)
  __m256 halves[2];
  std::memcpy(halves, &lanes, sizeof halves);
  const __m256 all = _mm256_set1_ps(limit);
  const int low = _mm256_movemask_ps(_mm256_cmp_ps(halves[0], all, _CMP_GE_OQ));
  return static_cast<std::uint32_t>(low | _mm256_movemask_ps(_mm256_cmp_ps(halves[1], all, _CMP_GE_OQ)) << 8);
#else
  std::uint32_t bits = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) bits |= static_cast<std::uint32_t>(lanes[lane] >= limit) << lane;
  return bits;
#endif
}

/// The set bits of `wanted`, all of them set in `filled`, by their ranks among those.
inline std::uint64_t ranksOf(std::uint64_t wanted, std::uint64_t filled) {
#if defined(__BMI2__)
  return _pext_u64(wanted, filled);
#else
  std::uint64_t ranks = 0;
  for (; wanted != 0; wanted &= wanted - 1)
    ranks |= std::uint64_t{1} << __builtin_popcountll(filled & ((wanted & -wanted) - 1));
  return ranks;
#endif
}

/// Runs of points, or of accepted samples.
struct Runs {
  struct Run {
    std::uint32_t from, to;
  };
  std::array<Run, 64> runs;  // left as it is: setting it costs more than using it
  std::size_t count = 0;
  void add(std::uint32_t from, std::uint32_t to) {
    if (count > 0 && runs[count - 1].to == from) runs[count - 1].to = to;
    else if (from < to) runs[count++] = {from, to};
  }
};

/// Bricks that are worked on together: one, or those of a group of 2³, as a register's worth of points.
struct Group {
  std::uint64_t bricks;  ///< of the block, filled or not
  std::uint32_t place;   ///< of its first brick
  std::uint32_t firstBrick, lastBrick;
};

/// A register's worth of points.
struct Places {
  Lanes x, y, z;

  Lanes squaredFrom(float atX, float atY, float atZ) const {
    const Lanes dx = x - atX, dy = y - atY, dz = z - atZ;
    return dx * dx + dy * dy + dz * dz;
  }
};

class Choice {
 public:
  explicit Choice(const Pass& pass) : m(pass) {}

  std::uint32_t run() {
    for (std::uint32_t b = 0; b < m.blockCount; ++b) {
      std::uint32_t brick = m.blocks[b].firstBrick;
      for (std::uint64_t bits = m.blocks[b].filled; bits != 0;) {
        const Group group = groupAt(bits, brick);
        bits &= ~group.bricks, brick = group.lastBrick;
        choose(m.blocks[b], group);
      }
    }
    return m_kept;
  }

 private:
  Group groupAt(std::uint64_t bitsLeft, std::uint32_t firstBrick) const {
    const auto place = static_cast<std::uint32_t>(__builtin_ctzll(bitsLeft));
    if (m.groupBricks == 1) return {bitsLeft & -bitsLeft, place, firstBrick, firstBrick + 1};
    const std::uint64_t bricks = std::uint64_t{255} << (place & ~7u);
    return {bricks, place & ~7u, firstBrick, firstBrick + static_cast<std::uint32_t>(__builtin_popcountll(bitsLeft & bricks))};
  }

  /// What lies in the bricks around a group that come before it: their points, and the accepted among them.
  void findBefore(const Block& block, const Group& group, Runs& points, Runs& samples) const {
    const Neighbourhood& neighbours = m.neighbourhoods[group.place];
    for (std::uint8_t e = 0; e < neighbours.count; ++e) {
      const std::uint32_t at = block.before[neighbours.entries[e].block];
      if (at == kNone) continue;
      const Block& other = m.blocks[at];
      std::uint64_t bits = other.filled & neighbours.entries[e].bricks;
      if (&other == &block) bits &= (std::uint64_t{1} << group.place) - 1;
      // Bricks that follow each other are one run of points: no neighbourhood fills its block, so that a run ends.
      for (std::uint64_t ranks = ranksOf(bits, other.filled); ranks != 0; ranks &= ranks + (ranks & -ranks)) {
        const auto first = static_cast<std::uint32_t>(__builtin_ctzll(ranks));
        const auto length = static_cast<std::uint32_t>(__builtin_ctzll(~(ranks >> first)));
        const Brick* bricks = m.bricks + other.firstBrick + first;
        points.add(bricks[0].first, bricks[length - 1].last);
        samples.add(bricks[0].acceptedFirst, bricks[length - 1].acceptedLast);
      }
    }
  }

  /// Samples one after the other, so that one loop goes over them: how long many short ones are cannot be predicted.
  const Sample* gather(const Runs& samples) const {
    Sample* to = m.near;
    for (std::size_t r = 0; r < samples.count; ++r) {
      const Runs::Run& run = samples.runs[r];
      for (std::uint32_t i = run.from; i < run.to; i += kSamples) std::memcpy(to + (i - run.from), m.accepted + i, kSamples * sizeof(Sample));
      to += run.to - run.from;
    }
    return to;
  }

  Places placesAt(std::uint32_t i) const {
    const float* x = m.places + i;
    return {lanesAt(x), lanesAt(x + m.apart), lanesAt(x + 2 * m.apart)};
  }

  /// Squared distances of points, lowered to what accepted samples make them.
  static Lanes lowered(const Places& places, Lanes least, const Sample* sample, const Sample* end) {
    for (; sample != end; ++sample) {
      const Lanes here = places.squaredFrom(sample->x, sample->y, sample->z);
      least = here < least ? here : least;
    }
    return least;
  }
  void lower(std::uint32_t i, std::uint32_t from, std::uint32_t to) {
    put(lowered(placesAt(i), lanesAt(m.squared + i), m.accepted + from, m.accepted + to), m.squared + i);
  }

  /// What a register holds beyond a run's end is either written again by the bricks that follow, or is lowered to
  /// what lies farther off than what lowered it before.
  void choose(const Block& block, const Group& group) {
    Runs points, samples;
    findBefore(block, group, points, samples);
    const std::uint32_t first = m.bricks[group.firstBrick].first, last = m.bricks[group.lastBrick - 1].last;
    const Sample* nearEnd = gather(samples);
    for (std::uint32_t v = first; v < last; v += kLanes)
      put(lowered(placesAt(v), Lanes{} + std::numeric_limits<float>::max(), m.near, nearEnd), m.squared + v);
    for (std::uint32_t b = group.firstBrick; b < group.lastBrick; ++b) {
      const Brick& brick = m.bricks[b];
      for (std::uint32_t i = brick.first; brick.nearAt != kNone && i < brick.last; ++i)
        m.squared[i] = std::min(m.squared[i], m.nearSquared[brick.nearAt + (i - brick.first)]);
    }
    const std::uint32_t keptBefore = m_kept;
    m_brick = group.firstBrick;
    m.bricks[m_brick].acceptedFirst = m_kept;
    for (std::uint32_t v = first; v < last; v += kLanes) {
      const std::uint32_t kept = m_kept;
      std::uint32_t taken = chooseAmong(v, last);
      for (std::uint32_t w = first; kept < m_kept && w < last; w += kLanes) lower(w, kept, m_kept);
      for (; taken != 0; taken &= taken - 1) m.squared[v + static_cast<std::uint32_t>(__builtin_ctz(taken))] = kAccepted;
    }
    closeBricks(last - 1);
    m.bricks[m_brick].acceptedLast = m_kept;
    for (std::size_t r = 0; keptBefore < m_kept && r < points.count; ++r)
      for (std::uint32_t v = points.runs[r].from; v < points.runs[r].to; v += kLanes) lower(v, keptBefore, m_kept);
  }

  /// A register's worth of points from v on, those before `last`: one bit for each that is accepted.
  std::uint32_t chooseAmong(std::uint32_t v, std::uint32_t last) {
    const std::uint32_t inside = last - v >= kLanes ? 0xffff : (1u << (last - v)) - 1;
    std::uint32_t given = 0;
    for (std::uint32_t lane = 0; m.given != nullptr && lane < std::min<std::uint32_t>(kLanes, last - v); ++lane)
      given |= static_cast<std::uint32_t>(m.given[v + lane] != 0) << lane;
    const Places places = placesAt(v);
    const std::uint32_t open = (atLeast(lanesAt(m.squared + v), m.spacingSquared) | given) & inside;
    // Who would keep whom away, one beside the other; then who does, one after the other.
    std::array<std::uint32_t, kLanes> apart;
    for (std::uint32_t bits = open; bits != 0; bits &= bits - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(bits));
      const float* x = m.places + v + lane;
      apart[lane] = atLeast(places.squaredFrom(x[0], x[m.apart], x[2 * m.apart]), m.spacingSquared) | given;
    }
    std::uint32_t taken = 0;
    for (std::uint32_t left = open; left != 0;) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(left));
      accept(v + lane);
      taken |= 1u << lane;
      left &= left - 1;
      left &= apart[lane];
    }
    return taken;
  }

  void accept(std::uint32_t i) {
    closeBricks(i);
    const float* x = m.places + i;
    m.accepted[m_kept++] = {x[0], x[m.apart], x[2 * m.apart], m.index[i]};
  }

  /// Goes on to the brick of point i.
  void closeBricks(std::uint32_t i) {
    while (i >= m.bricks[m_brick].last) {
      m.bricks[m_brick].acceptedLast = m_kept;
      m.bricks[++m_brick].acceptedFirst = m_kept;
    }
  }

  const Pass m;
  std::uint32_t m_kept = 0, m_brick = 0;
};

}  // namespace
}  // namespace alidade::blue_noise

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/splat_merge.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

// Loops of plain arithmetic, in the widest registers the processor has; the build fuses nothing here.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define ALIDADE_WIDEST __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define ALIDADE_WIDEST
#endif

namespace alidade {

namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();
/// Depths that differ by less are of one surface.
constexpr float kOneSurface = 1.03f;

/// All ones is a NaN.
ALIDADE_WIDEST void depthsOf(const std::uint64_t* pixels, std::size_t count, float* depth) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto bits = static_cast<std::uint32_t>(pixels[i] >> 32);
    depth[i] = std::bit_cast<float>(bits == 0xffffffffu ? 0x7f800000u : bits);
  }
}
ALIDADE_WIDEST void depthsOf(const std::uint32_t* pixels, std::size_t count, float* depth) {
  for (std::size_t i = 0; i < count; ++i) depth[i] = std::bit_cast<float>(pixels[i] == 0xffffffffu ? 0x7f800000u : pixels[i]);
}

ALIDADE_WIDEST void nearestOf(const std::uint64_t* a, const std::uint64_t* b, std::size_t count, std::uint64_t* pixels) {
  for (std::size_t i = 0; i < count; ++i) pixels[i] = a[i] < b[i] ? a[i] : b[i];
}
ALIDADE_WIDEST void nearestOf(const std::uint32_t* a, const std::uint32_t* b, std::size_t count, std::uint32_t* pixels) {
  for (std::size_t i = 0; i < count; ++i) pixels[i] = a[i] < b[i] ? a[i] : b[i];
}

/// 1 where the middle row's pixel lies behind what is within two pixels on each of its four sides.
ALIDADE_WIDEST void findHoles(const float* top, const float* above, const float* own, const float* below, const float* bottom,
                              std::size_t count, std::uint8_t* isHole) {
  const auto nearer = [](float a, float b) __attribute__((always_inline)) { return a < b ? a : b; };
  const auto farther = [](float a, float b) __attribute__((always_inline)) { return a > b ? a : b; };
  for (std::size_t i = 0; i < count; ++i) {
    const float sides = farther(nearer(own[i - 1], own[i - 2]), nearer(own[i + 1], own[i + 2]));
    const float ends = farther(nearer(above[i], top[i]), nearer(below[i], bottom[i]));
    isHole[i] = own[i] > kOneSurface * farther(sides, ends);
  }
}

ALIDADE_WIDEST void raiseToFarthest(const float* top, const float* above, const float* own, const float* below,
                                    const float* bottom, std::size_t count, float* columns) {
  const auto nearer = [](float a, float b) __attribute__((always_inline)) { return a < b ? a : b; };
  const auto farther = [](float a, float b) __attribute__((always_inline)) { return a > b ? a : b; };
  for (std::size_t i = 0; i < count; ++i) {
    const float sides = farther(nearer(own[i - 1], own[i - 2]), nearer(own[i + 1], own[i + 2]));
    const float ends = farther(nearer(above[i], top[i]), nearer(below[i], bottom[i]));
    columns[i] = farther(columns[i], nearer(own[i], kOneSurface * farther(sides, ends)));
  }
}

std::uint32_t withDepth(float depth, std::uint32_t) {
  return std::bit_cast<std::uint32_t>(depth);
}
std::uint64_t withDepth(float depth, std::uint64_t pixel) {
  return std::uint64_t{std::bit_cast<std::uint32_t>(depth)} << 32 | (pixel & 0xffffffffu);
}

/// What faces a hole on one side.
struct Side {
  float depth;
  int away;
};

/// Of two pixels going away from the hole: the first, unless it is a hole itself.
Side sideOf(float first, float second) {
  return first <= kOneSurface * second ? Side{first, 1} : Side{second, 2};
}

float stepBetween(const Side& a, const Side& b) {
  return std::abs(a.depth - b.depth) / std::min(a.depth, b.depth);
}

}  // namespace

template <class Pixel>
MergedRows<Pixel>::MergedRows(const SplatPlanes<Pixel>& planes, int width, int height, bool closeHoles)
    : m_planes(planes), m_width(width), m_height(height), m_closeHoles(closeHoles) {
  const auto pixels = static_cast<std::size_t>(width);
  for (Row& row : m_rows) {
    row.pixels.resize(pixels);
    if (closeHoles) row.depth.assign(pixels + 2 * kReach, kNothing);
  }
  if (!closeHoles) return;
  m_closed.resize(pixels);
  m_isHole.assign((pixels + 7) / 8 * 8, 0);
}

template <class Pixel>
void MergedRows<Pixel>::join(int y) {
  Row& row = slot(y);
  const auto count = static_cast<std::size_t>(m_width);
  const bool isOutside = y < 0 || y >= m_height;
  if (isOutside || m_planes.planes.empty()) {
    std::ranges::fill(row.pixels, static_cast<Pixel>(-1));
  } else {
    const std::size_t first = static_cast<std::size_t>(y) * count;
    const auto& planes = m_planes.planes;
    if (planes.size() == 1) std::memcpy(row.pixels.data(), planes[0] + first, count * sizeof(Pixel));
    for (std::size_t k = 1; k < planes.size(); ++k)
      nearestOf(k == 1 ? planes[0] + first : row.pixels.data(), planes[k] + first, count, row.pixels.data());
  }
  if (m_closeHoles) depthsOf(row.pixels.data(), count, row.depth.data() + kReach);
}

/// The two that face each other and differ least tell the surface; at an edge it is the farther of them.
template <class Pixel>
void MergedRows<Pixel>::close(int y, int x) {
  const float* own = depthOf(y);
  const Side left = sideOf(own[x - 1], own[x - 2]), right = sideOf(own[x + 1], own[x + 2]);
  const Side up = sideOf(depthOf(y - 1)[x], depthOf(y - 2)[x]), down = sideOf(depthOf(y + 1)[x], depthOf(y + 2)[x]);
  const bool across = stepBetween(left, right) <= stepBetween(up, down);
  const Side& first = across ? left : up;
  const Side& second = across ? right : down;
  const bool isEdge = stepBetween(first, second) > kOneSurface - 1.0f;
  const bool takesFirst = isEdge ? first.depth > second.depth : first.away <= second.away;
  const int away = takesFirst ? -first.away : second.away;
  const Pixel from = across ? slot(y).pixels[static_cast<std::size_t>(x + away)] : slot(y + away).pixels[static_cast<std::size_t>(x)];
  const auto a = static_cast<float>(first.away), b = static_cast<float>(second.away);
  const float between = (a + b) / (b / first.depth + a / second.depth);
  m_closed[static_cast<std::size_t>(x)] = withDepth(isEdge ? std::max(first.depth, second.depth) : between, from);
}

template <class Pixel>
void MergedRows<Pixel>::closeHoles(int y) {
  const Row& row = slot(y);
  std::ranges::copy(row.pixels, m_closed.begin());
  findHoles(depthOf(y - 2), depthOf(y - 1), depthOf(y), depthOf(y + 1), depthOf(y + 2), row.pixels.size(), m_isHole.data());
  for (std::size_t first = 0; first < m_isHole.size(); first += 8) {
    std::uint64_t eight;
    std::memcpy(&eight, m_isHole.data() + first, 8);
    for (; eight != 0; eight &= eight - 1) close(y, static_cast<int>(first) + std::countr_zero(eight) / 8);
  }
}

template <class Pixel>
void MergedRows<Pixel>::joinAround(int y) {
  if (m_joined < 0) m_joined = y - kReach;
  for (; m_joined <= y + kReach; ++m_joined) join(m_joined);
}

template <class Pixel>
const Pixel* MergedRows<Pixel>::row(int y) {
  if (!m_closeHoles) return join(y), slot(y).pixels.data();
  joinAround(y);
  closeHoles(y);
  return m_closed.data();
}

template <class Pixel>
void MergedRows<Pixel>::addFarthest(int y, float* columns) {
  joinAround(y);
  raiseToFarthest(depthOf(y - 2), depthOf(y - 1), depthOf(y), depthOf(y + 1), depthOf(y + 2), static_cast<std::size_t>(m_width), columns);
}

template class MergedRows<std::uint32_t>;
template class MergedRows<std::uint64_t>;

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/front_peeler.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace alidade {

namespace {

constexpr std::size_t kLeastDots = 6;
constexpr std::size_t kSample = 64;
constexpr int kPeels = 8;
constexpr int kRetries = 2;
/// In distances between the surface's dots. Of random dots one quadrant in twelve is empty this far.
constexpr float kReach = 1.8f;

float square(float v) {
  return v * v;
}

}  // namespace

void FrontPeeler::gather(const DotImage& dots, int level, int cx, int cy) {
  m_all.clear();
  m_cellSize = static_cast<float>(1 << level);
  const int width = dots.inverseDepth.width(), height = dots.inverseDepth.height();
  const float middle = 0.5f * (m_cellSize - 1);
  const float left = -middle - static_cast<float>(cx << level),
              top = -middle - static_cast<float>(cy << level);
  const int x0 = std::max(0, (cx - 1) << level), x1 = std::min(width, (cx + 2) << level);
  const int y0 = std::max(0, (cy - 1) << level), y1 = std::min(height, (cy + 2) << level);
  for (int y = y0; y < y1; ++y) {
    const float* w = dots.inverseDepth.row(y);
    const std::uint16_t* place = dots.place.row(y);
    for (int x = x0; x < x1; ++x) {
      if (w[x] <= 0.0f) continue;
      const PlaceInPixel in(place[x]);
      m_all.push_back({static_cast<float>(x) + left + in.u, static_cast<float>(y) + top + in.v, w[x]});
    }
  }
  m_block = m_all;
}

bool FrontPeeler::findSurface() {
  for (int i = 0; i <= kRetries; ++i) {
    m_surface = m_block;
    if (peel()) {
      measureSpacing();
      return true;
    }
    if (m_surface.empty() || m_surface.size() >= kLeastDots) return false;
    // The few that are left stand before everything else.
    for (const BlockDot& stray : m_surface) {
      std::erase_if(m_block, [&](const BlockDot& dot) { return dot.x == stray.x && dot.y == stray.y; });
    }
  }
  return false;
}

bool FrontPeeler::peel() {
  for (int i = 0; i < kPeels && m_surface.size() >= kLeastDots; ++i) {
    // A sample of them tells a plane as well.
    const std::size_t step = m_surface.size() / kSample + 1;
    Moments moments;
    for (std::size_t j = 0; j < m_surface.size(); j += step) {
      moments.addDot(m_surface[j].x, m_surface[j].y, m_surface[j].w, 0);
    }
    m_plane = fit(moments);
    if (m_plane.w0 == 0.0f) return false;
    float squares = 0;
    for (std::size_t j = 0; j < m_surface.size(); j += step) {
      squares += square(m_surface[j].w - at(m_surface[j].x, m_surface[j].y));
    }
    m_plane.variance = squares / moments.n;
    if (squares <= square(surfaceTightness(moments.w / moments.n, m_plane)) * moments.n)
      return m_plane.good = true;
    std::erase_if(m_surface, [&](const BlockDot& dot) { return dot.w < at(dot.x, dot.y); });
  }
  return false;
}

void FrontPeeler::measureSpacing() {
  const float edge = 0.5f * m_cellSize;
  unsigned cells = 0;
  for (const BlockDot& dot : m_surface) {
    const int column = (dot.x >= -edge) + (dot.x >= edge), row = (dot.y >= -edge) + (dot.y >= edge);
    cells |= 1u << (3 * row + column);
  }
  m_occupied = std::popcount(cells);
  m_reachSquared =
      square(kReach * m_cellSize) * static_cast<float>(m_occupied) / static_cast<float>(m_surface.size());
}

void FrontPeeler::dropSurface() {
  std::erase_if(m_block, [&](const BlockDot& dot) {
    const float plane = at(dot.x, dot.y);
    return dot.w > plane - kBehindSurface * surfaceTightness(plane, m_plane);
  });
}

bool FrontPeeler::isNearest(float x, float y) const {
  float nearest = INFINITY;
  bool own = false;
  for (const BlockDot& dot : m_all) {
    const float squared = square(dot.x - x) + square(dot.y - y);
    if (squared >= nearest) continue;
    nearest = squared;
    const float plane = at(dot.x, dot.y);
    own = std::abs(dot.w - plane) < kBehindSurface * surfaceTightness(plane, m_plane);
  }
  return own;
}

bool FrontPeeler::encloses(float x, float y) const {
  unsigned quadrants = 0;
  for (const BlockDot& dot : m_surface) {
    const float dx = dot.x - x, dy = dot.y - y;
    if (dx * dx + dy * dy <= m_reachSquared) quadrants |= 1u << ((dx > 0) | (dy > 0) << 1);
    if (quadrants == 15) return true;
  }
  return false;
}

}  // namespace alidade

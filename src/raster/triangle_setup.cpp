// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <utility>

#include "raster/splat_kernel.h"
#include "raster/triangle_kernel.h"

namespace alidade {

namespace {

constexpr int kSubPixels = 256;

int roundedUp(std::int32_t x) {
  return (x + kSubPixels - 1) >> 8;
}

/// The value at (left, top) and the slopes of what is linear over the triangle.
struct Plane {
  double x1, y1, x2, y2, inverseArea;  // corners 1 and 2 from corner 0, pixels
  double dx, dy;                       // from corner 0 to (left, top)

  void fit(const float* value, std::uint32_t i0, std::uint32_t i1, std::uint32_t i2, float& start,
           float& slopeX, float& slopeY) const {
    const double v0 = value[i0], d1 = value[i1] - v0, d2 = value[i2] - v0;
    const double sx = (d1 * y2 - d2 * y1) * inverseArea, sy = (d2 * x1 - d1 * x2) * inverseArea;
    start = static_cast<float>(v0 + sx * dx + sy * dy);
    slopeX = static_cast<float>(sx);
    slopeY = static_cast<float>(sy);
  }
};

}  // namespace

void setUpTriangle(const ScreenCorners& corners, const std::uint32_t (&corner)[3], int width, int height,
                   ScreenTriangle& t) {
  t.left = t.top = 0;
  t.right = t.bottom = -1;
  std::uint32_t i[3] = {corner[0], corner[1], corner[2]};
  const auto x = [&](int k) { return corners.x[i[k]]; };
  const auto y = [&](int k) { return corners.y[i[k]]; };
  const int left = std::max(0, roundedUp(std::min({x(0), x(1), x(2)})));
  const int right = std::min(width - 1, std::max({x(0), x(1), x(2)}) >> 8);
  const int top = std::max(0, roundedUp(std::min({y(0), y(1), y(2)})));
  const int bottom = std::min(height - 1, std::max({y(0), y(1), y(2)}) >> 8);
  if (left > right || top > bottom) return;
  std::int64_t area = std::int64_t{x(1) - x(0)} * (y(2) - y(0)) - std::int64_t{x(2) - x(0)} * (y(1) - y(0));
  if (area == 0) return;
  if (area < 0) {
    std::swap(i[1], i[2]);
    area = -area;
  }
  for (int k = 0; k < 3; ++k) {
    const int n = k == 2 ? 0 : k + 1;
    const std::int32_t dx = x(n) - x(k), dy = y(n) - y(k);
    t.a[k] = -dy;
    t.b[k] = dx;
    // With y down and the inside to the right of each edge, left edges rise and top edges run right.
    const bool ownsItsPixels = dy < 0 || (dy == 0 && dx > 0);
    const std::int64_t c = std::int64_t{dy} * x(k) - std::int64_t{dx} * y(k) - (ownsItsPixels ? 0 : 1);
    t.c[k] = c >> 8;  // the rest is a x + b y in whole pixels: nothing is lost in the sign
  }
  constexpr double pixel = 1.0 / kSubPixels;
  Plane plane;
  plane.x1 = (x(1) - x(0)) * pixel;
  plane.y1 = (y(1) - y(0)) * pixel;
  plane.x2 = (x(2) - x(0)) * pixel;
  plane.y2 = (y(2) - y(0)) * pixel;
  plane.inverseArea = kSubPixels * double{kSubPixels} / static_cast<double>(area);
  plane.dx = left - x(0) * pixel;
  plane.dy = top - y(0) * pixel;
  plane.fit(corners.w, i[0], i[1], i[2], t.w0, t.wx, t.wy);
  plane.fit(corners.nx, i[0], i[1], i[2], t.nx0, t.nxx, t.nxy);
  plane.fit(corners.ny, i[0], i[1], i[2], t.ny0, t.nyx, t.nyy);
  t.left = static_cast<std::int16_t>(left);
  t.right = static_cast<std::int16_t>(right);
  t.top = static_cast<std::int16_t>(top);
  t.bottom = static_cast<std::int16_t>(bottom);
}

const TriangleKernel& triangleKernel() {
#if defined(__x86_64__)
  const SplatKernel* kernel = &splatKernel();
  if (kernel == &kAvx512SplatKernel) return kAvx512TriangleKernel;
  if (kernel == &kAvx2SplatKernel) return kAvx2TriangleKernel;
#endif
  return kScalarTriangleKernel;
}

}  // namespace alidade

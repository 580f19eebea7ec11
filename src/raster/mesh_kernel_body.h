// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// The mesh kernel, written once in GCC's vector extension and included by one .cpp for each instruction
// set, which defines ALIDADE_MESH_LANES. Everything here has internal linkage.

#include <cmath>
#include <cstring>

#include "raster/mesh_kernel.h"

namespace alidade {
namespace {

constexpr int kLanes = ALIDADE_MESH_LANES;
typedef float Floats __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * kLanes)));

#if ALIDADE_MESH_LANES == 16
constexpr Floats kColumns = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#elif ALIDADE_MESH_LANES == 8
constexpr Floats kColumns = {0, 1, 2, 3, 4, 5, 6, 7};
#else
constexpr Floats kColumns = {0, 1, 2, 3};
#endif

/// A quad's border counts as inside, so that neighbours leave no crack: pixels.
constexpr float kBorder = 1.0f / 64;

ALIDADE_LENS_INLINE Floats smaller(const Floats& a, const Floats& b) { return a < b ? a : b; }
ALIDADE_LENS_INLINE Floats larger(const Floats& a, const Floats& b) { return a > b ? a : b; }
ALIDADE_LENS_INLINE Floats absolute(const Floats& a) { return a < 0.0f ? -a : a; }
ALIDADE_LENS_INLINE Ints roundedDown(const Floats& a) {
  const Ints whole = __builtin_convertvector(a, Ints);
  // True is -1.
  return whole + (__builtin_convertvector(whole, Floats) > a);
}

/// Quads on the screen, one a lane: half planes a x + b y + c >= 0, inverse depth w0 + gx x + gy y held
/// between its corners' values.
struct ScreenQuads {
  Floats a[4], b[4], c[4];
  Floats w0, gx, gy, lowest, highest;
  Ints x0, x1, y0, y1;
};

ALIDADE_LENS_INLINE void setUp(const Floats (&u)[4], const Floats (&v)[4], const Floats (&w)[4],
                               ScreenQuads& quads) {
  const Floats zero = {};
  // Diagonals: the gradient is exact for triangles and parallelograms, the best fit for others.
  const Floats d1x = u[2] - u[0], d1y = v[2] - v[0], d1w = w[2] - w[0];
  const Floats d2x = u[3] - u[1], d2y = v[3] - v[1], d2w = w[3] - w[1];
  const Floats det = d1x * d2y - d1y * d2x;
  const Ints isFlat = absolute(det) < 1e-4f;
  const Floats inverse = 1.0f / (isFlat ? zero + 1.0f : det);
  quads.gx = isFlat ? zero : (d1w * d2y - d2w * d1y) * inverse;
  quads.gy = isFlat ? zero : (d1x * d2w - d2x * d1w) * inverse;
  const Floats middleU = 0.25f * ((u[0] + u[1]) + (u[2] + u[3]));
  const Floats middleV = 0.25f * ((v[0] + v[1]) + (v[2] + v[3]));
  quads.w0 = 0.25f * ((w[0] + w[1]) + (w[2] + w[3])) - quads.gx * middleU - quads.gy * middleV;
  quads.lowest = smaller(smaller(w[0], w[1]), smaller(w[2], w[3]));
  quads.highest = larger(larger(w[0], w[1]), larger(w[2], w[3]));
  const Floats side = det < 0.0f ? zero - 1.0f : zero + 1.0f;
  for (int i = 0; i < 4; ++i) {
    const int next = (i + 1) & 3;
    const Floats dx = u[next] - u[i], dy = v[next] - v[i];
    quads.a[i] = -side * dy;
    quads.b[i] = side * dx;
    quads.c[i] = kBorder * (absolute(dx) + absolute(dy)) - (quads.a[i] * u[i] + quads.b[i] * v[i]);
  }
}

/// Pixel rows of one quad.
ALIDADE_LENS_INLINE void fill(const ScreenQuads& quads, int lane, const MeshTarget& target) {
  const int x0 = quads.x0[lane], x1 = quads.x1[lane], y1 = quads.y1[lane];
  const Floats zero = {};
  const float lowest = quads.lowest[lane], highest = quads.highest[lane];
  const float gx = quads.gx[lane], gy = quads.gy[lane];
  for (int x = x0; x <= x1; x += kLanes) {
    const Floats column = kColumns + static_cast<float>(x);
    Floats e[4];
    for (int i = 0; i < 4; ++i) e[i] = quads.a[i][lane] * column + quads.c[i][lane];
    const Floats w = gx * column + quads.w0[lane];
    for (int y = quads.y0[lane]; y <= y1; ++y) {
      const auto row = static_cast<float>(y);
      const Ints inside = (e[0] + quads.b[0][lane] * row >= 0.0f) & (e[1] + quads.b[1][lane] * row >= 0.0f) &
                          (e[2] + quads.b[2][lane] * row >= 0.0f) & (e[3] + quads.b[3][lane] * row >= 0.0f);
      Floats value = w + gy * row;
      value = smaller(larger(value, zero + lowest), zero + highest);
      float* pixels = target.inverseDepth + static_cast<std::ptrdiff_t>(y) * target.stride + x;
      Floats old;
      std::memcpy(&old, pixels, sizeof old);
      old = larger(old, inside ? value : zero);
      std::memcpy(pixels, &old, sizeof old);
    }
  }
}

template <LensKind kind>
std::uint32_t drawKind(const MeshView& view, const OccluderPack* packs, std::uint32_t count,
                       const MeshTarget& target, std::uint32_t* left) {
  std::uint32_t leftCount = 0;
  const float* m = view.m;
  const auto width = static_cast<float>(view.width), height = static_cast<float>(view.height);
  for (std::uint32_t part = 0; part < count * (OccluderPack::kQuads / kLanes); ++part) {
    const OccluderPack& pack = packs[part * kLanes / OccluderPack::kQuads];
    const int first = static_cast<int>(part * kLanes % OccluderPack::kQuads);
    Floats u[4], v[4], w[4];
    Ints good = {}, seen = {};
    good = ~good;
    for (int k = 0; k < 4; ++k) {
      Floats x, y, z;
      std::memcpy(&x, pack.x[k] + first, sizeof x);
      std::memcpy(&y, pack.y[k] + first, sizeof y);
      std::memcpy(&z, pack.z[k] + first, sizeof z);
      const Floats px = (m[0] * x + m[1] * y) + (m[2] * z + view.t[0]);
      const Floats py = (m[3] * x + m[4] * y) + (m[5] * z + view.t[1]);
      const Floats pz = (m[6] * x + m[7] * y) + (m[8] * z + view.t[2]);
      // NaN, an empty lane, is neither good nor seen.
      const Ints before = pz >= view.nearest;
      w[k] = 1.0f / pz;
      const Floats nx = px * w[k], ny = py * w[k];
      good &= before & (nx * nx + ny * ny <= view.insideSquared);
      seen |= before;
      Floats xd, yd;
      distort<kind>(view.lens, nx, ny, xd, yd);
      u[k] = view.fx * xd + view.cx;
      v[k] = view.fy * yd + view.cy;
    }
    const Floats left0 = smaller(smaller(u[0], u[1]), smaller(u[2], u[3]));
    const Floats right0 = larger(larger(u[0], u[1]), larger(u[2], u[3]));
    const Floats top = smaller(smaller(v[0], v[1]), smaller(v[2], v[3]));
    const Floats bottom = larger(larger(v[0], v[1]), larger(v[2], v[3]));
    const Ints inPicture = (right0 >= -kBorder) & (left0 <= width - 1 + kBorder) & (bottom >= -kBorder) &
                           (top <= height - 1 + kBorder);
    const Ints small = (right0 - left0 <= view.largestPart) & (bottom - top <= view.largestPart);
    const Ints tooLarge = (~good & seen) | (good & inPicture & ~small);
    const Ints drawable = good & inPicture & small;
    ScreenQuads quads;
    // Nothing is converted that does not fit an int.
    const Floats zero = {};
    quads.x0 = -roundedDown(drawable ? kBorder - larger(left0, zero) : zero);
    quads.y0 = -roundedDown(drawable ? kBorder - larger(top, zero) : zero);
    quads.x1 = roundedDown(drawable ? smaller(right0 + kBorder, zero + (width - 1)) : zero);
    quads.y1 = roundedDown(drawable ? smaller(bottom + kBorder, zero + (height - 1)) : zero);
    const Ints covering = drawable & (quads.x0 <= quads.x1) & (quads.y0 <= quads.y1);
    std::int32_t isCovering[kLanes], isTooLarge[kLanes];
    std::memcpy(isCovering, &covering, sizeof covering);
    std::memcpy(isTooLarge, &tooLarge, sizeof tooLarge);
    setUp(u, v, w, quads);
    for (int i = 0; i < kLanes; ++i) {
      if (isCovering[i]) fill(quads, i, target);
      if (isTooLarge[i]) left[leftCount++] = part * kLanes + i;
    }
  }
  return leftCount;
}

std::uint32_t drawQuads(const MeshView& view, const OccluderPack* packs, std::uint32_t count,
                        const MeshTarget& target, std::uint32_t* left) {
  switch (view.lens.kind) {
    case LensKind::None:
      return drawKind<LensKind::None>(view, packs, count, target, left);
    case LensKind::Radial:
      return drawKind<LensKind::Radial>(view, packs, count, target, left);
    case LensKind::Brown:
      return drawKind<LensKind::Brown>(view, packs, count, target, left);
    case LensKind::Full:
      return drawKind<LensKind::Full>(view, packs, count, target, left);
    case LensKind::Fisheye:
      return drawKind<LensKind::Fisheye>(view, packs, count, target, left);
  }
  return 0;
}

}  // namespace
}  // namespace alidade

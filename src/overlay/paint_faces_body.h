// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Colours, elements, depths and keys of the design's faces from the visibility buffer, once a pixel.

#pragma once

#include <cstddef>

#include "overlay/paint_lanes.h"

namespace alidade {
namespace {

/// log2 of v > 0, within 1e-6: exponent, and atanh's series about sqrt(1/2) to sqrt(2).
ALIDADE_LENS_INLINE Floats logarithm(const Floats& v) {
  const Ints bits = asInts(v) - 0x3f3504f3;  // sqrt(1/2)
  const Ints exponent = bits >> 23;
  const Floats m = reinterpret_cast<Floats>((bits & 0x7fffff) + 0x3f3504f3);
  const Floats s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
  const Floats series = s * (2.8853901f + s2 * (0.9617967f + s2 * (0.5770780f + s2 * 0.4121986f)));
  return toFloats(exponent) + series;
}

/// 2^v for v <= 0, within 1e-6; zero below 2^-120.
ALIDADE_LENS_INLINE Floats power2(const Floats& v) {
  const Floats held = larger(v, all(-120.0f));
  const Ints whole = roundedDown(held + 0.5f);
  const Floats f = 0.69314718f * (held - toFloats(whole));
  const Floats e =
      1.0f + f * (1.0f + f * (0.5f + f * (0.16666667f +
                                          f * (0.041666667f + f * (0.0083333333f + f * 0.0013888889f)))));
  const Floats scaled = reinterpret_cast<Floats>(asInts(e) + (whole << 23));
  return v > -119.0f ? scaled : all(0.0f);
}

/// Blinn-Phong's highlight about the half-way vector, 0 to 255, of the lanes in `mask`, all of triangle t.
ALIDADE_LENS_INLINE Floats highlight(const PaintFrame& frame, const ScreenTriangle& t, const Floats& column,
                                     float row, const Ints& mask) {
  const Floats dx = column - static_cast<float>(t.left);
  const float dy = row - static_cast<float>(t.top);
  const Floats nx = (t.nx0 + t.nxy * dy) + t.nxx * dx, ny = (t.ny0 + t.nyy * dy) + t.nyx * dx;
  const Floats towards = 1.0f / lens_detail::squareRoot(Floats(nx * nx + ny * ny + 1.0f));
  const Floats hx = -frame.light[0] - nx * towards, hy = -frame.light[1] - ny * towards,
               hz = -frame.light[2] - towards;
  const Floats along = t.normal[0] * hx + t.normal[1] * hy + t.normal[2] * hz;
  const Floats squared = along * along / larger(Floats(hx * hx + hy * hy + hz * hz), all(1e-12f));
  // Below half a grey level of the brightest highlight nothing is seen.
  const Ints shines = mask & (along > 0.0f) & (squared > 1e-6f);
  if (!any(shines)) return all(0.0f);
  const Floats exponent = 0.5f * frame.shininess * logarithm(smaller(larger(squared, all(1e-6f)), all(1.0f)));
  if (!any(shines & (exponent > -10.0f))) return all(0.0f);
  return shines ? 255.0f * frame.specular * power2(exponent) : all(0.0f);
}

/// Adds the highlights, triangle by triangle: mostly one to three share a run of pixels.
ALIDADE_LENS_INLINE Words litColours(const PaintFrame& frame, const Words& id, const Words& base,
                                     const Ints& shining, const Floats& column, float row) {
  Floats bright{};
  unsigned left = bitsOf(shining);
  if (!left) return base;
  while (left) {
    const int lane = __builtin_ctz(left);
    const std::uint32_t triangle = id[lane];
    const Ints mine = shining & (id == triangle);
    left &= ~bitsOf(mine);
    bright += highlight(frame, frame.triangles[triangle], column, row, mine);
  }
  if (!any(bright > 0.25f)) return base;
  const Colours c = unpacked(base);
  return packed({c.r + bright, c.g + bright, c.b + bright}, asInts(base >> 24));
}

void resolve(const PaintFrame& frame, const VisibilityTile& tile, std::uint32_t* secondOwner,
             float* secondKey) {
  const int right = tile.left + kTileSize < frame.width ? tile.left + kTileSize : frame.width;
  const int bottom = tile.top + kTileSize < frame.height ? tile.top + kTileSize : frame.height;
  const Floats infinite = all(__builtin_inff());
  for (int y = tile.top; y < bottom; ++y)
    for (int x = tile.left; x < right; x += kLanes) {
      const int some = right - x;
      const int place = (y - tile.top) * kTileSize + x - tile.left;
      const std::size_t at = static_cast<std::size_t>(y) * frame.width + x;
      const Floats w = load<Floats>(tile.inverseDepth + place);
      const Words id = load<Words>(tile.triangle + place);
      const Ints covered = w > 0.0f;
      if (!any(covered)) {
        storeSome(frame.faceDepth + at, infinite, some);
        storeSome(frame.element + at, Ints{}, some);
        storeBytes(frame.key + at, Ints{}, some);
        storeBytes(frame.state + at, all(kOutside), some);
        if (secondKey) store(secondKey + place, infinite);
        continue;
      }
      const Ints record = asInts(id) * static_cast<int>(sizeof(ScreenTriangle) / 8);
      const auto* base = reinterpret_cast<const char*>(frame.triangles);
      const Ints element = gathered<8>(base + offsetof(ScreenTriangle, owner), record, covered);
      const Ints mark = gathered<8>(base + offsetof(ScreenTriangle, mark), record, covered);
      const Ints shining = (mark & kShines) != 0;
      const Words lit = asWords(gathered<8>(base + offsetof(ScreenTriangle, colour), record, covered));
      const Floats z = covered ? 1.0f / w : infinite;
      const Floats scan = frame.scanDepth ? loadSome<Floats>(frame.scanDepth + at, some) : infinite;
      const Ints state = stateOf(frame, z, scan);
      const Ints isBarely =
          (state == kHidden) & (stateOf(frame, z - 2.0f * frame.tolerance, scan) == kVisible);
      const Ints key = covered & ((isBarely ? all(kBarelyHidden) : state) | (mark & 63) << 2);
      storeSome(frame.faceDepth + at, z, some);
      storeSome(frame.element + at, element, some);
      storeBytes(frame.key + at, key, some);
      storeBytes(frame.state + at, covered ? state : all(kOutside), some);
      if (frame.drawsFaces) {
        const Floats column = toFloats(kIota + x);
        storeSome(frame.faceColour + at, litColours(frame, id, lit, shining, column, static_cast<float>(y)),
                  some);
      }
      if (secondKey) {
        const Ints isOpen = covered & (state == kVisible) & (kIota < some);
        store(secondKey + place, isOpen ? all(0.0f) : infinite);
        store(secondOwner + place, element);
      }
    }
}

void resolveSecond(const PaintFrame& frame, const SecondLayerTile& tile, std::uint64_t* shown) {
  for (int i = 0; i < HiddenSet::kWords; ++i) shown[i] = 0;
  const int right = tile.left + kTileSize < frame.width ? tile.left + kTileSize : frame.width;
  const int bottom = tile.top + kTileSize < frame.height ? tile.top + kTileSize : frame.height;
  for (int y = tile.top; y < bottom; ++y)
    for (int x = tile.left; x < right; x += kLanes) {
      const int some = right - x;
      const int place = (y - tile.top) * kTileSize + x - tile.left;
      const std::size_t at = static_cast<std::size_t>(y) * frame.width + x;
      const Floats key = load<Floats>(tile.key + place);
      const Ints covered = (key > 0.0f) & (key < __builtin_inff());
      const Ints record = load<Ints>(tile.triangle + place) * static_cast<int>(sizeof(ScreenTriangle) / 8);
      const auto* base = reinterpret_cast<const char*>(frame.triangles);
      const Ints element = gathered<8>(base + offsetof(ScreenTriangle, owner), record, covered);
      storeSome(frame.hiddenElement + at, element, some);
      unsigned left = bitsOf(covered & (kIota < some));
      while (left) {
        const std::int32_t one = element[__builtin_ctz(left)];
        left &= ~bitsOf(element == one);
        const unsigned bit = static_cast<unsigned>(one) % HiddenSet::kBits;
        shown[bit / 64] |= std::uint64_t{1} << bit % 64;
      }
      if (!frame.drawsEdges) continue;
      const Floats w = load<Floats>(tile.inverseDepth + place);
      storeSome(frame.hiddenDepth + at, covered ? 1.0f / w : all(__builtin_inff()), some);
    }
}

}  // namespace
}  // namespace alidade

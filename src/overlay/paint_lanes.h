// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// What the painting kernels share: states and keys as in resources/shaders/overlay_frame.glsl, colours.
// Included by kernels alone, see triangle_lanes.h.

#pragma once

#include "overlay/paint_kernel.h"
#include "raster/triangle_lanes.h"

namespace alidade {
namespace {

constexpr int kVisible = 0, kHidden = 1, kUnknown = 2, kOutside = 3;
constexpr int kBarelyHidden = 3;  // of a key
constexpr int kHide = 0, kGhost = 1, kDash = 2;

/// Colours, 0 to 255.
struct Colours {
  Floats r, g, b;
};

ALIDADE_LENS_INLINE Floats luminance(const Colours& c) {
  return 0.299f * c.r + 0.587f * c.g + 0.114f * c.b;
}
ALIDADE_LENS_INLINE Colours unpacked(const Words& pixel) {
  const Ints p = asInts(pixel);
  return {toFloats(p & 255), toFloats(p >> 8 & 255), toFloats(p >> 16 & 255)};
}
/// Clamped to what a byte holds.
ALIDADE_LENS_INLINE Ints toByte(const Floats& v) {
  return truncated(smaller(larger(v, all(0.0f)), all(255.0f)) + 0.5f);
}
ALIDADE_LENS_INLINE Words packed(const Colours& c, const Ints& alpha) {
  return asWords(toByte(c.r) | toByte(c.g) << 8 | toByte(c.b) << 16 | alpha << 24);
}
ALIDADE_LENS_INLINE Colours mix(const Colours& a, const Colours& b, const Floats& share) {
  return {mix(a.r, b.r, share), mix(a.g, b.g, share), mix(a.b, b.b, share)};
}
ALIDADE_LENS_INLINE Colours chosen(const Ints& mask, const Colours& a, const Colours& b) {
  return {mask ? a.r : b.r, mask ? a.g : b.g, mask ? a.b : b.b};
}
ALIDADE_LENS_INLINE Floats fraction(const Floats& v) {
  return v - toFloats(roundedDown(v));
}

/// What the scan says of depth z: the law of visibilityAt().
ALIDADE_LENS_INLINE Ints stateOf(const PaintFrame& frame, const Floats& z, const Floats& scanDepth) {
  if (!frame.scanDepth) return Ints{};
  const Ints isSeen = z <= scanDepth + frame.tolerance + 0.0005f * z;
  const Ints seen = isSeen ? all(kVisible) : all(kHidden);
  return scanDepth >= 0.0f ? seen : all(kUnknown);
}
ALIDADE_LENS_INLINE Ints stateOfKey(const Ints& key) {
  const Ints state = key & 3;
  return key == 0 ? all(kOutside) : (state == kBarelyHidden ? all(kHidden) : state);
}

ALIDADE_LENS_INLINE int clamped(int value, int end) {
  return value < 0 ? 0 : value >= end ? end - 1 : value;
}
ALIDADE_LENS_INLINE Ints clamped(const Ints& value, int end) {
  return smaller(larger(value, Ints{}), all(end - 1));
}

}  // namespace
}  // namespace alidade

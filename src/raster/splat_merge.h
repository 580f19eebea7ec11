// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "raster/splat_plane.h"

namespace alidade {

/// The picture as one thread left it: all ones where nothing was drawn.
template <class Pixel>
struct SplatPixels {
  const Pixel* pixels = nullptr;
  /// By piece as SplatPlane has them, whether anything was drawn there; null: anywhere.
  const std::uint8_t* touched = nullptr;
};

/// As all threads left it.
template <class Pixel>
struct SplatPlanes {
  std::vector<SplatPixels<Pixel>> planes;
};

/// The lesser of a's and b's pixels into a.
void keepNearest(std::uint64_t* a, const std::uint64_t* b, std::size_t count);
void keepNearest(std::uint32_t* a, const std::uint32_t* b, std::size_t count);

/// Of each of the pixels [first, first + count) the nearest of all planes, stretch by stretch in ascending order: take(at, n, pixels) for
/// those of [first + at, first + at + n), null where nothing was drawn. False if nothing was drawn in any.
template <class Pixel, class Take>
bool takeNearest(const SplatPlanes<Pixel>& all, std::size_t first, std::size_t count, const Take& take) {
  const std::size_t end = first + count;
  const auto endOfPiece = [&](std::size_t at) { return std::min(end, ((at >> SplatPlane::kPieceBits) + 1) << SplatPlane::kPieceBits); };
  /// The only plane, if any, that was drawn into; how many were.
  const auto drawnAt = [&](std::size_t at, const SplatPixels<Pixel>*& only) {
    int drawn = 0;
    only = nullptr;
    for (const SplatPixels<Pixel>& plane : all.planes)
      if (plane.touched == nullptr || plane.touched[at >> SplatPlane::kPieceBits] != 0) ++drawn, only = &plane;
    return drawn;
  };
  bool hasAny = false;
  for (std::size_t from = first; from < end;) {
    const SplatPixels<Pixel>*only = nullptr, *next = nullptr;
    const int drawn = drawnAt(from, only);
    std::size_t to = endOfPiece(from);
    hasAny |= drawn > 0;
    if (drawn > 1) {
      Pixel nearest[SplatPlane::kPiece];
      std::fill_n(nearest, to - from, static_cast<Pixel>(-1));
      for (const SplatPixels<Pixel>& plane : all.planes)
        if (plane.touched == nullptr || plane.touched[from >> SplatPlane::kPieceBits] != 0) keepNearest(nearest, plane.pixels + from, to - from);
      take(from - first, to - from, static_cast<const Pixel*>(nearest));
    } else {
      while (to < end && drawnAt(to, next) == drawn && next == only) to = endOfPiece(to);
      take(from - first, to - from, drawn > 0 ? only->pixels + from : nullptr);
    }
    from = to;
  }
  return hasAny;
}

}  // namespace alidade

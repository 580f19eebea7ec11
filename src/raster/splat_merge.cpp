// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/splat_merge.h"

#include <algorithm>

#include "base/widest.h"
#include "raster/splat_plane.h"

namespace alidade {

namespace {

ALIDADE_WIDEST void nearestOf(const std::uint64_t* a, const std::uint64_t* b, std::size_t count, std::uint64_t* pixels) {
  for (std::size_t i = 0; i < count; ++i) pixels[i] = a[i] < b[i] ? a[i] : b[i];
}
ALIDADE_WIDEST void nearestOf(const std::uint32_t* a, const std::uint32_t* b, std::size_t count, std::uint32_t* pixels) {
  for (std::size_t i = 0; i < count; ++i) pixels[i] = a[i] < b[i] ? a[i] : b[i];
}

}  // namespace

template <class Pixel>
const Pixel* nearestPixels(const SplatPlanes<Pixel>& all, std::size_t first, std::size_t count, std::vector<Pixel>& joined) {
  const std::size_t end = first + count, firstPiece = first >> SplatPlane::kPieceBits, endPiece = (end + SplatPlane::kPiece - 1) >> SplatPlane::kPieceBits;
  const auto isTouched = [](const SplatPixels<Pixel>& plane, std::size_t piece) { return plane.touched == nullptr || plane.touched[piece] != 0; };
  const SplatPixels<Pixel>* only = nullptr;
  int drawn = 0;
  for (const SplatPixels<Pixel>& plane : all.planes) {
    bool hasAny = false;
    for (std::size_t piece = firstPiece; piece < endPiece && !hasAny; ++piece) hasAny = isTouched(plane, piece);
    if (hasAny) only = &plane, ++drawn;
  }
  if (drawn == 0) return nullptr;
  if (drawn == 1) return only->pixels + first;
  joined.resize(count);
  for (std::size_t piece = firstPiece; piece < endPiece; ++piece) {
    const std::size_t from = std::max(first, piece << SplatPlane::kPieceBits), to = std::min(end, (piece + 1) << SplatPlane::kPieceBits);
    Pixel* const pixels = joined.data() + (from - first);
    bool isFirst = true;
    for (const SplatPixels<Pixel>& plane : all.planes) {
      if (!isTouched(plane, piece)) continue;
      if (isFirst) std::copy_n(plane.pixels + from, to - from, pixels);
      else nearestOf(pixels, plane.pixels + from, to - from, pixels);
      isFirst = false;
    }
    if (isFirst) std::fill_n(pixels, to - from, static_cast<Pixel>(-1));
  }
  return joined.data();
}

template const std::uint32_t* nearestPixels(const SplatPlanes<std::uint32_t>&, std::size_t, std::size_t, std::vector<std::uint32_t>&);
template const std::uint64_t* nearestPixels(const SplatPlanes<std::uint64_t>&, std::size_t, std::size_t, std::vector<std::uint64_t>&);

}  // namespace alidade

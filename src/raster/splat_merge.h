// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

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

/// Of each of the pixels [first, first + count) the nearest of all planes; in `joined`, or where a plane alone has them. Null where
/// nothing was drawn.
template <class Pixel>
const Pixel* nearestPixels(const SplatPlanes<Pixel>& planes, std::size_t first, std::size_t count, std::vector<Pixel>& joined);

extern template const std::uint32_t* nearestPixels(const SplatPlanes<std::uint32_t>&, std::size_t, std::size_t, std::vector<std::uint32_t>&);
extern template const std::uint64_t* nearestPixels(const SplatPlanes<std::uint64_t>&, std::size_t, std::size_t, std::vector<std::uint64_t>&);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace alidade {

/// A part of the picture as the threads left it: pixel i of thread k is planes[k][i]. All ones where
/// nothing was drawn.
template <class Pixel>
struct SplatPlanes {
  std::vector<const Pixel*> planes;
};

/// Of each of the pixels [first, first + count) the nearest of all planes; in `joined`, or where a plane alone has them.
template <class Pixel>
const Pixel* nearestPixels(const SplatPlanes<Pixel>& planes, std::size_t first, std::size_t count, std::vector<Pixel>& joined);

extern template const std::uint32_t* nearestPixels(const SplatPlanes<std::uint32_t>&, std::size_t, std::size_t, std::vector<std::uint32_t>&);
extern template const std::uint64_t* nearestPixels(const SplatPlanes<std::uint64_t>&, std::size_t, std::size_t, std::vector<std::uint64_t>&);

}  // namespace alidade

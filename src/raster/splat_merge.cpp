// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/splat_merge.h"

#include <algorithm>

#include "base/widest.h"

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
  const auto& planes = all.planes;
  if (planes.size() == 1) return planes[0] + first;
  joined.resize(count);
  if (planes.empty()) std::ranges::fill(joined, static_cast<Pixel>(-1));
  for (std::size_t k = 1; k < planes.size(); ++k) nearestOf(k == 1 ? planes[0] + first : joined.data(), planes[k] + first, count, joined.data());
  return joined.data();
}

template const std::uint32_t* nearestPixels(const SplatPlanes<std::uint32_t>&, std::size_t, std::size_t, std::vector<std::uint32_t>&);
template const std::uint64_t* nearestPixels(const SplatPlanes<std::uint64_t>&, std::size_t, std::size_t, std::vector<std::uint64_t>&);

}  // namespace alidade

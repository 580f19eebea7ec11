// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/splat_merge.h"

#include "base/widest.h"

namespace alidade {

namespace {

ALIDADE_WIDEST void lesserOf64(std::uint64_t* a, const std::uint64_t* b, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) a[i] = a[i] < b[i] ? a[i] : b[i];
}
ALIDADE_WIDEST void lesserOf32(std::uint32_t* a, const std::uint32_t* b, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) a[i] = a[i] < b[i] ? a[i] : b[i];
}

}  // namespace

void keepNearest(std::uint64_t* a, const std::uint64_t* b, std::size_t count) {
  lesserOf64(a, b, count);
}

void keepNearest(std::uint32_t* a, const std::uint32_t* b, std::size_t count) {
  lesserOf32(a, b, count);
}

}  // namespace alidade

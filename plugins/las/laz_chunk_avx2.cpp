// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/laz_chunk_sets.h"

#if defined(ALIDADE_LAZ_SETS)

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <climits>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include <immintrin.h>

#define ALIDADE_LAZ_SET avx2
#define ALIDADE_LAZ_AVX2  // the compiler's own macros do not follow the pragma
#pragma GCC push_options
#pragma GCC target("avx2,bmi,bmi2,lzcnt,popcnt,movbe")
#include "las/laz_chunk_body.h"
#pragma GCC pop_options

namespace alidade::laz {

std::unique_ptr<ChunkDecoder> makeAvx2Decoder(const std::vector<Item>& items) {
  return makeDecoder(items);
}

}  // namespace alidade::laz

#endif

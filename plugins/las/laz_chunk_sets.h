// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "las/laz_chunk.h"

// Clang has no such pragma; there the baseline serves.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define ALIDADE_LAZ_SETS

namespace alidade::laz {

std::unique_ptr<ChunkDecoder> makeAvx2Decoder(const std::vector<Item>& items);
std::unique_ptr<ChunkDecoder> makeAvx512Decoder(const std::vector<Item>& items);

}  // namespace alidade::laz

#endif

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "las/laz_chunk.h"

namespace alidade::laz {

using MakeDecoder = std::unique_ptr<ChunkDecoder> (*)(const std::vector<Item>& items);

/// The decoders, one for each instruction set, that this processor can run; the fastest is the last. All decode the same.
std::vector<MakeDecoder> usableDecoders();

}  // namespace alidade::laz

// Clang has no such pragma; there the baseline serves.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define ALIDADE_LAZ_SETS

namespace alidade::laz {

std::unique_ptr<ChunkDecoder> makeAvx2Decoder(const std::vector<Item>& items);
std::unique_ptr<ChunkDecoder> makeAvx512Decoder(const std::vector<Item>& items);

}  // namespace alidade::laz

#endif

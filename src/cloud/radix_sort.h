// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include "cloud/raw_bytes.h"

namespace alidade {

/// Sorts keys that are below 2^bits, ascending. A radix sort of the highest bits, as many as tell most of the keys
/// apart; what they leave is a few neighbours out of order, and is put right by insertion. `scratch` is overwritten;
/// it keeps its memory for the next call.
void sortKeys(RawVector<std::uint64_t>& keys, RawVector<std::uint64_t>& scratch, int bits);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include "cloud/raw_bytes.h"

namespace alidade {

/// Sorts keys by their bits [from, from + bits), least significant digit first: stable, so that what stands below
/// and is in order stays so. `scratch` is overwritten; it keeps its memory for the next call.
void radixSort(RawVector<std::uint64_t>& keys, RawVector<std::uint64_t>& scratch, int from, int bits);

}  // namespace alidade

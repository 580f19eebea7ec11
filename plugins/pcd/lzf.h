// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <span>

namespace alidade {

/// Decodes LZF, the byte-oriented LZ77 coding of PCD's "binary_compressed". A control byte below 32
/// is followed by that many + 1 literal bytes; otherwise its upper three bits are a length - 2 (7:
/// the next byte is added) and its lower five, with the next byte, a distance - 1 back.
/// True where exactly `out.size()` bytes came of all of `in`.
bool decodeLzf(std::span<const std::byte> in, std::span<std::byte> out);

/// No LZF input makes more than this many bytes of one: 3 bytes for at most 264.
constexpr std::size_t kLzfLargestRatio = 88;

}  // namespace alidade

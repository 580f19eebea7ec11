// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace alidade {

/// CRC-32C (Castagnoli; iSCSI, RFC 3720 appendix B.4): reflected, initial and final value all ones.
/// The checksum of E57 pages. With the processor's own instruction where it has one.
std::uint32_t crc32c(std::span<const std::byte> bytes);

/// The same by a table, for processors without it, and for a test to hold both together.
std::uint32_t crc32cByTable(std::span<const std::byte> bytes);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>

namespace alidade {

/// Sorts keys, ascending.
void sortKeys(std::span<std::uint64_t> keys);

}  // namespace alidade

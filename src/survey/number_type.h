// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>

namespace alidade {

/// Number types that point files use.
enum class NumberType { I8, U8, I16, U16, I32, U32, I64, U64, F32, F64 };

/// Bytes of one number.
std::size_t numberSize(NumberType type);
/// The number at `bytes` (any alignment); `swapped` where its byte order is not the machine's.
double numberAt(const std::byte* bytes, NumberType type, bool swapped = false);

}  // namespace alidade

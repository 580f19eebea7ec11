// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/number_type.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace alidade {

namespace {

template <class T>
double load(const std::byte* bytes, bool swapped) {
  std::array<std::byte, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (swapped) std::reverse(raw.begin(), raw.end());
  T value;
  std::memcpy(&value, raw.data(), sizeof(T));
  return static_cast<double>(value);
}

}  // namespace

std::size_t numberSize(NumberType type) {
  switch (type) {
    case NumberType::I8:
    case NumberType::U8: return 1;
    case NumberType::I16:
    case NumberType::U16: return 2;
    case NumberType::I32:
    case NumberType::U32:
    case NumberType::F32: return 4;
    default: return 8;
  }
}

double numberAt(const std::byte* bytes, NumberType type, bool swapped) {
  switch (type) {
    case NumberType::I8: return load<std::int8_t>(bytes, swapped);
    case NumberType::U8: return load<std::uint8_t>(bytes, swapped);
    case NumberType::I16: return load<std::int16_t>(bytes, swapped);
    case NumberType::U16: return load<std::uint16_t>(bytes, swapped);
    case NumberType::I32: return load<std::int32_t>(bytes, swapped);
    case NumberType::U32: return load<std::uint32_t>(bytes, swapped);
    case NumberType::I64: return load<std::int64_t>(bytes, swapped);
    case NumberType::U64: return load<std::uint64_t>(bytes, swapped);
    case NumberType::F32: return load<float>(bytes, swapped);
    case NumberType::F64: return load<double>(bytes, swapped);
  }
  return 0;
}

}  // namespace alidade

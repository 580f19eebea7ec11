// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "survey/number_type.h"

namespace alidade {

/// A column as a file's records hold it.
struct RecordField {
  /// Numbers below 256 by another byte of the record: a field that shares its byte with others.
  struct Part {
    std::size_t at = 0;
    std::array<std::uint8_t, 256> values{};
  };

  std::string name;  ///< of a column of PointBatch ("rgb", "return_number", … as stores call them), or an ExtraColumn's own
  NumberType type = NumberType::U8;
  int components = 1;
  bool extra = false;  ///< an ExtraColumn
  std::size_t at = 0;  ///< byte of the record where it stands, as the machine holds it
  std::vector<Part> parts;  ///< where not empty: a U8 that is these or-ed together, and stands nowhere
};

/// Where everything is in a file's records. They begin with x, y and z as whole numbers of 32 bits; the position is
/// scale * number + offset, in double.
struct RecordFormat {
  std::size_t bytes = 0;  ///< a record, at least 16
  glm::dvec3 scale{0}, offset{0};
  std::uint16_t rgbWhite = 65535;
  std::vector<RecordField> fields;
};

/// A run of a file's records.
struct PointRecords {
  const RecordFormat& format;
  const std::byte* data;
  std::size_t count;
  glm::ivec3 low, high;  ///< of the coordinates' numbers
};

/// Takes runs of records on the threads that made them, several at once. Runs ordered by their numbers stand in the
/// file's order. False to stop early.
using RecordSink = std::function<bool(std::uint64_t number, const PointRecords& records)>;

}  // namespace alidade

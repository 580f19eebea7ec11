// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/byte_stream.h"
#include "plugin_api/point_columns.h"

namespace alidade {

enum class PlyCoding { Ascii, LittleEndian, BigEndian };

struct PlyProperty {
  std::string name;
  NumberType type = NumberType::F32;       ///< of the value, or of a list's entries
  std::optional<NumberType> listCountType;  ///< set for a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool hasLists() const;
  /// Bytes of one element without what its lists hold; binary codings.
  std::size_t fixedSize() const;
};

/// The text before the data (Turk, "The PLY Polygon File Format", 1994).
struct PlyHeader {
  PlyCoding coding = PlyCoding::Ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;

  const PlyElement* element(const std::string& name) const;
};

/// Reads up to and with the line "end_header".
Result<PlyHeader> readPlyHeader(ByteStream& stream, const std::string& path);

}  // namespace alidade

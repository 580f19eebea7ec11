// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/byte_stream.h"
#include "plugin_api/point_columns.h"

namespace alidade {

enum class PcdCoding { Ascii, Binary, Compressed };

struct PcdField {
  std::string name;
  NumberType type = NumberType::F32;
  std::uint64_t count = 1;   ///< numbers a point
  std::uint64_t offset = 0;  ///< in a record, bytes

  std::uint64_t size() const { return numberSize(type) * count; }
  /// One float or integer with the bytes of a colour.
  bool isPackedColour() const;
};

/// The text before the data of a PCD file (Point Cloud Library, "The PCD file format", version 0.7).
struct PcdHeader {
  PcdCoding coding = PcdCoding::Ascii;
  std::string version;
  std::vector<PcdField> fields;
  std::uint64_t width = 0, height = 1, points = 0;
  std::array<double, 7> viewpoint{0, 0, 0, 1, 0, 0, 0};  ///< translation, then quaternion w x y z
  std::string slip;  ///< a contradiction that was settled; empty where there is none

  std::uint64_t recordSize() const;
  /// Rows and columns of a range image.
  bool isOrganised() const { return height > 1; }
};

/// Reads up to and with the line DATA.
Result<PcdHeader> readPcdHeader(ByteStream& stream, const std::string& path);

/// The next word of a line; spaces, tabs and commas part words (the comma is a slip some tools make).
std::string_view nextPcdWord(std::string_view& line);

}  // namespace alidade

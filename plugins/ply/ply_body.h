// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>

#include "ply/ply_header.h"

namespace alidade {

/// Reads the elements of a PLY file's body, which follow one another without an index: to come to
/// one, those before it are walked.
class PlyBody {
 public:
  PlyBody(ByteStream& stream, const PlyHeader& header, const std::string& path)
      : m_stream(stream), m_header(header), m_path(path) {}

  /// Error where the rest of the file cannot hold as many elements, naming both numbers.
  Result<void> checkRoom(const PlyElement& element) const;
  Result<void> skip(const PlyElement& element);
  /// Calls `row` with one value a property, 0 for a list; stops early where it returns false.
  Result<void> rows(const PlyElement& element, const std::function<bool(const double*)>& row);

 private:
  Result<void> textRows(const PlyElement& element, const std::function<bool(const double*)>& row);
  Result<void> fixedRows(const PlyElement& element, const std::function<bool(const double*)>& row);
  Result<void> listRows(const PlyElement& element, const std::function<bool(const double*)>& row);
  /// Parses one line into `values`; error names element and line.
  Result<void> parseRow(const PlyElement& element, std::string_view line, std::uint64_t index,
                        std::vector<double>& values) const;
  bool swapped() const { return m_header.coding == PlyCoding::BigEndian; }

  ByteStream& m_stream;
  const PlyHeader& m_header;
  const std::string& m_path;
};

}  // namespace alidade

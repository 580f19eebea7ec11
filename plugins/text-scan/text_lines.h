// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/input_file.h"

namespace alidade {

/// The lines of a text file of any size, front to back, counted from 1, without their endings (LF, CR LF,
/// or CR where the file's start has no LF). The file must outlive it.
class TextLines {
 public:
  static Result<TextLines> open(const InputFile& file);

  /// The next line, valid until the next call; false at the end. Error for a line of more than 64 KiB and
  /// for one that holds a zero byte: no text has one.
  Result<bool> next(std::string_view& line);

  const std::string& path() const { return m_file->path(); }
  std::uint64_t number() const { return m_number; }
  /// Bytes behind the last line returned.
  std::uint64_t position() const { return m_offset + m_begin; }
  std::uint64_t remaining() const { return m_file->size() > position() ? m_file->size() - position() : 0; }
  double fraction() const { return m_file->size() == 0 ? 1.0 : static_cast<double>(position()) / static_cast<double>(m_file->size()); }
  /// "cloud.xyz, line 12"
  std::string place() const;

 private:
  explicit TextLines(const InputFile& file) : m_file(&file) {}
  Result<bool> more();

  const InputFile* m_file;
  std::vector<char> m_buffer;
  std::size_t m_begin = 0, m_end = 0;
  std::uint64_t m_offset = 0;  ///< of m_buffer[0]
  std::uint64_t m_number = 0;
  char m_ending = '\n';
};

}  // namespace alidade

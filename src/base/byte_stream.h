// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/input_file.h"

namespace alidade {

/// A file from front to back through a buffer: lines of text and runs of bytes in any order, as
/// formats with a text header and a binary body need. The file must outlive it.
class ByteStream {
 public:
  explicit ByteStream(const InputFile& file, std::uint64_t offset = 0);

  std::uint64_t position() const { return m_position; }
  std::uint64_t remaining() const { return m_file.size() > m_position ? m_file.size() - m_position : 0; }

  /// The next line without its end (LF, CR LF or CR); nothing at the end of the file. Valid until the
  /// next call. Error for a line of more than 64 KiB: no point file has one.
  Result<std::optional<std::string_view>> line();
  /// Exactly `count` bytes, at most 8 MiB. Valid until the next call. Error at the end of the file.
  Result<std::span<const std::byte>> bytes(std::size_t count);
  /// Error past the end of the file.
  Result<void> skip(std::uint64_t count);

 private:
  /// Makes at least `count` bytes available where the file has them, and returns how many are.
  Result<std::size_t> fill(std::size_t count);

  const InputFile& m_file;
  std::uint64_t m_position = 0;  ///< of m_buffer[m_begin]
  std::vector<std::byte> m_buffer;
  std::size_t m_begin = 0, m_end = 0;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/error.h"

namespace alidade {

/// A regular file opened for reading at any offset. Reads are positioned (no shared cursor), so
/// threads may share one; a file that shrinks meanwhile gives an error, where a memory map would
/// kill the process.
class InputFile {
 public:
  /// Error where the file does not exist, may not be read, or is a folder or a device.
  static Result<InputFile> open(const std::string& path);

  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) noexcept;
  ~InputFile();

  const std::string& path() const { return m_path; }
  std::uint64_t size() const { return m_size; }  ///< bytes, when it was opened

  /// Fills `into` from `offset`. Error, with file and offset, where the file ends before.
  Result<void> readAt(std::uint64_t offset, std::span<std::byte> into) const;
  /// Reads up to into.size() bytes and returns how many there were before the end.
  Result<std::size_t> readSome(std::uint64_t offset, std::span<std::byte> into) const;

 private:
  InputFile() = default;
  std::string m_path;
  std::uint64_t m_size = 0;
  int m_descriptor = -1;
};

}  // namespace alidade

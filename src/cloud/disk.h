// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "base/error.h"

namespace alidade {

/// What went wrong with a file that is written, for the user.
Error diskError(int errnoValue, const std::string& path);

/// All of `bytes` at `offset`, or an Error.
Result<void> writeAt(int file, std::uint64_t offset, std::span<const std::byte> bytes, const std::string& path);
Result<void> readAt(int file, std::uint64_t offset, std::span<std::byte> into, const std::string& path);

/// A file that replaces `path` in one step: written beside it, flushed, renamed, the folder flushed.
Result<void> replaceFile(const std::string& path, std::span<const std::byte> bytes);
Result<void> syncFolder(const std::string& path);

/// A whole file mapped for reading. Pages are read when they are looked at.
class MappedFile {
 public:
  static Result<MappedFile> open(const std::string& path);
  MappedFile() = default;
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  std::span<const std::byte> bytes() const { return {m_data, m_size}; }

 private:
  std::byte* m_data = nullptr;
  std::size_t m_size = 0;
};

}  // namespace alidade

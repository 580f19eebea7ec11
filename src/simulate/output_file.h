// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "base/error.h"

namespace alidade {

/// A file being written. Every write is remembered as good or bad; `finish` flushes, closes and says
/// whether all of it reached the disk. A file that was not finished is removed.
class OutputFile {
 public:
  OutputFile() = default;
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  Result<void> open(const std::string& path);
  Result<void> write(const void* data, std::size_t size);
  Result<void> write(std::string_view text) { return write(text.data(), text.size()); }
  /// Overwrites bytes at an absolute offset and returns to the end.
  Result<void> patch(std::uint64_t offset, const void* data, std::size_t size);
  Result<void> finish();

 private:
  Result<void> failed(const char* doing) const;

  std::FILE* m_file = nullptr;
  std::string m_path;
};

/// One call for a small file.
Result<void> writeWholeFile(const std::string& path, std::string_view content);

/// Makes the folder and those above it.
Result<void> makeFolder(const std::string& path);

}  // namespace alidade

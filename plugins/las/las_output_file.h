// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/error.h"

namespace alidade {

/// A file written from front to back whose header is filled in at the end. It stands under a temporary name beside
/// its own until `commit`; dropped before, it is removed.
class LasOutputFile {
 public:
  static Result<LasOutputFile> create(const std::string& path);
  LasOutputFile(LasOutputFile&& other) noexcept;
  LasOutputFile& operator=(LasOutputFile&&) = delete;
  ~LasOutputFile();

  std::uint64_t position() const { return m_position; }
  Result<void> write(std::span<const std::byte> bytes);
  /// Overwrites bytes that were written before.
  Result<void> patch(std::uint64_t offset, std::span<const std::byte> bytes);
  /// To the disk, and under its name.
  Result<void> commit();

 private:
  LasOutputFile() = default;
  Result<void> put(std::uint64_t offset, std::span<const std::byte> bytes);

  std::string m_path, m_temporary;
  int m_descriptor = -1;
  std::uint64_t m_position = 0;
};

}  // namespace alidade

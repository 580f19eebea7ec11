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

/// Bytes at any offset: of a file, or of a file on an HTTP server that is read by ranges. Thread-safe.
class ByteSource {
 public:
  /// A path, or an address that starts with "http://" or "https://".
  static Result<std::shared_ptr<const ByteSource>> open(const std::string& path);

  virtual ~ByteSource() = default;
  const std::string& path() const { return m_path; }
  std::uint64_t size() const { return m_size; }  ///< bytes, when it was opened

  /// Fills `into` from `offset`. Error, with file and offset, where the file ends before.
  virtual Result<void> readAt(std::uint64_t offset, std::span<std::byte> into) const = 0;
  /// Reads up to into.size() bytes and returns how many there were before the end.
  Result<std::size_t> readSome(std::uint64_t offset, std::span<std::byte> into) const;

 protected:
  ByteSource(std::string path, std::uint64_t size) : m_path(std::move(path)), m_size(size) {}

 private:
  std::string m_path;
  std::uint64_t m_size = 0;
};

/// True for what ByteSource takes for an address.
bool isWebAddress(const std::string& path);

}  // namespace alidade

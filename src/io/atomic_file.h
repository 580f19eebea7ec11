// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "base/error.h"

namespace alidade {

/// A file that appears whole or not at all: it is written under a temporary name beside the target
/// and renamed over it by `commit`. Gone without a trace where commit is not reached.
///
/// A target that exists and is no ordinary file (a pipe, /dev/full) is written directly. A symbolic
/// link is followed, so that the link stays and its file is replaced. Not thread-safe.
class AtomicFile {
 public:
  static Result<AtomicFile> create(const std::string& path);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  /// False after the first failure, which `commit` reports; later writes do nothing.
  bool write(std::span<const std::byte> bytes);

  /// Where to write for a library that opens files itself; it must have closed it before commit.
  /// The target itself where that is no ordinary file.
  const std::string& temporaryPath() const { return m_temporary; }
  bool isDirect() const { return m_direct; }

  /// Flushes to the disk, renames, and flushes the folder. On an Error the target is as it was.
  Result<void> commit();

 private:
  AtomicFile() = default;

  std::string m_asked;      // as the caller wrote it, for messages
  std::string m_target;     // links followed
  std::string m_temporary;
  int m_descriptor = -1;
  int m_error = 0;          // errno of the first failed write
  bool m_direct = false;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/input_file.h"

namespace alidade {

/// An E57 file (ASTM E2807-11, 8) seen as what it holds: pages of 1024 bytes, each of 1020 bytes of
/// content and a big-endian CRC-32C of them. *Physical* offsets count the file's bytes, *logical* ones the
/// content's; sections are contiguous in the latter. The 48 bytes of the header are checked on opening.
class PagedFile {
 public:
  static constexpr std::uint64_t kPage = 1024, kContent = 1020;

  /// Error where it is no E57 file, of an unknown version, cut off, or the header's page is damaged.
  static Result<PagedFile> open(const std::string& path);

  const std::string& path() const { return m_file.path(); }
  std::uint32_t versionMajor() const { return m_major; }
  std::uint32_t versionMinor() const { return m_minor; }
  std::uint64_t logicalSize() const { return m_logicalSize; }
  /// The XML section: logical offset and length, inside the file.
  std::uint64_t xmlOffset() const { return m_xmlOffset; }
  std::uint64_t xmlLength() const { return m_xmlLength; }

  /// Error where the offset is outside the file or points into a checksum; `what` names what begins there.
  Result<std::uint64_t> logicalFromPhysical(std::uint64_t physical, const std::string& what) const;

 private:
  friend class PageReader;
  explicit PagedFile(InputFile file) : m_file(std::move(file)) {}

  InputFile m_file;
  std::uint32_t m_major = 0, m_minor = 0;
  std::uint64_t m_logicalSize = 0, m_xmlOffset = 0, m_xmlLength = 0;
};

/// Reads runs of content and checks each page that it touches. Keeps the last run of pages. One user at
/// a time; the file must outlive it.
class PageReader {
 public:
  /// `runPages`: pages read at once; many for walking, one for looking here and there.
  PageReader(const PagedFile& file, std::size_t runPages) : m_file(file), m_runPages(runPages) {}

  /// `count` bytes at a logical offset, at most 128 KiB; valid until the next call. Error past the end, and
  /// for a page whose checksum is wrong.
  Result<std::span<const std::byte>> view(std::uint64_t logical, std::size_t count);

 private:
  Result<void> load(std::uint64_t firstPage, std::size_t pages);

  const PagedFile& m_file;
  std::size_t m_runPages;
  std::uint64_t m_begin = 0;  ///< logical offset of m_content[0]
  std::vector<std::byte> m_raw, m_content;
};

/// The little-endian number at `bytes`.
template <class T>
T littleEndianAt(const std::byte* bytes) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value = static_cast<T>(value | static_cast<T>(bytes[i]) << (8 * i));
  return value;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/paged_file.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <fmt/format.h>

#include "e57/crc32c.h"

namespace alidade {

namespace {

const std::string kCopyAgain = "Copy or export the file again";

}  // namespace

Result<PagedFile> PagedFile::open(const std::string& path) {
  auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  std::array<std::byte, 48> header{};
  const auto got = file->readSome(0, header);
  if (!got) return fail(got.error());
  if (*got < 8 || std::memcmp(header.data(), "ASTM-E57", 8) != 0)
    return fail("The file is no E57 file: it does not begin with ASTM-E57", path, "Check what it is");
  PagedFile paged(std::move(*file));
  const std::uint64_t size = paged.m_file.size();
  if (size < kPage) return fail(fmt::format("The E57 file is cut off: {} bytes, less than one page", size), path, kCopyAgain);
  paged.m_major = littleEndianAt<std::uint32_t>(&header[8]);
  paged.m_minor = littleEndianAt<std::uint32_t>(&header[12]);
  const auto length = littleEndianAt<std::uint64_t>(&header[16]);
  const auto xmlPhysical = littleEndianAt<std::uint64_t>(&header[24]);
  paged.m_xmlLength = littleEndianAt<std::uint64_t>(&header[32]);
  const auto page = littleEndianAt<std::uint64_t>(&header[40]);
  paged.m_logicalSize = size / kPage * kContent;

  // The header's own page first: a damaged one says nothing reliable of the rest.
  if (auto sound = PageReader(paged, 1).view(0, header.size()); !sound) return fail(sound.error());
  if (paged.m_major != 1)
    return fail(fmt::format("The E57 file is of version {}.{}; only 1 is known", paged.m_major, paged.m_minor), path,
                "Export it as E57 1.0");
  if (page != kPage)
    return fail(fmt::format("The E57 file has pages of {} bytes; the standard has 1024", page), path, kCopyAgain);
  if (length > size)
    return fail(fmt::format("The E57 file is cut off: its header says {} bytes, there are {}", length, size), path, kCopyAgain);
  const auto xml = paged.logicalFromPhysical(xmlPhysical, "the XML section");
  if (!xml) return fail(xml.error());
  paged.m_xmlOffset = *xml;
  if (paged.m_xmlLength > paged.m_logicalSize - *xml)
    return fail(fmt::format("The E57 header promises {} bytes of XML at {}, beyond the end of the file", paged.m_xmlLength, xmlPhysical),
                path, kCopyAgain);
  return paged;
}

Result<std::uint64_t> PagedFile::logicalFromPhysical(std::uint64_t physical, const std::string& what) const {
  const std::uint64_t page = physical / kPage, inside = physical % kPage;
  if (inside >= kContent || page * kContent + inside >= m_logicalSize)
    return fail(fmt::format("The offset {} of {} points {}", physical, what,
                            inside >= kContent ? "into a checksum" : "beyond the end of the file"), path(), kCopyAgain);
  return page * kContent + inside;
}

Result<std::span<const std::byte>> PageReader::view(std::uint64_t logical, std::size_t count) {
  if (logical > m_file.logicalSize() || count > m_file.logicalSize() - logical)
    return fail(fmt::format("The E57 file ends within {} bytes at logical offset {}", count, logical), m_file.path(), kCopyAgain);
  if (logical < m_begin || logical + count > m_begin + m_content.size()) {
    const std::uint64_t first = logical / PagedFile::kContent;
    const std::uint64_t last = count == 0 ? first : (logical + count - 1) / PagedFile::kContent;
    const std::uint64_t most = m_file.logicalSize() / PagedFile::kContent - first;
    const auto pages = std::min<std::uint64_t>(std::max<std::uint64_t>(last - first + 1, m_runPages), most);
    if (auto ok = load(first, pages); !ok) return fail(ok.error());
  }
  return std::span<const std::byte>(m_content).subspan(logical - m_begin, count);
}

Result<void> PageReader::load(std::uint64_t firstPage, std::size_t pages) {
  constexpr std::size_t page = PagedFile::kPage, content = PagedFile::kContent;
  m_raw.resize(pages * page);
  m_content.clear();
  if (auto ok = m_file.m_file.readAt(firstPage * page, m_raw); !ok) return ok;
  m_content.resize(pages * content);
  m_begin = firstPage * content;
  for (std::size_t i = 0; i < pages; ++i) {
    const std::byte* raw = &m_raw[i * page];
    const std::uint32_t stored = static_cast<std::uint32_t>(raw[content]) << 24 | static_cast<std::uint32_t>(raw[content + 1]) << 16 |
                                 static_cast<std::uint32_t>(raw[content + 2]) << 8 | static_cast<std::uint32_t>(raw[content + 3]);
    if (crc32c({raw, content}) != stored) {
      m_content.clear();
      return fail(fmt::format("The E57 file is damaged: the checksum of page {}, bytes {} to {}, is wrong", firstPage + i,
                              (firstPage + i) * page, (firstPage + i + 1) * page - 1), m_file.path(), kCopyAgain);
    }
    std::memcpy(&m_content[i * content], raw, content);
  }
  return {};
}

}  // namespace alidade

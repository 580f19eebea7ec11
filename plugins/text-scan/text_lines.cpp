// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "text-scan/text_lines.h"

#include <cstring>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr std::size_t kBlock = 1 << 20;
constexpr std::size_t kLongestLine = 1 << 16;

}  // namespace

Result<TextLines> TextLines::open(const InputFile& file) {
  TextLines lines(file);
  if (const auto filled = lines.more(); !filled) return fail(filled.error());
  const std::string_view head(lines.m_buffer.data(), lines.m_end);
  if (head.starts_with("\xEF\xBB\xBF")) lines.m_begin = 3;
  if (head.starts_with("\xff\xfe") || head.starts_with("\xfe\xff"))
    return fail("The file is UTF-16 text", file.path(), "Save it as plain text or UTF-8");
  if (head.find('\n') == std::string_view::npos && head.find('\r') != std::string_view::npos) lines.m_ending = '\r';
  return lines;
}

std::string TextLines::place() const { return placeInFile(m_file->path(), m_number); }

Result<bool> TextLines::more() {
  if (m_begin > 0) {
    std::memmove(m_buffer.data(), m_buffer.data() + m_begin, m_end - m_begin);
    m_offset += m_begin;
    m_end -= m_begin;
    m_begin = 0;
  }
  const std::uint64_t at = m_offset + m_end, left = m_file->size() > at ? m_file->size() - at : 0;
  const std::size_t wanted = std::min<std::uint64_t>(kBlock, left);
  if (m_buffer.size() < m_end + wanted) m_buffer.resize(m_end + wanted);
  const auto got = m_file->readSome(at, std::as_writable_bytes(std::span(m_buffer).subspan(m_end, wanted)));
  if (!got) return fail(got.error());
  m_end += *got;
  return *got > 0;
}

Result<bool> TextLines::next(std::string_view& line) {
  std::size_t searched = 0;
  for (;;) {
    const char* from = m_buffer.data() + m_begin;
    const std::size_t size = m_end - m_begin;
    const void* hit = size > searched ? std::memchr(from + searched, m_ending, size - searched) : nullptr;
    if (hit) {
      const auto length = static_cast<std::size_t>(static_cast<const char*>(hit) - from);
      line = std::string_view(from, length);
      m_begin += length + 1;
      break;
    }
    searched = size;
    if (size > kLongestLine) break;
    const auto filled = more();
    if (!filled) return fail(filled.error());
    if (*filled) continue;
    if (m_begin == m_end) return false;
    line = std::string_view(m_buffer.data() + m_begin, m_end - m_begin);
    m_begin = m_end;
    break;
  }
  ++m_number;
  if (searched > kLongestLine || line.size() > kLongestLine)
    return fail("The line is longer than any list of points has", place(), "The file is damaged or of another kind");
  if (std::memchr(line.data(), '\0', line.size()) != nullptr)
    return fail("The line holds a zero byte, so the file is no text", place(), "Check what the file is");
  if (line.ends_with('\r')) line.remove_suffix(1);
  return true;
}

}  // namespace alidade

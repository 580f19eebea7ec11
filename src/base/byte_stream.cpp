// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "base/byte_stream.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace alidade {

namespace {

constexpr std::size_t kLongestLine = 1 << 16;
constexpr std::size_t kMostBytes = 8 << 20;
constexpr std::size_t kReadAhead = 1 << 18;

}  // namespace

ByteStream::ByteStream(const InputFile& file, std::uint64_t offset) : m_file(file), m_position(offset) {}

Result<std::size_t> ByteStream::fill(std::size_t count) {
  if (m_end - m_begin >= count) return m_end - m_begin;
  if (m_begin > 0) std::memmove(m_buffer.data(), m_buffer.data() + m_begin, m_end - m_begin);
  m_end -= m_begin;
  m_begin = 0;
  // Never more than the file has: a short file needs a short buffer.
  const std::uint64_t left = remaining();
  const std::size_t wanted = static_cast<std::size_t>(std::min<std::uint64_t>(std::max(count, kReadAhead), left));
  if (m_buffer.size() < wanted) m_buffer.resize(wanted);
  if (wanted > m_end) {
    const auto got = m_file.readSome(m_position + m_end, std::span(m_buffer).subspan(m_end, wanted - m_end));
    if (!got) return fail(got.error());
    m_end += *got;
  }
  return m_end - m_begin;
}

Result<std::optional<std::string_view>> ByteStream::line() {
  std::size_t searched = 0;
  for (std::size_t wanted = 256; ; wanted = std::min(2 * wanted, kLongestLine + 2)) {
    const auto available = fill(wanted);
    if (!available) return fail(available.error());
    const char* text = reinterpret_cast<const char*>(m_buffer.data() + m_begin);
    const std::string_view seen(text, *available);
    const std::size_t end = seen.find_first_of("\r\n", searched);
    const bool atEnd = *available < wanted;
    // A CR at the very end of what is buffered may be half of a CR LF.
    const bool whole = end != std::string_view::npos && (seen[end] == '\n' || end + 1 < seen.size() || atEnd);
    if (whole) {
      const bool pair = seen[end] == '\r' && end + 1 < seen.size() && seen[end + 1] == '\n';
      m_begin += end + (pair ? 2 : 1);
      m_position += end + (pair ? 2 : 1);
      return std::optional(seen.substr(0, end));
    }
    if (atEnd || seen.size() > kLongestLine) {
      if (seen.size() > kLongestLine)
        return fail(Error{"A line is longer than any point file's", m_file.path() + ", offset " + std::to_string(m_position),
                           "The file is damaged or of another kind"});
      if (seen.empty()) return std::optional<std::string_view>();
      m_begin = m_end;
      m_position += seen.size();
      return std::optional(seen);
    }
    searched = end != std::string_view::npos ? end : seen.size();
  }
}

Result<std::span<const std::byte>> ByteStream::bytes(std::size_t count) {
  const auto available = count <= kMostBytes ? fill(count) : Result<std::size_t>(0);
  if (!available) return fail(available.error());
  if (*available < count)
    return fail(Error{"The file ends in the middle of its data",
                       m_file.path() + ", offset " + std::to_string(m_position + *available),
                       "It may be truncated: copy or export it again"});
  const auto found = std::span<const std::byte>(m_buffer).subspan(m_begin, count);
  m_begin += count;
  m_position += count;
  return found;
}

Result<void> ByteStream::skip(std::uint64_t count) {
  if (count > remaining())
    return fail(Error{"The file ends before its data does",
                       m_file.path() + ", offset " + std::to_string(m_file.size()),
                       "It may be truncated: copy or export it again"});
  const std::size_t buffered = m_end - m_begin;
  m_begin = count < buffered ? m_begin + static_cast<std::size_t>(count) : m_end;
  m_position += count;
  return {};
}

}  // namespace alidade

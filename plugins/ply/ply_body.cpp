// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ply/ply_body.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace alidade {

static_assert(std::endian::native == std::endian::little, "PlyBody::swapped takes the machine for little endian");

namespace {

constexpr const char* kTruncated = "The file is truncated or damaged: copy or export it again";

std::string_view nextWord(std::string_view& line) {
  const std::size_t start = std::min(line.find_first_not_of(" \t"), line.size());
  const std::size_t end = std::min(line.find_first_of(" \t", start), line.size());
  const std::string_view word = line.substr(start, end - start);
  line.remove_prefix(end);
  return word;
}

bool parseNumber(std::string_view word, double& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) value = std::numeric_limits<double>::infinity();
  return (error == std::errc() || error == std::errc::result_out_of_range) && stop == word.data() + word.size() &&
         !word.empty();
}

}  // namespace

Result<void> PlyBody::checkRoom(const PlyElement& element) const {
  if (element.properties.empty()) return {};
  const bool text = m_header.coding == PlyCoding::Ascii;
  // A line holds a character and its separator for each number; the last line may lack its end.
  const std::uint64_t each = text ? 2 * element.properties.size() : element.fixedSize();
  const std::uint64_t room = (m_stream.remaining() + (text ? 1 : 0)) / each;
  if (element.count <= room) return {};
  return fail(fmt::format("The PLY header promises {} of \"{}\", the file has room for {} at most", element.count,
                          element.name, room),
              fmt::format("{}, data from byte {}", m_path, m_stream.position()), kTruncated);
}

Result<void> PlyBody::parseRow(const PlyElement& element, std::string_view line, std::uint64_t index,
                               std::vector<double>& values) const {
  const auto bad = [&](const std::string& why) {
    return fail(fmt::format("\"{}\" {} {}", element.name, index + 1, why), m_path, kTruncated);
  };
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const std::string_view word = nextWord(line);
    if (word.empty())
      return bad(fmt::format("has {} of {} values", i, element.properties.size()));
    if (!parseNumber(word, values[i])) return bad(fmt::format("has \"{}\" for a number", word.substr(0, 40)));
    if (!element.properties[i].listCountType) continue;
    const double count = values[i];
    values[i] = 0;
    if (!(count >= 0) || count > static_cast<double>(line.size())) return bad("has a list that its line cannot hold");
    for (std::uint64_t entry = 0; entry < static_cast<std::uint64_t>(count); ++entry)
      if (nextWord(line).empty()) return bad("has a list that its line cannot hold");
  }
  return {};
}

Result<void> PlyBody::textRows(const PlyElement& element, const std::function<bool(const double*)>& row) {
  std::vector<double> values(element.properties.size() + 1);
  for (std::uint64_t i = 0; i < element.count;) {
    const auto line = m_stream.line();
    if (!line) return fail(line.error());
    if (!*line)
      return fail(fmt::format("The PLY header promises {} of \"{}\", the file ends after {}", element.count,
                              element.name, i),
                  m_path, kTruncated);
    if ((*line)->find_first_not_of(" \t") == std::string_view::npos) continue;
    if (auto ok = parseRow(element, **line, i, values); !ok) return ok;
    if (!row(values.data())) return {};
    ++i;
  }
  return {};
}

Result<void> PlyBody::fixedRows(const PlyElement& element, const std::function<bool(const double*)>& row) {
  const std::size_t stride = element.fixedSize();
  constexpr std::uint64_t kBytes = 1 << 20;
  const std::uint64_t chunk = std::max<std::uint64_t>(1, kBytes / stride);
  std::vector<double> values(element.properties.size());
  for (std::uint64_t first = 0; first < element.count; first += chunk) {
    const std::uint64_t count = std::min(chunk, element.count - first);
    const auto bytes = m_stream.bytes(static_cast<std::size_t>(count * stride));
    if (!bytes) return fail(bytes.error());
    const std::byte* at = bytes->data();
    for (std::uint64_t i = 0; i < count; ++i) {
      for (std::size_t p = 0; p < values.size(); ++p) {
        values[p] = numberAt(at, element.properties[p].type, swapped());
        at += numberSize(element.properties[p].type);
      }
      if (!row(values.data())) return {};
    }
  }
  return {};
}

Result<void> PlyBody::listRows(const PlyElement& element, const std::function<bool(const double*)>& row) {
  std::vector<double> values(element.properties.size());
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (std::size_t p = 0; p < values.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const NumberType type = property.listCountType.value_or(property.type);
      const auto bytes = m_stream.bytes(numberSize(type));
      if (!bytes) return fail(bytes.error());
      values[p] = numberAt(bytes->data(), type, swapped());
      if (!property.listCountType) continue;
      const double count = values[p];
      values[p] = 0;
      const auto size = static_cast<double>(numberSize(property.type));
      if (count < 0 || count * size > static_cast<double>(m_stream.remaining()))
        return fail(fmt::format("\"{}\" {} has a list of {:.0f} entries, more than the file holds", element.name, i + 1,
                                count),
                    fmt::format("{}, offset {}", m_path, m_stream.position()), kTruncated);
      if (auto ok = m_stream.skip(static_cast<std::uint64_t>(count * size)); !ok) return ok;
    }
    if (!row(values.data())) return {};
  }
  return {};
}

Result<void> PlyBody::rows(const PlyElement& element, const std::function<bool(const double*)>& row) {
  if (element.properties.empty()) return {};
  if (auto ok = checkRoom(element); !ok) return ok;
  if (m_header.coding == PlyCoding::Ascii) return textRows(element, row);
  return element.hasLists() ? listRows(element, row) : fixedRows(element, row);
}

Result<void> PlyBody::skip(const PlyElement& element) {
  if (element.properties.empty()) return {};
  if (auto ok = checkRoom(element); !ok) return ok;
  if (m_header.coding != PlyCoding::Ascii && !element.hasLists())
    return m_stream.skip(element.count * element.fixedSize());
  return rows(element, [](const double*) { return true; });
}

}  // namespace alidade

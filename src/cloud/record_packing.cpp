// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/record_packing.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace alidade {

namespace {

constexpr std::size_t kWords = 128;

bool isWidth(std::size_t bytes) {
  return bytes == 1 || bytes == 2 || bytes == 4 || bytes == 6 || bytes == 8;
}

/// Adds a field of each record to words.
void addToWords(const std::byte* from, std::size_t bytes, std::size_t stride, std::size_t count, int shift, std::uint64_t* words) {
  const auto add = [&](auto number) {
    for (std::size_t i = 0; i < count; ++i) {
      std::memcpy(&number, from + i * stride, sizeof number);
      words[i] |= static_cast<std::uint64_t>(number) << shift;
    }
  };
  switch (bytes) {
    case 1: return add(std::uint8_t{0});
    case 2: return add(std::uint16_t{0});
    case 4: return add(std::uint32_t{0});
    case 6: return add(std::uint32_t{0}), addToWords(from + 4, 2, stride, count, shift + 32, words);
    default: return add(std::uint64_t{0});
  }
}

}  // namespace

RecordPacking::RecordPacking(const PointSchema& schema, const RecordFormat& format) : m_recordBytes(format.bytes) {
  const std::vector<ColumnShape> shapes = shapesOf(format);
  std::size_t to = 0;
  for (const ColumnShape& column : schema.columns) {
    const auto found = std::find(shapes.begin(), shapes.end(), column);
    if (found != shapes.end()) {
      const RecordField& field = format.fields[static_cast<std::size_t>(found - shapes.begin())];
      if (field.parts.empty()) addCopied(field.at, column.bytes(), to);
      for (const RecordField::Part& part : field.parts) addSpread(part, to);
      if (!column.extra && column.name == "rgb") m_widensColours = format.rgbWhite < schema.rgbWhite, m_coloursAt = to;
    }
    to += column.bytes();
  }
}

void RecordPacking::addCopied(std::size_t from, std::size_t bytes, std::size_t to) {
  const std::size_t word = to / 8;
  if (!isWidth(bytes) || word != (to + bytes - 1) / 8) {
    m_wide.push_back({from, bytes, to});
    return;
  }
  const int shift = static_cast<int>(to % 8 * 8);
  // Neighbours in both are one number.
  for (Copied& before : m_copied) {
    if (before.word != word || before.at + before.bytes != from || before.shift + static_cast<int>(8 * before.bytes) != shift ||
        !isWidth(before.bytes + bytes))
      continue;
    before.bytes += bytes;
    return;
  }
  m_copied.push_back({from, bytes, word, shift});
}

void RecordPacking::addSpread(const RecordField::Part& part, std::size_t to) {
  const auto same = [&](const Spread& s) { return s.at == part.at && s.word == to / 8; };
  auto spread = std::find_if(m_spread.begin(), m_spread.end(), same);
  if (spread == m_spread.end()) spread = m_spread.insert(spread, Spread{part.at, to / 8, {}});
  for (std::size_t byte = 0; byte < part.values.size(); ++byte)
    spread->values[byte] |= static_cast<std::uint64_t>(part.values[byte]) << to % 8 * 8;
}

void RecordPacking::pack(const std::byte* records, std::size_t count, std::byte* out, std::size_t stride, std::size_t room) const {
  std::array<std::uint64_t, kWords> words;
  for (std::size_t block = 0; block < count; block += kWords) {
    const std::size_t some = std::min(kWords, count - block);
    const std::byte* from = records + block * m_recordBytes;
    for (std::size_t word = 0; word < room; word += 8) {
      words.fill(0);
      for (const Copied& field : m_copied)
        if (field.word == word / 8) addToWords(from + field.at, field.bytes, m_recordBytes, some, field.shift, words.data());
      for (const Spread& field : m_spread)
        for (std::size_t i = 0; field.word == word / 8 && i < some; ++i)
          words[i] |= field.values[std::to_integer<std::uint8_t>(from[i * m_recordBytes + field.at])];
      std::byte* to = out + block * stride + word;
      if (room - word >= 8)
        for (std::size_t i = 0; i < some; ++i) std::memcpy(to + i * stride, &words[i], 8);
      else
        for (std::size_t i = 0; i < some; ++i) std::memcpy(to + i * stride, &words[i], room - word);
    }
  }
  for (const Wide& field : m_wide) {
    const auto copy = [&](auto bytes) {
      for (std::size_t i = 0; i < count; ++i)
        std::memcpy(out + i * stride + field.to, records + i * m_recordBytes + field.at, bytes);
    };
    if (field.bytes == 8) copy(std::integral_constant<std::size_t, 8>{});
    else copy(field.bytes);
  }
  if (m_widensColours) widenColours(out + m_coloursAt, count, stride);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/record_packing.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "base/widest.h"

namespace alidade {

namespace {

using Bytes = RecordPacking::Bytes;
using Words = std::uint64_t __attribute__((vector_size(16)));

constexpr std::size_t kLaneBytes = sizeof(Bytes);

std::uint64_t spreadOf(const std::vector<RecordPacking::Spread>& spreads, const std::byte* record) {
  std::uint64_t word = 0;
  for (const RecordPacking::Spread& spread : spreads) word |= spread.values[std::to_integer<std::uint8_t>(record[spread.at])];
  return word;
}

ALIDADE_WIDEST void packLane(const RecordPacking::Lane& lane, const std::byte* records, std::size_t recordBytes, const std::uint32_t* rows,
                             std::size_t count, std::byte* out, std::size_t stride) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* record = records + rows[i] * recordBytes;
    Bytes bytes{};
    for (const RecordPacking::Shuffle& shuffle : lane.shuffles) {
      Bytes from;
      std::memcpy(&from, record + shuffle.from, sizeof from);
      bytes |= __builtin_shuffle(from, shuffle.take) & shuffle.keep;
    }
    const Words words = reinterpret_cast<const Words&>(bytes) | Words{spreadOf(lane.spreads[0], record), spreadOf(lane.spreads[1], record)};
    if (lane.bytes == kLaneBytes) std::memcpy(out + i * stride, &words, kLaneBytes);
    else std::memcpy(out + i * stride, &words, kLaneBytes / 2);
  }
}

}  // namespace

RecordPacking::RecordPacking(const PointSchema& schema, const RecordFormat& format, std::size_t room)
    : m_recordBytes(format.bytes), m_lanes((room + kLaneBytes - 1) / kLaneBytes) {
  assert(format.bytes >= kLaneBytes && room % 8 == 0);
  if (room % kLaneBytes != 0) m_lanes.back().bytes = room % kLaneBytes;
  const std::vector<ColumnShape> shapes = shapesOf(format);
  std::vector<std::vector<Copied>> copied(m_lanes.size());
  std::size_t to = 0;
  for (const ColumnShape& column : schema.columns) {
    const auto found = std::find(shapes.begin(), shapes.end(), column);
    if (found != shapes.end()) {
      const RecordField& field = format.fields[static_cast<std::size_t>(found - shapes.begin())];
      for (std::size_t i = 0; field.parts.empty() && i < column.bytes(); ++i)
        copied[(to + i) / kLaneBytes].push_back({field.at + i, (to + i) % kLaneBytes});
      for (const RecordField::Part& part : field.parts) addSpread(part, to);
      if (!column.extra && column.name == "rgb") m_widensColours = format.rgbWhite < schema.rgbWhite, m_coloursAt = to;
    }
    to += column.bytes();
  }
  for (std::size_t l = 0; l < m_lanes.size(); ++l) addCopied(std::move(copied[l]), m_lanes[l]);
}

void RecordPacking::addCopied(std::vector<Copied> bytes, Lane& lane) const {
  std::sort(bytes.begin(), bytes.end(), [](const Copied& a, const Copied& b) { return a.from < b.from; });
  for (const Copied& byte : bytes) {
    if (lane.shuffles.empty() || byte.from >= lane.shuffles.back().from + kLaneBytes)
      lane.shuffles.push_back({std::min(byte.from, m_recordBytes - kLaneBytes), Bytes{}, Bytes{}});
    Shuffle& shuffle = lane.shuffles.back();
    shuffle.take[byte.to] = static_cast<std::uint8_t>(byte.from - shuffle.from), shuffle.keep[byte.to] = 0xff;
  }
}

void RecordPacking::addSpread(const RecordField::Part& part, std::size_t to) {
  std::vector<Spread>& spreads = m_lanes[to / kLaneBytes].spreads[to / 8 % 2];
  auto spread = std::find_if(spreads.begin(), spreads.end(), [&](const Spread& s) { return s.at == part.at; });
  if (spread == spreads.end()) spread = spreads.insert(spread, Spread{part.at, {}});
  for (std::size_t byte = 0; byte < part.values.size(); ++byte)
    spread->values[byte] |= static_cast<std::uint64_t>(part.values[byte]) << to % 8 * 8;
}

void RecordPacking::pack(const std::byte* records, const std::uint32_t* rows, std::size_t count, std::byte* out, std::size_t stride) const {
  for (std::size_t l = 0; l < m_lanes.size(); ++l) packLane(m_lanes[l], records, m_recordBytes, rows, count, out + l * kLaneBytes, stride);
  if (m_widensColours) widenColours(out + m_coloursAt, count, stride);
}

}  // namespace alidade

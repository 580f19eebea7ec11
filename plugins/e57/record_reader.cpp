// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/record_reader.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include <fmt/format.h>

namespace alidade {

namespace {

constexpr std::size_t kSectionHeader = 32;
constexpr std::uint8_t kCompressedVector = 1;
constexpr std::uint8_t kIndexPacket = 0, kDataPacket = 1, kEmptyPacket = 2;
// Streams out of step are kept until their records are complete; no writer lets them drift this far.
constexpr std::size_t kMostHeld = std::size_t(512) << 20;
constexpr std::uint64_t kEndless = std::numeric_limits<std::uint64_t>::max();

const std::string kCopyAgain = "Copy or export the file again";

}  // namespace

RecordReader::RecordReader(const PagedFile& file, const E57Scan& scan, std::size_t runPages)
    : m_file(&file), m_scan(&scan), m_pages(file, runPages), m_left(scan.recordCount) {
  for (const E57Field& field : scan.fields) m_bits.push_back(field.bits());
  m_streams.resize(scan.fields.size());
  m_bitsBefore.resize(scan.fields.size());
}

Result<RecordReader> RecordReader::open(const PagedFile& file, const E57Scan& scan, std::size_t runPages) {
  RecordReader reader(file, scan, runPages);
  // Some writers leave out the section of a scan without points.
  if (scan.recordCount == 0 && scan.fileOffset == 0) return reader;
  const std::string what = fmt::format("the points of '{}'", scan.name);
  const auto begin = file.logicalFromPhysical(scan.fileOffset, what);
  if (!begin) return fail(begin.error());
  const auto header = reader.m_pages.view(*begin, kSectionHeader);
  if (!header) return fail(header.error());
  if (static_cast<std::uint8_t>((*header)[0]) != kCompressedVector)
    return fail(fmt::format("There is no point section at offset {}: it begins with {}, not 1", scan.fileOffset,
                            static_cast<int>((*header)[0])), fmt::format("{}, {}", file.path(), what), kCopyAgain);
  const auto length = littleEndianAt<std::uint64_t>(header->data() + 8);
  const auto data = littleEndianAt<std::uint64_t>(header->data() + 16);
  if (length < kSectionHeader || length > file.logicalSize() - *begin)
    return fail(fmt::format("The point section at offset {} says that it has {} bytes, which the file does not", scan.fileOffset, length),
                fmt::format("{}, {}", file.path(), what), kCopyAgain);
  reader.m_begin = *begin;
  reader.m_end = *begin + length;
  reader.m_position = reader.m_end;
  if (scan.recordCount == 0) return reader;

  std::uint64_t bits = 0;
  for (const std::uint64_t each : reader.m_bits) bits += each;
  // Records of no bits at all would be endless; real ones have at least one.
  const std::uint64_t room = length * 8 / std::max<std::uint64_t>(bits, 1);
  if (scan.recordCount > room)
    return fail(fmt::format("The scan promises {} points of {} bits, but its section has room for {}", scan.recordCount, bits, room),
                fmt::format("{}, {}", file.path(), what), kCopyAgain);
  const auto first = file.logicalFromPhysical(data, "the packets of " + what);
  if (!first) return fail(first.error());
  if (*first < reader.m_begin + kSectionHeader || *first > reader.m_end)
    return fail(fmt::format("The packets' offset {} is outside the point section", data), fmt::format("{}, {}", file.path(), what), kCopyAgain);
  reader.m_position = *first;
  return reader;
}

Error RecordReader::damaged(const std::string& what, std::uint64_t logical) const {
  const std::uint64_t physical = logical / PagedFile::kContent * PagedFile::kPage + logical % PagedFile::kContent;
  return {what, fmt::format("{}, scan '{}', offset {}", m_file->path(), m_scan->name, physical), kCopyAgain};
}

Result<bool> RecordReader::nextPacket(Packet& packet) {
  while (m_position < m_end) {
    const std::uint64_t left = m_end - m_position;
    if (left < 4) return fail(damaged("The point section ends within a packet's header", m_position));
    const auto head = m_pages.view(m_position, std::min<std::uint64_t>(left, 6));
    if (!head) return fail(head.error());
    const auto type = static_cast<std::uint8_t>((*head)[0]);
    packet.offset = m_position;
    packet.length = std::uint32_t(littleEndianAt<std::uint16_t>(head->data() + 2)) + 1;
    if (type != kIndexPacket && type != kDataPacket && type != kEmptyPacket)
      return fail(damaged(fmt::format("A packet of the unknown type {} stands among the points", type), m_position));
    if (packet.length < 4 || packet.length > left)
      return fail(damaged(fmt::format("A packet of {} bytes reaches beyond the point section", packet.length), m_position));
    m_position += packet.length;
    if (type != kDataPacket) continue;
    const std::size_t streams = packet.length >= 6 ? littleEndianAt<std::uint16_t>(head->data() + 4) : 0;
    if (streams == 0) continue;
    if (streams != m_streams.size())
      return fail(damaged(fmt::format("A packet has {} streams for {} fields", streams, m_streams.size()), packet.offset));
    packet.dataOffset = static_cast<std::uint32_t>(6 + 2 * streams);
    if (packet.dataOffset > packet.length) return fail(damaged("A packet is too short for its list of streams", packet.offset));
    const auto list = m_pages.view(packet.offset, packet.dataOffset);
    if (!list) return fail(list.error());
    packet.pieces.resize(streams);
    std::uint64_t total = packet.dataOffset;
    for (std::size_t i = 0; i < streams; ++i) {
      packet.pieces[i] = littleEndianAt<std::uint16_t>(list->data() + 6 + 2 * i);
      total += packet.pieces[i];
    }
    if (total > packet.length)
      return fail(damaged(fmt::format("A packet's streams take {} bytes, the packet has {}", total, packet.length), packet.offset));
    return true;
  }
  return false;
}

Result<void> RecordReader::append(const Packet& packet) {
  const auto bytes = m_pages.view(packet.offset, packet.length);
  if (!bytes) return fail(bytes.error());
  std::size_t at = packet.dataOffset;
  for (std::size_t i = 0; i < m_streams.size(); ++i) {
    if (m_scan->fields[i].kind != E57Field::Kind::String) m_streams[i].append(bytes->subspan(at, packet.pieces[i]));
    at += packet.pieces[i];
  }
  return {};
}

std::uint64_t RecordReader::recordsWaiting() const {
  std::uint64_t records = kEndless;
  for (std::size_t i = 0; i < m_streams.size(); ++i)
    if (m_bits[i] > 0 && m_scan->fields[i].kind != E57Field::Kind::String)
      records = std::min(records, m_streams[i].available() / m_bits[i]);
  return records;
}

std::size_t RecordReader::bytesHeld() const {
  std::size_t held = 0;
  for (const BitStream& stream : m_streams) held += stream.bytesHeld();
  return held;
}

void RecordReader::decode(std::size_t count, RecordColumns& columns) {
  columns.resize(m_streams.size());
  for (std::size_t i = 0; i < m_streams.size(); ++i) {
    const E57Field& field = m_scan->fields[i];
    FieldColumn& column = columns[i];
    BitStream& stream = m_streams[i];
    column.real.clear();
    column.whole.clear();
    if (field.kind == E57Field::Kind::String) continue;
    const std::byte* from = stream.data() + stream.position() / 8;  // floats always stand on whole bytes
    if (field.kind == E57Field::Kind::Single) {
      column.real.resize(count);
      for (std::size_t k = 0; k < count; ++k) {
        float value;
        std::memcpy(&value, from + 4 * k, 4);
        column.real[k] = value;
      }
    } else if (field.kind == E57Field::Kind::Double) {
      column.real.resize(count);
      if (count > 0) std::memcpy(column.real.data(), from, 8 * count);
    } else {
      column.whole.resize(count);
      unpackIntegers(stream.data(), stream.position(), static_cast<int>(m_bits[i]), field.minimum, count, column.whole.data());
      if (field.kind == E57Field::Kind::ScaledInteger) {
        column.real.resize(count);
        for (std::size_t k = 0; k < count; ++k)
          column.real[k] = static_cast<double>(column.whole[k]) * field.scale + field.offset;
        column.whole.clear();
      }
    }
    stream.skip(m_bits[i] * count);
  }
}

Result<std::size_t> RecordReader::next(std::size_t most, RecordColumns& columns) {
  const std::uint64_t wanted = std::min<std::uint64_t>(most, m_left);
  if (wanted == 0) return std::size_t(0);
  Packet packet;
  while (recordsWaiting() < wanted) {
    const auto more = nextPacket(packet);
    if (!more) return fail(more.error());
    if (!*more) break;
    if (auto ok = append(packet); !ok) return fail(ok.error());
    if (bytesHeld() > kMostHeld)
      return fail(damaged(fmt::format("The fields' streams drift apart by more than {} MiB", kMostHeld >> 20), packet.offset));
  }
  const std::uint64_t ready = std::min(recordsWaiting(), wanted);
  if (ready == 0)
    return fail(damaged(fmt::format("The point section ends after {} of {} points", m_scan->recordCount - m_left, m_scan->recordCount), m_end));
  decode(ready, columns);
  m_left -= ready;
  return static_cast<std::size_t>(ready);
}

Result<std::size_t> RecordReader::nextFrom(std::uint64_t from, std::size_t most, RecordColumns& columns, std::uint64_t& first,
                                           std::uint64_t& end) {
  Packet packet;
  for (;;) {
    const auto more = nextPacket(packet);
    if (!more) return fail(more.error());
    if (!*more) return std::size_t(0);
    // The records that stand wholly in this packet.
    first = 0;
    end = m_scan->recordCount;
    for (std::size_t i = 0; i < m_streams.size(); ++i) {
      if (m_bits[i] == 0 || m_scan->fields[i].kind == E57Field::Kind::String) continue;
      const std::uint64_t after = m_bitsBefore[i] + packet.pieces[i] * std::uint64_t(8);
      first = std::max(first, (m_bitsBefore[i] + m_bits[i] - 1) / m_bits[i]);
      end = std::min(end, after / m_bits[i]);
    }
    const std::vector<std::uint64_t> before = m_bitsBefore;
    for (std::size_t i = 0; i < m_streams.size(); ++i) m_bitsBefore[i] += packet.pieces[i] * std::uint64_t(8);
    if (first >= end || end <= from) continue;
    for (BitStream& stream : m_streams) stream.clear();
    if (auto ok = append(packet); !ok) return fail(ok.error());
    for (std::size_t i = 0; i < m_streams.size(); ++i)
      if (m_bits[i] > 0 && m_scan->fields[i].kind != E57Field::Kind::String) m_streams[i].skip(first * m_bits[i] - before[i]);
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(end - first, most));
    decode(count, columns);
    return count;
  }
}

}  // namespace alidade

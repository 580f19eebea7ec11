// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_header.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "las/las_vlr.h"

namespace alidade {

namespace {

// Sizes of the public header block: LAS 1.0-1.2 (1.3 adds a waveform offset), 1.4 (64-bit counts, EVLRs).
constexpr std::size_t kHeaderSize12 = 227;
constexpr std::size_t kHeaderSize14 = 375;

// No survey reaches past these; what does is a damaged header.
constexpr double kLargestOffset = 1e12;
constexpr double kLargestScale = 1e3;

std::string fixedText(const std::byte* bytes, std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size && bytes[i] != std::byte{0}; ++i) {
    const char c = static_cast<char>(bytes[i]);
    text += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

void readCounts(const std::byte* block, std::size_t known, LasHeader& header) {
  const std::uint64_t legacy = lasValue<std::uint32_t>(block, 107);
  header.pointCount = legacy;
  if (header.versionMinor < 4) return;
  if (known < kHeaderSize14) {
    header.warnings.push_back({fmt::format("The header is {} bytes long, LAS 1.4 wants {}; its 32-bit count is used",
                                           header.headerSize, kHeaderSize14),
                               "header"});
    return;
  }
  header.evlrOffset = lasValue<std::uint64_t>(block, 235);
  header.evlrCount = lasValue<std::uint32_t>(block, 243);
  const std::uint64_t count = lasValue<std::uint64_t>(block, 247);
  if (count == 0 && legacy != 0) {
    header.warnings.push_back({"The 64-bit point count is 0; the 32-bit one is used", "header"});
    return;
  }
  header.pointCount = count;
  if (legacy != 0 && legacy != count)
    header.warnings.push_back(
        {fmt::format("The 32-bit point count is {}, the 64-bit one {}; the latter is used", legacy, count), "header"});
}

void readBounds(const std::byte* block, LasHeader& header) {
  Bounds bounds;
  bounds.max = {lasValue<double>(block, 179), lasValue<double>(block, 195), lasValue<double>(block, 211)};
  bounds.min = {lasValue<double>(block, 187), lasValue<double>(block, 203), lasValue<double>(block, 219)};
  if (header.pointCount == 0) return;
  bool sane = !bounds.empty();
  for (int axis = 0; axis < 3; ++axis)
    sane = sane && std::abs(bounds.min[axis]) < 1e15 && std::abs(bounds.max[axis]) < 1e15;
  if (sane)
    header.bounds = bounds;
  else
    header.warnings.push_back({"The header's bounds are no bounds; they are ignored", "header"});
}

Result<void> checkLayout(const ByteSource& file, LasHeader& header) {
  const std::string& path = file.path();
  const std::uint16_t least = lasRecordLength(header.pointFormat);
  if (least == 0)
    return fail(fmt::format("Point format {} is not known", header.pointFormat), path + ", header offset 104",
                "Formats 0 to 10 are read: convert the file to one of them");
  if (header.recordLength < least)
    return fail(fmt::format("The header says {} bytes a point, format {} takes at least {}", header.recordLength,
                            header.pointFormat, least),
                path + ", header offset 105", "The header is damaged: export the file again");
  if (header.headerSize < kHeaderSize12)
    return fail(fmt::format("The header says it is {} bytes long, LAS needs at least {}", header.headerSize,
                            kHeaderSize12),
                path + ", header offset 94", "The header is damaged: export the file again");
  if (header.pointsOffset < header.headerSize || header.pointsOffset > file.size())
    return fail(fmt::format("The header says the points start at byte {}, outside the {} bytes of the file",
                            header.pointsOffset, file.size()),
                path + ", header offset 96", "The file is truncated or damaged: copy or export it again");
  if (header.pointFormat >= 6 && header.versionMinor < 4)
    header.warnings.push_back({fmt::format("Point format {} belongs to LAS 1.4, the file says 1.{}",
                                           header.pointFormat, header.versionMinor),
                               "header"});
  if (header.hasWaveforms())
    header.warnings.push_back({"The wave forms themselves are not read, only where they stand", "points"});
  return {};
}

/// Whether the promised points can be there: exactly where each takes its bytes, roughly where they are compressed.
Result<void> checkCount(const ByteSource& file, LasHeader& header) {
  const std::uint64_t bytes = file.size() - header.pointsOffset;
  const auto refuse = [&](std::uint64_t present) {
    return fail(fmt::format("The header promises {} points, the file holds {}", header.pointCount, present),
                fmt::format("{}, points from byte {}", file.path(), header.pointsOffset),
                "The file is truncated: copy or export it again");
  };
  if (header.laz) {
    // Points that are all the same take some 500 to the byte.
    constexpr std::uint64_t kMostPerByte = 2048;
    if (const std::string why = laz::whyNotDecodable(header.laz->items, header.pointFormat, header.recordLength); !why.empty())
      return fail("The compression cannot be read: " + why, file.path() + ", record 22204 of laszip encoded",
                  "Convert the file with any LAZ tool, or export it again");
    if (header.pointCount / kMostPerByte > bytes || (header.pointCount > 0 && bytes < header.recordLength))
      return refuse(bytes < header.recordLength ? 0 : bytes * kMostPerByte);
    return {};
  }
  const std::uint64_t present = bytes / header.recordLength;
  if (header.pointCount > present) return refuse(present);
  if (header.pointCount == 0 && header.evlrCount == 0 && present > 0)
    header.warnings.push_back(
        {fmt::format("The header promises no points, though room for {} follows it", present), "header"});
  return {};
}

Result<void> checkTransform(const ByteSource& file, const LasHeader& header) {
  if (header.pointCount == 0) return {};
  for (int axis = 0; axis < 3; ++axis) {
    const double scale = header.scale[axis], offset = header.offset[axis];
    const bool scaleFits = std::isfinite(scale) && scale > 0 && scale <= kLargestScale;
    if (!scaleFits || !std::isfinite(offset) || std::abs(offset) > kLargestOffset)
      return fail(fmt::format("The header's {} scale is {} and its offset {}: no coordinates come of that",
                              "xyz"[axis], scale, offset),
                  fmt::format("{}, header offset {}", file.path(), 131 + 8 * axis),
                  "The header is damaged: export the file again");
  }
  return {};
}

}  // namespace

std::uint16_t lasRecordLength(int pointFormat) {
  constexpr std::array<std::uint16_t, 11> lengths = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  return pointFormat >= 0 && pointFormat < static_cast<int>(lengths.size()) ? lengths[pointFormat] : 0;
}

bool LasHeader::hasGpsTime() const {
  return pointFormat != 0 && pointFormat != 2;
}

bool LasHeader::hasRgb() const {
  constexpr std::array<bool, 11> coloured = {false, false, true, true, false, true, false, true, true, false, true};
  return coloured[pointFormat];
}

bool LasHeader::hasWaveforms() const {
  return pointFormat == 4 || pointFormat == 5 || pointFormat == 9 || pointFormat == 10;
}

bool LasHeader::hasNir() const {
  return pointFormat == 8 || pointFormat == 10;
}

std::uint32_t LasHeader::wavePacketOffset() const {
  return lasRecordLength(pointFormat) - 29u;
}

std::uint32_t LasHeader::rgbOffset() const {
  return pointFormat == 2 ? 20 : pointFormat <= 5 ? 28 : 30;
}

std::uint32_t LasHeader::gpsTimeOffset() const {
  return pointFormat <= 5 ? 20 : 22;
}

const LasExtraBytes* LasHeader::extra(const std::string& lowerCaseName) const {
  const auto found = std::find_if(extras.begin(), extras.end(), [&](const LasExtraBytes& each) {
    return std::equal(each.name.begin(), each.name.end(), lowerCaseName.begin(), lowerCaseName.end(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
  });
  return found == extras.end() ? nullptr : &*found;
}

std::string LasHeader::details() const {
  std::string text = fmt::format("LAS {}.{}, point format {}", versionMajor, versionMinor, pointFormat);
  if (copc) text += ", COPC";
  if (laz) text += ", " + laz->describe();
  if (!generator.empty()) text += ", generated by " + generator;
  if (!systemId.empty()) text += ", system " + systemId;
  if (creationYear > 1900 && creationYear < 2200 && creationDay >= 1 && creationDay <= 366) {
    using namespace std::chrono;
    const sys_days date = sys_days(year(creationYear) / January / 1) + days(creationDay - 1);
    const year_month_day ymd(date);
    text += fmt::format(", {:04}-{:02}-{:02}", static_cast<int>(ymd.year()), static_cast<unsigned>(ymd.month()),
                        static_cast<unsigned>(ymd.day()));
  }
  if (!crsNote.empty()) text += ", " + crsNote;
  return text;
}

ScanNotes LasHeader::notes() const {
  ScanNotes notes;
  for (const LasExtraBytes& each : extras)
    if (!each.meaning.empty()) {
      notes.columns.push_back(each.meaning);
      notes.columns.back().column = each.name;
    }
  if (hasGpsTime()) notes.gpsTime = (globalEncoding & 1) != 0 ? GpsTimeKind::Standard : GpsTimeKind::OfWeek;
  notes.records = foreignRecords;
  notes.degrees = degrees;
  for (const ImportWarning& warning : warnings) notes.warnings.push_back(fmt::format("{} ({})", warning.what, warning.where));
  return notes;
}

Result<LasHeader> readLasHeader(const ByteSource& file) {
  std::array<std::byte, kHeaderSize14> block{};
  const auto got = file.readSome(0, block);
  if (!got) return fail(got.error());
  if (*got < 4 || std::memcmp(block.data(), "LASF", 4) != 0)
    return fail("This is no LAS file: it does not start with \"LASF\"", file.path(), "Check the file's type");
  if (*got < kHeaderSize12)
    return fail(fmt::format("The LAS header ends after {} bytes, it needs {}", *got, kHeaderSize12), file.path(),
                "The file is truncated: copy or export it again");

  LasHeader header;
  const std::byte* at = block.data();
  header.globalEncoding = lasValue<std::uint16_t>(at, 6);
  header.versionMajor = lasValue<std::uint8_t>(at, 24);
  header.versionMinor = lasValue<std::uint8_t>(at, 25);
  if (header.versionMajor != 1 || header.versionMinor > 4)
    return fail(fmt::format("LAS version {}.{} is not known", header.versionMajor, header.versionMinor),
                file.path() + ", header offset 24", "Versions 1.0 to 1.4 are read: convert the file to one of them");
  header.systemId = fixedText(at + 26, 32);
  header.generator = fixedText(at + 58, 32);
  header.creationDay = lasValue<std::uint16_t>(at, 90);
  header.creationYear = lasValue<std::uint16_t>(at, 92);
  header.headerSize = lasValue<std::uint16_t>(at, 94);
  header.pointsOffset = lasValue<std::uint32_t>(at, 96);
  header.vlrCount = lasValue<std::uint32_t>(at, 100);
  const int format = lasValue<std::uint8_t>(at, 104);
  header.pointFormat = format & 0x3F;  // the upper bits say that the points are compressed
  header.recordLength = lasValue<std::uint16_t>(at, 105);
  header.scale = {lasValue<double>(at, 131), lasValue<double>(at, 139), lasValue<double>(at, 147)};
  header.offset = {lasValue<double>(at, 155), lasValue<double>(at, 163), lasValue<double>(at, 171)};
  readCounts(at, std::min<std::size_t>(*got, header.headerSize), header);
  if (auto ok = checkLayout(file, header); !ok) return fail(ok.error());
  if (auto ok = checkTransform(file, header); !ok) return fail(ok.error());
  readBounds(at, header);
  if (auto ok = readLasVlrs(file, header); !ok) return fail(ok.error());
  if ((format & 0xC0) != 0 && !header.laz)
    return fail("The points are compressed, but the record that describes how is missing", file.path(),
                "The file is damaged: copy or export it again");
  if (auto ok = checkCount(file, header); !ok) return fail(ok.error());
  return header;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pcd/pcd_body.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <new>

#include <fmt/format.h>

#include "pcd/lzf.h"

namespace alidade {

static_assert(std::endian::native == std::endian::little, "PCD's binary codings are the writer's, in practice little");

namespace {

constexpr const char* kTruncated = "The file is truncated or damaged: copy or export it again";

bool parseNumber(std::string_view word, double& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc::result_out_of_range && stop == end) {
    // Too large, or a denormal that rounds to nothing: only the former matters.
    value = word.find("e-") != std::string_view::npos ? 0.0 : std::numeric_limits<double>::infinity();
    return true;
  }
  return error == std::errc() && stop == end && !word.empty();
}

/// A colour written as a float in text is the float with the colour's bits (below 1e-30, as the top
/// byte is 0) or, from other tools, the plain number.
double packedFromText(const PcdField& field, double value) {
  if (field.type != NumberType::F32) return value;
  const auto single = static_cast<float>(value);
  const bool plain = value >= 1.0 && value < 4294967296.0 && value == std::floor(value);
  return plain ? value : static_cast<double>(std::bit_cast<std::uint32_t>(single));
}

double valueOf(const PcdField& field, const std::byte* at) {
  return numberAt(at, field.isPackedColour() ? NumberType::U32 : field.type, false);
}

std::uint64_t numbersAPoint(const PcdHeader& header) {
  std::uint64_t numbers = 0;
  for (const PcdField& field : header.fields) numbers += field.count;
  return numbers;
}

Result<void> textRows(ByteStream& stream, const PcdHeader& header, const std::string& path, const PcdRow& row) {
  std::vector<double> values(header.fields.size());
  for (std::uint64_t i = 0; i < header.points;) {
    const auto line = stream.line();
    if (!line) return fail(line.error());
    if (!*line)
      return fail(fmt::format("The PCD header promises {} points, the file ends after {}", header.points, i), path,
                  kTruncated);
    std::string_view rest = **line;
    if (rest.find_first_not_of(" \t") == std::string_view::npos) continue;
    for (std::size_t f = 0; f < header.fields.size(); ++f) {
      for (std::uint64_t n = 0; n < header.fields[f].count; ++n) {
        const std::string_view word = nextPcdWord(rest);
        if (!parseNumber(word, values[f]))
          return fail(word.empty() ? fmt::format("Point {} has too few numbers", i + 1)
                                   : fmt::format("Point {} has \"{}\" for a number", i + 1, word.substr(0, 40)),
                      path, kTruncated);
      }
      if (header.fields[f].count != 1) values[f] = 0;
      if (header.fields[f].isPackedColour()) values[f] = packedFromText(header.fields[f], values[f]);
    }
    if (!row(values.data())) return {};
    ++i;
  }
  return {};
}

Result<void> binaryRows(ByteStream& stream, const PcdHeader& header, const PcdRow& row) {
  const std::uint64_t stride = header.recordSize();
  const std::uint64_t chunk = std::max<std::uint64_t>(1, (1 << 20) / stride);
  std::vector<double> values(header.fields.size());
  for (std::uint64_t first = 0; first < header.points; first += chunk) {
    const std::uint64_t count = std::min(chunk, header.points - first);
    const auto bytes = stream.bytes(static_cast<std::size_t>(count * stride));
    if (!bytes) return fail(bytes.error());
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::byte* record = bytes->data() + i * stride;
      for (std::size_t f = 0; f < values.size(); ++f)
        values[f] = header.fields[f].count == 1 ? valueOf(header.fields[f], record + header.fields[f].offset) : 0.0;
      if (!row(values.data())) return {};
    }
  }
  return {};
}

Result<std::vector<std::byte>> decompress(ByteStream& stream, const PcdHeader& header, const std::string& path) {
  const auto sizes = stream.bytes(8);
  if (!sizes) return fail(sizes.error());
  const auto packed = static_cast<std::uint64_t>(numberAt(sizes->data(), NumberType::U32, false));
  const auto plain = static_cast<std::uint64_t>(numberAt(sizes->data() + 4, NumberType::U32, false));
  const std::uint64_t wanted = header.points * header.recordSize();
  if (packed > stream.remaining())
    return fail(fmt::format("The compressed block should have {} bytes, the file has {} more", packed, stream.remaining()),
                fmt::format("{}, offset {}", path, stream.position()), kTruncated);
  if (plain != wanted || plain > packed * kLzfLargestRatio)
    return fail(fmt::format("The compressed block says {} bytes of points, the header makes it {}", plain, wanted),
                fmt::format("{}, offset {}", path, stream.position()), kTruncated);
  std::vector<std::byte> in;
  in.reserve(packed);
  while (in.size() < packed) {
    const auto part = stream.bytes(std::min<std::uint64_t>(packed - in.size(), 1 << 20));
    if (!part) return fail(part.error());
    in.insert(in.end(), part->begin(), part->end());
  }
  std::vector<std::byte> out(plain);
  if (!decodeLzf(in, out))
    return fail("The compressed block is damaged", fmt::format("{}, before offset {}", path, stream.position()), kTruncated);
  return out;
}

/// A compressed block holds the fields one after another, each for all points.
Result<void> compressedRows(ByteStream& stream, const PcdHeader& header, const std::string& path, const PcdRow& row) {
  if (header.points == 0) return {};
  const auto block = decompress(stream, header, path);
  if (!block) return fail(block.error());
  std::vector<double> values(header.fields.size());
  for (std::uint64_t i = 0; i < header.points; ++i) {
    for (std::size_t f = 0; f < values.size(); ++f) {
      const PcdField& field = header.fields[f];
      values[f] = field.count == 1
                      ? valueOf(field, block->data() + field.offset * header.points + i * numberSize(field.type))
                      : 0.0;
    }
    if (!row(values.data())) return {};
  }
  return {};
}

}  // namespace

Result<void> checkPcdRoom(const ByteStream& stream, const PcdHeader& header, const std::string& path) {
  const bool text = header.coding == PcdCoding::Ascii;
  std::uint64_t room = (stream.remaining() + (text ? 1 : 0)) / (text ? 2 * numbersAPoint(header) : header.recordSize());
  if (header.coding == PcdCoding::Compressed) room = stream.remaining() * kLzfLargestRatio / header.recordSize();
  if (header.points <= room) return {};
  return fail(fmt::format("The PCD header promises {} points, the file has room for {} at most", header.points, room),
              fmt::format("{}, data from byte {}", path, stream.position()), kTruncated);
}

Result<void> readPcdRows(ByteStream& stream, const PcdHeader& header, const std::string& path, const PcdRow& row) {
  if (auto ok = checkPcdRoom(stream, header, path); !ok) return ok;
  switch (header.coding) {
    case PcdCoding::Ascii: return textRows(stream, header, path, row);
    case PcdCoding::Binary: return binaryRows(stream, header, row);
    case PcdCoding::Compressed: return compressedRows(stream, header, path, row);
  }
  return {};
}

}  // namespace alidade

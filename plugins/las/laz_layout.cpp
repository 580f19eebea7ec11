// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/laz_layout.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "las/las_header.h"
#include "las/laz_coder.h"

namespace alidade {

namespace {

constexpr const char* kExportAgain = "The file is damaged: copy or export it again";

using Sizes = laz::IntegerModel<32, 2>;

}  // namespace

std::string LazLayout::describe() const {
  if (compressor == Pointwise) return "LAZ in one piece";
  const std::string kind = compressor == Layered ? "LAZ in layers" : "LAZ";
  if (chunkSize == kVariable) return kind + ", chunks of different sizes";
  return fmt::format("{}, chunks of {} points", kind, chunkSize);
}

Result<LazLayout> parseLazRecord(std::span<const std::byte> payload, const std::string& path) {
  constexpr std::size_t kHead = 34, kItem = 6;
  const std::string where = path + ", record 22204 of laszip encoded";
  if (payload.size() < kHead)
    return fail(fmt::format("The record that describes the compression has {} bytes, it needs {}", payload.size(), kHead),
                where, kExportAgain);
  LazLayout layout;
  layout.compressor = lasValue<std::uint16_t>(payload.data(), 0);
  const int coder = lasValue<std::uint16_t>(payload.data(), 2);
  layout.chunkSize = lasValue<std::uint32_t>(payload.data(), 12);
  const std::size_t count = lasValue<std::uint16_t>(payload.data(), 32);
  if (layout.compressor < LazLayout::Pointwise || layout.compressor > LazLayout::Layered || coder != 0)
    return fail(fmt::format("The points are compressed in the unknown way {}, coder {}", layout.compressor, coder), where,
                "Ways 1 to 3 with coder 0 are read: convert the file with any LAZ tool");
  if (payload.size() < kHead + count * kItem)
    return fail(fmt::format("The record that describes the compression promises {} parts and ends before", count), where,
                kExportAgain);
  if (layout.compressor != LazLayout::Pointwise && layout.chunkSize == 0)
    return fail("The points are said to stand in chunks of no points", where, kExportAgain);
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* at = payload.data() + kHead + i * kItem;
    layout.items.push_back({lasValue<std::uint16_t>(at, 0), lasValue<std::uint16_t>(at, 2), lasValue<std::uint16_t>(at, 4)});
  }
  return layout;
}

std::vector<std::byte> makeLazRecord(const LazLayout& layout) {
  std::vector<std::byte> bytes(34 + 6 * layout.items.size());
  const auto put = [&](std::size_t at, auto value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
  put(0, static_cast<std::uint16_t>(layout.compressor));
  put(4, std::uint8_t{3});  // version of the specification that the file keeps to: 3.4
  put(5, std::uint8_t{4});
  put(6, std::uint16_t{3});
  put(12, layout.chunkSize);
  put(16, std::int64_t{-1});  // no special extended records
  put(24, std::int64_t{-1});
  put(32, static_cast<std::uint16_t>(layout.items.size()));
  for (std::size_t i = 0; i < layout.items.size(); ++i) {
    put(34 + 6 * i, static_cast<std::uint16_t>(layout.items[i].type));
    put(36 + 6 * i, static_cast<std::uint16_t>(layout.items[i].size));
    put(38 + 6 * i, static_cast<std::uint16_t>(layout.items[i].version));
  }
  return bytes;
}

Result<std::optional<std::vector<LasRun>>> readChunkTable(const ByteSource& file, const LasHeader& header) {
  const LazLayout& layout = *header.laz;
  const std::uint64_t first = header.pointsOffset + 8;
  const auto nothing = std::optional<std::vector<LasRun>>();
  if (layout.compressor == LazLayout::Pointwise || header.pointCount == 0) return nothing;
  std::array<std::byte, 8> head{};
  if (auto ok = file.readAt(header.pointsOffset, head); !ok) return fail(ok.error());
  auto tableAt = lasValue<std::int64_t>(head.data(), 0);
  if (tableAt == -1 && file.size() >= 8) {  // a writer that could not go back put it at the end
    if (auto ok = file.readAt(file.size() - 8, head); !ok) return fail(ok.error());
    tableAt = lasValue<std::int64_t>(head.data(), 0);
  }
  // A writer that was interrupted leaves no table.
  if (tableAt < static_cast<std::int64_t>(first) || static_cast<std::uint64_t>(tableAt) + 8 > file.size()) return nothing;

  const std::string where = fmt::format("{}, chunk table at byte {}", file.path(), tableAt);
  const std::uint64_t room = static_cast<std::uint64_t>(tableAt) - first;
  if (auto ok = file.readAt(static_cast<std::uint64_t>(tableAt), head); !ok) return fail(ok.error());
  const auto version = lasValue<std::uint32_t>(head.data(), 0);
  const auto count = lasValue<std::uint32_t>(head.data(), 4);
  if (version != 0)
    return fail(fmt::format("The chunk table has the unknown version {}", version), where, kExportAgain);
  if (count == 0) return nothing;
  if (count > room / header.recordLength)
    return fail(fmt::format("The chunk table promises {} chunks, the {} bytes of points have room for {}", count, room,
                            room / header.recordLength),
                where, kExportAgain);
  // No entry takes more than twice its eight bytes.
  std::vector<std::byte> bytes(std::min<std::uint64_t>(file.size() - tableAt - 8, 16 * std::uint64_t{count} + 64));
  if (auto ok = file.readAt(static_cast<std::uint64_t>(tableAt) + 8, bytes); !ok) return fail(ok.error());
  const std::size_t size = bytes.size();
  bytes.resize(size + laz::kPadding);

  const bool variable = layout.chunkSize == LazLayout::kVariable;
  auto sizes = std::make_unique<Sizes>();
  laz::Decoder coder(bytes.data());
  const laz::StreamEnd end(std::span<const std::byte>(bytes).first(size));
  std::vector<LasRun> chunks;
  std::uint64_t at = first, points = 0;
  std::int32_t lastCount = 0, lastBytes = 0;
  for (std::uint32_t i = 0; i < count && points < header.pointCount; ++i) {
    if (variable) lastCount = codeInteger(coder, *sizes, lastCount, 0);
    lastBytes = codeInteger(coder, *sizes, lastBytes, 1);
    LasRun chunk{at, static_cast<std::uint32_t>(lastBytes),
                 variable ? static_cast<std::uint32_t>(lastCount) : layout.chunkSize};
    if (end.isBefore(coder) || chunk.bytes > first + room - at)
      return fail(fmt::format("Chunk {} of {} reaches past the end of the points", i + 1, count), where, kExportAgain);
    chunk.count = std::min(chunk.count, header.pointCount - points);
    at += chunk.bytes;
    points += chunk.count;
    if (chunk.count > 0) chunks.push_back(chunk);
  }
  if (points < header.pointCount)
    return fail(fmt::format("The header promises {} points, the {} chunks hold {}", header.pointCount, count, points), where,
                "The file is truncated: copy or export it again");
  return std::optional(std::move(chunks));
}

std::vector<std::byte> makeChunkTable(const std::vector<LasRun>& chunks, bool variable) {
  auto sizes = std::make_unique<Sizes>();
  laz::Encoder coder;
  std::int32_t lastCount = 0, lastBytes = 0;
  for (const LasRun& chunk : chunks) {
    const auto count = static_cast<std::int32_t>(chunk.count), size = static_cast<std::int32_t>(chunk.bytes);
    if (variable) codeInteger(coder, *sizes, lastCount, 0, count);
    codeInteger(coder, *sizes, lastBytes, 1, size);
    lastCount = count;
    lastBytes = size;
  }
  std::vector<std::byte> bytes(8);
  const auto number = static_cast<std::uint32_t>(chunks.size());
  std::memcpy(bytes.data() + 4, &number, 4);
  const auto coded = coder.finish();
  bytes.insert(bytes.end(), coded.begin(), coded.end());
  return bytes;
}

}  // namespace alidade

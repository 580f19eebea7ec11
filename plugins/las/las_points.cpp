// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_points.h"

#include <algorithm>

namespace alidade {

namespace {

/// The largest colour number among the records, and whether it is worth going on.
std::uint16_t largestColour(const LasHeader& header, const std::byte* records, std::size_t count) {
  std::uint16_t largest = 0;
  const std::uint32_t rgb = header.rgbOffset();
  for (std::size_t i = 0; i < count; ++i, records += header.recordLength)
    for (int channel = 0; channel < 3; ++channel)
      largest = std::max(largest, lasValue<std::uint16_t>(records, rgb + 2 * channel));
  return largest;
}

/// An extra-bytes integer column; negative values count as 0.
template <class Out, class In>
void copyInteger(const std::byte* records, std::size_t stride, std::size_t count, std::vector<Out>& out) {
  for (std::size_t i = 0; i < count; ++i, records += stride) {
    const In value = lasValue<In>(records, 0);
    out[i] = value < In(0) ? Out(0) : static_cast<Out>(value);
  }
}

template <class Out>
void decodeExtra(const LasHeader& header, const char* name, const std::byte* records, std::size_t count,
                 std::vector<Out>& out) {
  const LasExtraBytes* extra = header.extra(name);
  if (extra == nullptr || extra->scaled || extra->type < 1 || extra->type > 8) return;
  out.resize(count);
  const std::byte* at = records + extra->offset;
  const std::size_t stride = header.recordLength;
  switch (extra->type) {
    case 1: copyInteger<Out, std::uint8_t>(at, stride, count, out); break;
    case 2: copyInteger<Out, std::int8_t>(at, stride, count, out); break;
    case 3: copyInteger<Out, std::uint16_t>(at, stride, count, out); break;
    case 4: copyInteger<Out, std::int16_t>(at, stride, count, out); break;
    case 5: copyInteger<Out, std::uint32_t>(at, stride, count, out); break;
    case 6: copyInteger<Out, std::int32_t>(at, stride, count, out); break;
    case 7: copyInteger<Out, std::uint64_t>(at, stride, count, out); break;
    case 8: copyInteger<Out, std::int64_t>(at, stride, count, out); break;
    default: break;
  }
}

void decodeColours(const LasHeader& header, const std::byte* records, std::size_t count,
                   std::vector<glm::u16vec3>& out) {
  out.resize(count);
  const std::byte* at = records + header.rgbOffset();
  for (std::size_t i = 0; i < count; ++i, at += header.recordLength)
    out[i] = {lasValue<std::uint16_t>(at, 0), lasValue<std::uint16_t>(at, 2), lasValue<std::uint16_t>(at, 4)};
}

}  // namespace

std::size_t lasBatchSize(const LasHeader& header) {
  // 64 k points of the usual formats; fewer where extra bytes make the records long.
  constexpr std::size_t kPoints = 1 << 16, kBytes = 8 << 20;
  return std::clamp<std::size_t>(kBytes / header.recordLength, 1, kPoints);
}

Result<bool> lasColoursAreUnshifted(const InputFile& file, const LasHeader& header, const Progress& progress) {
  if (!header.hasRgb() || header.pointCount == 0) return false;
  constexpr std::uint64_t kSamples = 64;
  const std::uint64_t batch = lasBatchSize(header);
  std::vector<std::byte> bytes(std::min(batch, header.pointCount) * header.recordLength);
  const auto largestIn = [&](std::uint64_t first, std::uint64_t count) -> Result<std::uint16_t> {
    const auto part = std::span(bytes).first(count * header.recordLength);
    if (auto ok = file.readAt(header.pointsOffset + first * header.recordLength, part); !ok) return fail(ok.error());
    return largestColour(header, part.data(), count);
  };

  for (std::uint64_t i = 0; i < kSamples; ++i) {
    const std::uint64_t first = header.pointCount / kSamples * i;
    const auto largest = largestIn(first, std::min({batch, std::uint64_t{1024}, header.pointCount - first}));
    if (!largest) return fail(largest.error());
    if (*largest > 255) return false;
  }
  std::uint16_t overall = 0;
  for (std::uint64_t first = 0; first < header.pointCount; first += batch) {
    if (progress.cancelled()) return fail(cancelledError());
    progress.report(static_cast<double>(first) / header.pointCount, "Checking colours");
    const auto largest = largestIn(first, std::min(batch, header.pointCount - first));
    if (!largest) return fail(largest.error());
    if (*largest > 255) return false;
    overall = std::max(overall, *largest);
  }
  return overall > 0;
}

void decodeLasPoints(const LasHeader& header, const std::byte* records, std::size_t count, bool unshiftedColours,
                     PointBatch& batch) {
  const std::size_t stride = header.recordLength;
  const bool wide = header.pointFormat >= 6;
  batch.position.resize(count);
  batch.intensity.resize(count);
  batch.classification.resize(count);
  batch.returnNumber.resize(count);
  batch.returnCount.resize(count);
  const std::byte* at = records;
  for (std::size_t i = 0; i < count; ++i, at += stride) {
    const glm::dvec3 steps(lasValue<std::int32_t>(at, 0), lasValue<std::int32_t>(at, 4), lasValue<std::int32_t>(at, 8));
    batch.position[i] = header.scale * steps + header.offset;
    batch.intensity[i] = lasValue<std::uint16_t>(at, 12);
    const auto returns = lasValue<std::uint8_t>(at, 14);
    batch.returnNumber[i] = returns & (wide ? 0x0F : 0x07);
    batch.returnCount[i] = wide ? returns >> 4 : returns >> 3 & 0x07;
    // Formats 0-5 keep three flags in the upper bits of the classification.
    batch.classification[i] = wide ? lasValue<std::uint8_t>(at, 16) : lasValue<std::uint8_t>(at, 15) & 0x1F;
  }
  if (header.hasGpsTime()) {
    batch.gpsTime.resize(count);
    at = records + header.gpsTimeOffset();
    for (std::size_t i = 0; i < count; ++i, at += stride) batch.gpsTime[i] = lasValue<double>(at, 0);
  }
  if (header.hasRgb()) decodeColours(header, records, count, batch.rgb);
  batch.rgbWhite = unshiftedColours ? 255 : 65535;
  decodeExtra(header, "row", records, count, batch.row);
  decodeExtra(header, "column", records, count, batch.column);
  decodeExtra(header, "scanner", records, count, batch.scanner);
  if (batch.row.size() != batch.column.size()) {
    batch.row.clear();
    batch.column.clear();
  }
  batch.pointSource.resize(count);
  copyInteger<std::uint16_t, std::uint16_t>(records + (wide ? 20 : 18), stride, count, batch.pointSource);
}

}  // namespace alidade

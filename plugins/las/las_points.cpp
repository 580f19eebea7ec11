// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_points.h"

#include <algorithm>
#include <array>

namespace alidade {

namespace {

constexpr std::array<NumberType, 11> kTypes = {NumberType::U8,  NumberType::U8,  NumberType::I8,  NumberType::U16,
                                               NumberType::I16, NumberType::U32, NumberType::I32, NumberType::U64,
                                               NumberType::I64, NumberType::F32, NumberType::F64};

/// One column out of the records.
template <class Out, class In>
void copyColumn(const std::byte* at, std::size_t stride, std::size_t count, std::vector<Out>& out) {
  out.resize(count);
  for (std::size_t i = 0; i < count; ++i, at += stride) out[i] = static_cast<Out>(lasValue<In>(at, 0));
}

/// The extra bytes that fill a column of PointBatch's own; null where there are none of a type that fits.
const LasExtraBytes* ownColumn(const LasHeader& header, const char* name, int largestType) {
  const LasExtraBytes* extra = header.extra(name);
  const bool fits = extra && !extra->scaled && extra->components == 1 && extra->type >= 1 && extra->type <= largestType;
  return fits ? extra : nullptr;
}

constexpr int kUpTo32Bits = 6, kUpTo16Bits = 4;

struct OwnColumns {
  explicit OwnColumns(const LasHeader& header)
      : row(ownColumn(header, "row", kUpTo32Bits)),
        column(ownColumn(header, "column", kUpTo32Bits)),
        scanner(ownColumn(header, "scanner", kUpTo16Bits)) {
    // A row means nothing without its column.
    if (!row || !column) row = column = nullptr;
  }
  bool takes(const LasExtraBytes& extra) const { return &extra == row || &extra == column || &extra == scanner; }
  const LasExtraBytes *row, *column, *scanner;
};

template <class Out>
void decodeOwn(const LasHeader& header, const LasExtraBytes* extra, const std::byte* records, std::size_t count,
               std::vector<Out>& out) {
  if (!extra) return;
  const std::byte* at = records + extra->offset;
  const std::size_t stride = header.recordLength;
  switch (extra->type) {
    case 1: copyColumn<Out, std::uint8_t>(at, stride, count, out); break;
    case 2: copyColumn<Out, std::int8_t>(at, stride, count, out); break;
    case 3: copyColumn<Out, std::uint16_t>(at, stride, count, out); break;
    case 4: copyColumn<Out, std::int16_t>(at, stride, count, out); break;
    case 5: copyColumn<Out, std::uint32_t>(at, stride, count, out); break;
    case 6: copyColumn<Out, std::int32_t>(at, stride, count, out); break;
    default: break;
  }
}

void addExtra(PointBatch& batch, std::string name, NumberType type, int components, const std::byte* at,
              std::size_t stride, std::size_t count) {
  ExtraColumn& column = batch.extra.emplace_back(ExtraColumn{std::move(name), type, components, {}});
  const std::size_t size = column.bytesPerPoint();
  column.data.resize(count * size);
  std::byte* out = column.data.data();
  const auto copy = [&]<std::size_t Size>() {
    for (std::size_t i = 0; i < count; ++i) std::memcpy(out + i * Size, at + i * stride, Size);
  };
  switch (size) {
    case 1: return copy.template operator()<1>();
    case 2: return copy.template operator()<2>();
    case 4: return copy.template operator()<4>();
    case 8: return copy.template operator()<8>();
    default:
      for (std::size_t i = 0; i < count; ++i) std::memcpy(out + i * size, at + i * stride, size);
  }
}

/// The flags of a record of the formats 0-5 where the formats 6-10 have them.
std::byte flagsOfOldRecord(const std::byte* at) {
  const auto returns = lasValue<std::uint8_t>(at, 14), classification = lasValue<std::uint8_t>(at, 15);
  return static_cast<std::byte>(classification >> 5 | (returns & 0xC0));
}

void decodeCore(const LasHeader& header, const std::byte* at, std::size_t count, PointBatch& batch) {
  const std::size_t stride = header.recordLength;
  const bool wide = header.pointFormat >= 6;
  batch.position.resize(count);
  batch.intensity.resize(count);
  batch.classification.resize(count);
  batch.returnNumber.resize(count);
  batch.returnCount.resize(count);
  const glm::dvec3 scale = header.scale, offset = header.offset;
  for (std::size_t i = 0; i < count; ++i, at += stride) {
    const glm::dvec3 steps(lasValue<std::int32_t>(at, 0), lasValue<std::int32_t>(at, 4), lasValue<std::int32_t>(at, 8));
    batch.position[i] = scale * steps + offset;
    batch.intensity[i] = lasValue<std::uint16_t>(at, 12);
    const auto returns = lasValue<std::uint8_t>(at, 14);
    batch.returnNumber[i] = returns & (wide ? 0x0F : 0x07);
    batch.returnCount[i] = wide ? returns >> 4 : returns >> 3 & 0x07;
    // Formats 0-5 keep three flags in the upper bits of the classification.
    batch.classification[i] = wide ? lasValue<std::uint8_t>(at, 16) : lasValue<std::uint8_t>(at, 15) & 0x1F;
  }
}

void decodeFieldsWithoutColumn(const LasHeader& header, const std::byte* at, std::size_t count, PointBatch& batch) {
  const std::size_t stride = header.recordLength;
  if (header.pointFormat >= 6) {
    addExtra(batch, "scan_flags", NumberType::U8, 1, at + 15, stride, count);
    addExtra(batch, "scan_angle", NumberType::I16, 1, at + 18, stride, count);
  } else {
    ExtraColumn& flags = batch.extra.emplace_back(ExtraColumn{"scan_flags", NumberType::U8, 1, {}});
    flags.data.resize(count);
    for (std::size_t i = 0; i < count; ++i) flags.data[i] = flagsOfOldRecord(at + i * stride);
    addExtra(batch, "scan_angle_rank", NumberType::I8, 1, at + 16, stride, count);
  }
  addExtra(batch, "user_data", NumberType::U8, 1, at + 17, stride, count);
  if (header.hasNir()) addExtra(batch, "nir", NumberType::U16, 1, at + 36, stride, count);
  if (header.hasWaveforms()) addExtra(batch, "wave_packet", NumberType::U8, 29, at + header.wavePacketOffset(), stride, count);
}

/// How many bytes stand behind the last described one.
std::uint32_t undescribedBytes(const LasHeader& header) {
  const std::uint32_t described =
      header.extras.empty() ? lasRecordLength(header.pointFormat) : header.extras.back().offset + header.extras.back().size;
  return header.recordLength - described;
}

std::string nameOf(const LasExtraBytes& extra) {
  return extra.name.empty() ? "extra_bytes" : extra.name;
}

void decodeExtras(const LasHeader& header, const OwnColumns& own, const std::byte* at, std::size_t count,
                  PointBatch& batch) {
  const std::size_t stride = header.recordLength;
  for (const LasExtraBytes& extra : header.extras) {
    if (own.takes(extra) || extra.size == 0) continue;
    const int components = extra.type == 0 ? static_cast<int>(extra.size) : extra.components;
    addExtra(batch, nameOf(extra), kTypes[extra.type], components, at + extra.offset, stride, count);
  }
  if (const std::uint32_t rest = undescribedBytes(header); rest > 0)
    addExtra(batch, "extra_bytes", NumberType::U8, static_cast<int>(rest), at + stride - rest, stride, count);
}

/// The station of each point by the point source ID that the station's record names; none for the
/// batch where a point belongs to no station.
void decodeScanner(const LasHeader& header, PointBatch& batch) {
  if (header.stations.empty()) return;
  batch.scanner.resize(batch.size());
  std::uint16_t lastId = 0, lastStation = 0;
  bool known = false;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const std::uint16_t id = batch.pointSource[i];
    if (!known || id != lastId) {
      const auto found = std::find_if(header.stations.begin(), header.stations.end(),
                                      [&](const LasStation& each) { return each.pointSource == id; });
      if (found == header.stations.end()) return batch.scanner.clear();
      lastId = id;
      lastStation = static_cast<std::uint16_t>(found - header.stations.begin());
      known = true;
    }
    batch.scanner[i] = lastStation;
  }
}

}  // namespace

std::uint16_t largestLasColour(const LasHeader& header, const std::byte* records, std::size_t count) {
  std::uint16_t largest = 0;
  if (!header.hasRgb()) return 0;
  records += header.rgbOffset();
  for (std::size_t i = 0; i < count; ++i, records += header.recordLength)
    for (int channel = 0; channel < 3; ++channel)
      largest = std::max(largest, lasValue<std::uint16_t>(records, 2 * channel));
  return largest;
}

void decodeLasPoints(const LasHeader& header, const std::byte* records, std::size_t count, bool unshiftedColours,
                     PointBatch& batch) {
  const std::size_t stride = header.recordLength;
  decodeCore(header, records, count, batch);
  if (header.hasGpsTime()) copyColumn<double, double>(records + header.gpsTimeOffset(), stride, count, batch.gpsTime);
  if (header.hasRgb()) {
    batch.rgb.resize(count);
    const std::byte* at = records + header.rgbOffset();
    for (std::size_t i = 0; i < count; ++i, at += stride)
      batch.rgb[i] = {lasValue<std::uint16_t>(at, 0), lasValue<std::uint16_t>(at, 2), lasValue<std::uint16_t>(at, 4)};
  }
  batch.rgbWhite = unshiftedColours ? 255 : 65535;
  copyColumn<std::uint16_t, std::uint16_t>(records + (header.pointFormat >= 6 ? 20 : 18), stride, count, batch.pointSource);
  const OwnColumns own(header);
  decodeOwn(header, own.row, records, count, batch.row);
  decodeOwn(header, own.column, records, count, batch.column);
  if (own.scanner)
    decodeOwn(header, own.scanner, records, count, batch.scanner);
  else
    decodeScanner(header, batch);
  decodeFieldsWithoutColumn(header, records, count, batch);
  decodeExtras(header, own, records, count, batch);
}

std::vector<std::string> lasAttributes(const LasHeader& header) {
  std::vector<std::string> names;
  if (header.hasRgb()) names.push_back("rgb");
  names.insert(names.end(), {"intensity", "classification", "return_number", "number_of_returns"});
  if (header.hasGpsTime()) names.push_back("gps_time");
  names.push_back("point_source_id");
  names.insert(names.end(), {"scan_flags", header.pointFormat >= 6 ? "scan_angle" : "scan_angle_rank", "user_data"});
  if (header.hasNir()) names.push_back("nir");
  if (header.hasWaveforms()) names.push_back("wave_packet");
  for (const auto& extra : header.extras)
    if (extra.size > 0) names.push_back(nameOf(extra));
  if (undescribedBytes(header) > 0) names.push_back("extra_bytes");
  return names;
}

}  // namespace alidade

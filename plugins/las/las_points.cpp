// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_points.h"

#include <algorithm>
#include <array>
#include <type_traits>

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

/// A field of the records on its way to its column.
struct Filling {
  const RecordField* field;
  std::size_t bytes;  ///< of a point
  std::byte* to;

  void run(const std::byte* records, std::size_t stride, std::size_t first, std::size_t count) const {
    const std::byte* from = records + first * stride;
    if (!field->parts.empty()) return put(from, stride, to + first, count);
    from += field->at;
    const auto copy = [&](auto size) {
      std::byte* out = to + first * std::size_t{size};
      for (std::size_t i = 0; i < count; ++i) std::memcpy(out + i * std::size_t{size}, from + i * stride, size);
    };
    switch (bytes) {
      case 1: return copy(std::integral_constant<std::size_t, 1>{});
      case 2: return copy(std::integral_constant<std::size_t, 2>{});
      case 4: return copy(std::integral_constant<std::size_t, 4>{});
      case 6: return copy(std::integral_constant<std::size_t, 6>{});
      case 8: return copy(std::integral_constant<std::size_t, 8>{});
      default: return copy(bytes);
    }
  }

 private:
  void put(const std::byte* from, std::size_t stride, std::byte* out, std::size_t count) const {
    std::fill_n(out, count, std::byte{0});
    for (const RecordField::Part& part : field->parts) {
      const std::uint8_t* values = part.values.data();
      for (std::size_t i = 0; i < count; ++i) out[i] |= static_cast<std::byte>(values[lasValue<std::uint8_t>(from + i * stride, part.at)]);
    }
  }
};

/// The batch's own column for a field, with room for so many points.
std::byte* columnFor(const RecordField& field, std::size_t count, PointBatch& batch) {
  const auto sized = [&](auto& column) {
    column.resize(count);
    return reinterpret_cast<std::byte*>(column.data());
  };
  if (field.name == "rgb") return sized(batch.rgb);
  if (field.name == "intensity") return sized(batch.intensity);
  if (field.name == "classification") return sized(batch.classification);
  if (field.name == "return_number") return sized(batch.returnNumber);
  if (field.name == "return_count") return sized(batch.returnCount);
  if (field.name == "gps_time") return sized(batch.gpsTime);
  return sized(batch.pointSource);
}

/// Fills the batch's columns, in the memory that they have, a stretch after the other: its records are looked at once a
/// column, and stay at hand.
void fillBatch(const RecordFormat& format, const std::byte* records, std::size_t count, PointBatch& batch) {
  batch.gpsTime.clear(), batch.rgb.clear(), batch.normal.clear(), batch.scanner.clear(), batch.row.clear(), batch.column.clear();
  batch.position.resize(count);
  batch.rgbWhite = format.rgbWhite;
  std::vector<Filling> fillings;
  std::size_t extras = 0;
  for (const RecordField& field : format.fields) {
    const std::size_t bytes = numberSize(field.type) * static_cast<std::size_t>(field.components);
    if (!field.extra) {
      fillings.push_back({&field, bytes, columnFor(field, count, batch)});
      continue;
    }
    if (extras == batch.extra.size()) batch.extra.emplace_back();
    ExtraColumn& column = batch.extra[extras++];
    column.name = field.name, column.type = field.type, column.components = field.components;
    column.data.resize(count * bytes);
    fillings.push_back({&field, bytes, column.data.data()});
  }
  batch.extra.resize(extras);
  const glm::dvec3 scale = format.scale, offset = format.offset;
  glm::dvec3* position = batch.position.data();
  constexpr std::size_t kStretch = 512;
  for (std::size_t first = 0; first < count; first += kStretch) {
    const std::size_t some = std::min(kStretch, count - first);
    for (std::size_t i = first; i < first + some; ++i) {
      const std::byte* at = records + i * format.bytes;
      position[i] = scale * glm::dvec3(lasValue<std::int32_t>(at, 0), lasValue<std::int32_t>(at, 4), lasValue<std::int32_t>(at, 8)) + offset;
    }
    for (const Filling& filling : fillings) filling.run(records, format.bytes, first, some);
  }
}

/// What a byte says of a field.
template <class Value>
RecordField::Part partOf(std::size_t at, const Value& value) {
  RecordField::Part part{at, {}};
  for (unsigned byte = 0; byte < part.values.size(); ++byte) part.values[byte] = static_cast<std::uint8_t>(value(byte));
  return part;
}

/// How many bytes stand behind the last described one.
std::uint32_t undescribedBytes(const LasHeader& header) {
  const std::uint32_t described =
      header.extras.empty() ? lasRecordLength(header.pointFormat) : header.extras.back().offset + header.extras.back().size;
  return header.recordLength - described;
}

/// Of the bytes behind the described ones: a name that these have not.
std::string undescribedName(const LasHeader& header) {
  std::string name = "extra_bytes";
  for (int i = 2; header.extra(name) != nullptr; ++i) name = "extra_bytes_" + std::to_string(i);
  return name;
}

void addExtras(const LasHeader& header, const OwnColumns& own, std::vector<RecordField>& fields) {
  for (const LasExtraBytes& extra : header.extras) {
    if (own.takes(extra) || extra.size == 0) continue;
    const int components = extra.type == 0 ? static_cast<int>(extra.size) : extra.components;
    fields.push_back({extra.name, kTypes[extra.type], components, true, extra.offset, {}});
  }
  if (const std::uint32_t rest = undescribedBytes(header); rest > 0)
    fields.push_back({undescribedName(header), NumberType::U8, static_cast<int>(rest), true, header.recordLength - rest, {}});
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

RecordFormat lasRecordFormat(const LasHeader& header, bool unshiftedColours) {
  const bool wide = header.pointFormat >= 6;
  RecordFormat format;
  format.bytes = header.recordLength;
  format.scale = header.scale, format.offset = header.offset;
  format.rgbWhite = unshiftedColours ? 255 : 65535;
  auto& fields = format.fields;
  const auto add = [&](const char* name, NumberType type, int components, std::size_t at, bool extra = false) {
    fields.push_back({name, type, components, extra, at, {}});
  };
  const auto addParts = [&](const char* name, std::vector<RecordField::Part> parts, bool extra = false) {
    fields.push_back({name, NumberType::U8, 1, extra, 0, std::move(parts)});
  };
  if (header.hasRgb()) add("rgb", NumberType::U16, 3, header.rgbOffset());
  add("intensity", NumberType::U16, 1, 12);
  if (wide) add("classification", NumberType::U8, 1, 16);
  else addParts("classification", {partOf(15, [](unsigned v) { return v & 0x1F; })});
  addParts("return_number", {partOf(14, [wide](unsigned v) { return v & (wide ? 0x0F : 0x07); })});
  addParts("return_count", {partOf(14, [wide](unsigned v) { return wide ? v >> 4 : v >> 3 & 0x07; })});
  if (header.hasGpsTime()) add("gps_time", NumberType::F64, 1, header.gpsTimeOffset());
  add("point_source", NumberType::U16, 1, wide ? 20 : 18);
  if (wide) {
    add("scan_flags", NumberType::U8, 1, 15, true);
    add("scan_angle", NumberType::I16, 1, 18, true);
  } else {
    // Three flags stand in the upper bits of the classification: they come where the formats 6-10 have them.
    addParts("scan_flags", {partOf(15, [](unsigned v) { return v >> 5; }), partOf(14, [](unsigned v) { return v & 0xC0; })}, true);
    add("scan_angle_rank", NumberType::I8, 1, 16, true);
  }
  add("user_data", NumberType::U8, 1, 17, true);
  if (header.hasNir()) add("nir", NumberType::U16, 1, 36, true);
  if (header.hasWaveforms()) add("wave_packet", NumberType::U8, 29, header.wavePacketOffset(), true);
  addExtras(header, OwnColumns(header), fields);
  return format;
}

bool lasRecordsTellAll(const LasHeader& header) {
  const OwnColumns own(header);
  return header.stations.empty() && !own.row && !own.scanner;
}

void decodeLasPoints(const LasHeader& header, const RecordFormat& format, const std::byte* records, std::size_t count, PointBatch& batch) {
  const OwnColumns own(header);
  fillBatch(format, records, count, batch);
  decodeOwn(header, own.row, records, count, batch.row);
  decodeOwn(header, own.column, records, count, batch.column);
  if (own.scanner)
    decodeOwn(header, own.scanner, records, count, batch.scanner);
  else
    decodeScanner(header, batch);
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
    if (extra.size > 0) names.push_back(extra.name);
  if (undescribedBytes(header) > 0) names.push_back(undescribedName(header));
  return names;
}

}  // namespace alidade

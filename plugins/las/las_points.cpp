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

/// A column of bytes that stand so in the record.
struct CopiedField {
  std::size_t at, bytes;
  std::byte* to;

  void copy(const std::byte* records, std::size_t stride, std::size_t first, std::size_t count) const {
    const std::byte* from = records + first * stride + at;
    const auto run = [&](auto size) {
      std::byte* out = to + first * std::size_t{size};
      for (std::size_t i = 0; i < count; ++i) std::memcpy(out + i * std::size_t{size}, from + i * stride, size);
    };
    switch (bytes) {
      case 1: return run(std::integral_constant<std::size_t, 1>{});
      case 2: return run(std::integral_constant<std::size_t, 2>{});
      case 4: return run(std::integral_constant<std::size_t, 4>{});
      case 6: return run(std::integral_constant<std::size_t, 6>{});
      case 8: return run(std::integral_constant<std::size_t, 8>{});
      default: return run(bytes);
    }
  }
};

/// What becomes of a file's records: columns, in the memory that the batch has.
class BatchFilling {
 public:
  BatchFilling(const LasHeader& header, std::size_t count, PointBatch& batch) : m_header(header), m_count(count), m_batch(batch) {
    for (auto* column : {&batch.classification, &batch.returnNumber, &batch.returnCount}) column->resize(count);
    batch.position.resize(count);
    batch.intensity.resize(count);
    batch.gpsTime.clear(), batch.rgb.clear(), batch.normal.clear(), batch.scanner.clear(), batch.row.clear(), batch.column.clear();
    copyColumn(12, batch.intensity);
    if (header.hasGpsTime()) copyColumn(header.gpsTimeOffset(), batch.gpsTime);
    if (header.hasRgb()) copyColumn(header.rgbOffset(), batch.rgb);
    copyColumn(header.pointFormat >= 6 ? 20 : 18, batch.pointSource);
    addFieldsWithoutColumn();
  }

  /// Bytes of the record as a column of its own.
  void copyExtra(const std::string& name, NumberType type, int components, std::size_t at) {
    ExtraColumn& column = addExtra(name, type, components);
    m_copied.push_back({at, column.bytesPerPoint(), column.data.data()});
  }

  /// Fills the columns, a stretch after the other: its records are looked at once a column, and stay at hand.
  void run(const std::byte* records) {
    m_batch.extra.resize(m_extras);
    const std::size_t stride = m_header.recordLength;
    constexpr std::size_t kStretch = 512;
    for (std::size_t first = 0; first < m_count; first += kStretch) {
      const std::size_t count = std::min(kStretch, m_count - first);
      if (m_header.pointFormat >= 6) fillCore<true>(records, first, count);
      else fillCore<false>(records, first, count);
      for (const CopiedField& field : m_copied) field.copy(records, stride, first, count);
    }
  }

 private:
  template <class T>
  void copyColumn(std::size_t at, std::vector<T>& column) {
    column.resize(m_count);
    m_copied.push_back({at, sizeof(T), reinterpret_cast<std::byte*>(column.data())});
  }

  ExtraColumn& addExtra(const std::string& name, NumberType type, int components) {
    if (m_extras == m_batch.extra.size()) m_batch.extra.emplace_back();
    ExtraColumn& column = m_batch.extra[m_extras++];
    column.name = name, column.type = type, column.components = components;
    column.data.resize(m_count * column.bytesPerPoint());
    return column;
  }

  void addFieldsWithoutColumn() {
    if (m_header.pointFormat >= 6) {
      copyExtra("scan_flags", NumberType::U8, 1, 15);
      copyExtra("scan_angle", NumberType::I16, 1, 18);
    } else {
      m_flags = addExtra("scan_flags", NumberType::U8, 1).data.data();
      copyExtra("scan_angle_rank", NumberType::I8, 1, 16);
    }
    copyExtra("user_data", NumberType::U8, 1, 17);
    if (m_header.hasNir()) copyExtra("nir", NumberType::U16, 1, 36);
    if (m_header.hasWaveforms()) copyExtra("wave_packet", NumberType::U8, 29, m_header.wavePacketOffset());
  }

  /// Coordinates, and the fields that share a byte.
  template <bool kWide>
  void fillCore(const std::byte* records, std::size_t first, std::size_t count) {
    const std::size_t stride = m_header.recordLength;
    const glm::dvec3 scale = m_header.scale, offset = m_header.offset;
    glm::dvec3* position = m_batch.position.data();
    // Bytes may stand for anything: the columns' own addresses would be read again for each.
    std::uint8_t *number = m_batch.returnNumber.data(), *returnCount = m_batch.returnCount.data(), *classes = m_batch.classification.data();
    std::byte* flags = m_flags;
    const std::byte* at = records + first * stride;
    for (std::size_t i = first; i < first + count; ++i, at += stride) {
      const glm::dvec3 steps(lasValue<std::int32_t>(at, 0), lasValue<std::int32_t>(at, 4), lasValue<std::int32_t>(at, 8));
      position[i] = scale * steps + offset;
      const auto returns = lasValue<std::uint8_t>(at, 14);
      number[i] = returns & (kWide ? 0x0F : 0x07);
      returnCount[i] = kWide ? returns >> 4 : returns >> 3 & 0x07;
      if constexpr (kWide) {
        classes[i] = lasValue<std::uint8_t>(at, 16);
      } else {
        // Three flags stand in the upper bits of the classification: they come where the formats 6-10 have them.
        const auto classification = lasValue<std::uint8_t>(at, 15);
        classes[i] = classification & 0x1F;
        flags[i] = static_cast<std::byte>(classification >> 5 | (returns & 0xC0));
      }
    }
  }

  const LasHeader& m_header;
  std::size_t m_count;
  PointBatch& m_batch;
  std::size_t m_extras = 0;  ///< of the batch's extra columns, those that are filled
  std::byte* m_flags = nullptr;
  std::vector<CopiedField> m_copied;
};

/// How many bytes stand behind the last described one.
std::uint32_t undescribedBytes(const LasHeader& header) {
  const std::uint32_t described =
      header.extras.empty() ? lasRecordLength(header.pointFormat) : header.extras.back().offset + header.extras.back().size;
  return header.recordLength - described;
}

std::string nameOf(const LasExtraBytes& extra) {
  return extra.name.empty() ? "extra_bytes" : extra.name;
}

void copyExtras(const LasHeader& header, const OwnColumns& own, BatchFilling& filling) {
  for (const LasExtraBytes& extra : header.extras) {
    if (own.takes(extra) || extra.size == 0) continue;
    const int components = extra.type == 0 ? static_cast<int>(extra.size) : extra.components;
    filling.copyExtra(nameOf(extra), kTypes[extra.type], components, extra.offset);
  }
  if (const std::uint32_t rest = undescribedBytes(header); rest > 0)
    filling.copyExtra("extra_bytes", NumberType::U8, static_cast<int>(rest), header.recordLength - rest);
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
  const OwnColumns own(header);
  BatchFilling filling(header, count, batch);
  copyExtras(header, own, filling);
  filling.run(records);
  batch.rgbWhite = unshiftedColours ? 255 : 65535;
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
    if (extra.size > 0) names.push_back(nameOf(extra));
  if (undescribedBytes(header) > 0) names.push_back("extra_bytes");
  return names;
}

}  // namespace alidade

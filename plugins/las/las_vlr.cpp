// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_vlr.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "las/las_crs.h"
#include "las/las_stations.h"

namespace alidade {

namespace {

constexpr std::uint64_t kVlrHeader = 54;
constexpr std::uint64_t kEvlrHeader = 60;
// A description longer than this is none; it bounds what a hostile length makes us read.
constexpr std::uint64_t kLongestPayload = 1 << 20;
constexpr std::uint64_t kMostForeign = 16 << 20;

/// What the records of interest held, until the CRS is decided; and how much has been taken of others'.
struct CrsRecords {
  std::string wkt;
  std::vector<std::uint16_t> geoKeys;
  std::uint64_t foreignBytes = 0;
};

std::string textOf(const std::byte* bytes, std::size_t most) {
  const char* text = reinterpret_cast<const char*>(bytes);
  return {text, strnlen(text, most)};
}

std::string wktOf(const std::vector<std::byte>& payload) {
  std::string text(reinterpret_cast<const char*>(payload.data()), payload.size());
  text.resize(strnlen(text.data(), text.size()));
  while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ') text.pop_back();
  return text;
}

/// What the record's fields are called, here and in stores: extra bytes of such a name would be taken for them.
bool isFieldName(const std::string& name, const LasHeader& header) {
  constexpr std::array names = {"rgb", "intensity", "classification", "return_number", "return_count", "number_of_returns", "gps_time",
                                "point_source", "point_source_id", "scan_flags", "scan_angle", "scan_angle_rank", "user_data", "wave_packet"};
  return std::find(names.begin(), names.end(), name) != names.end() || (name == "nir" && header.hasNir());
}

/// Gives extra bytes names that nothing else has.
class ExtraNames {
 public:
  explicit ExtraNames(LasHeader& header) : m_header(header) {}

  void give(LasExtraBytes& extra) {
    const std::string given = extra.name.empty() ? "extra_bytes" : extra.name;
    extra.name = given;
    for (int& number = m_last[given]; isFieldName(extra.name, m_header) || !m_taken.insert(extra.name).second;)
      extra.name = fmt::format("{}_{}", given.substr(0, 26), number = std::max(number + 1, 2));
    if (extra.name != given)
      m_header.warnings.push_back({fmt::format("Extra bytes \"{}\" have the name of another column; they are called \"{}\"", given, extra.name),
                                   "extra bytes record"});
  }

 private:
  LasHeader& m_header;
  std::set<std::string> m_taken;
  std::map<std::string, int> m_last;  ///< number that a name was told apart with
};

/// The rest of an entry (LAS 1.4 R15, table 24): no_data at 40, min at 64, max at 88, scale at 112, offset at 136, three numbers
/// each; the description at 160. The options' bits 0 to 4 say which are meant.
ColumnMeaning meaningOf(const std::byte* entry, int type, std::uint8_t options) {
  ColumnMeaning meaning;
  const char* text = reinterpret_cast<const char*>(entry + 160);
  meaning.description.assign(text, strnlen(text, 32));
  if (type == 0) return meaning;  // the options are its size
  meaning.given = options & 0x1F;
  for (std::size_t i = 0; i < 3; ++i) {
    if ((options & 1) != 0) meaning.noData[i] = lasValue<std::uint64_t>(entry, 40 + 8 * i);
    if ((options & 2) != 0) meaning.least[i] = lasValue<std::uint64_t>(entry, 64 + 8 * i);
    if ((options & 4) != 0) meaning.largest[i] = lasValue<std::uint64_t>(entry, 88 + 8 * i);
    if ((options & 8) != 0) meaning.scale[static_cast<int>(i)] = lasValue<double>(entry, 112 + 8 * i);
    if ((options & 16) != 0) meaning.offset[static_cast<int>(i)] = lasValue<double>(entry, 136 + 8 * i);
  }
  return meaning;
}

void readExtraBytes(const std::vector<std::byte>& payload, LasHeader& header) {
  constexpr std::size_t kEntry = 192;
  constexpr std::array<std::uint32_t, 11> sizes = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  std::uint32_t offset = lasRecordLength(header.pointFormat);
  ExtraNames names(header);
  for (std::size_t at = 0; at + kEntry <= payload.size(); at += kEntry) {
    const std::byte* entry = payload.data() + at;
    const int type = lasValue<std::uint8_t>(entry, 2);
    const std::uint8_t options = lasValue<std::uint8_t>(entry, 3);
    LasExtraBytes extra;
    const char* name = reinterpret_cast<const char*>(entry + 4);
    extra.name.assign(name, strnlen(name, 32));
    extra.offset = offset;
    if (type == 0) {
      extra.size = options;
    } else if (type <= 30) {
      // 11-20 and 21-30 are the deprecated pairs and triples of 1-10.
      extra.size = sizes[(type - 1) % 10 + 1] * ((type - 1) / 10 + 1);
      extra.type = (type - 1) % 10 + 1;
      extra.components = (type - 1) / 10 + 1;
      extra.scaled = (options & 0x18) != 0;
    } else {
      header.warnings.push_back(
          {fmt::format("Extra bytes \"{}\" have the unknown type {}; they and what follows are ignored", extra.name,
                       type),
           "extra bytes record"});
      return;
    }
    if (offset + extra.size > header.recordLength) {
      header.warnings.push_back(
          {fmt::format("Extra bytes \"{}\" reach past the {} bytes of a point; they are ignored", extra.name,
                       header.recordLength),
           "extra bytes record"});
      return;
    }
    offset += extra.size;
    extra.meaning = meaningOf(entry, type, options);
    if (extra.size > 0) names.give(extra);
    header.extras.push_back(std::move(extra));
  }
}

void noteUnits(bool degrees, double metresPerUnit, const std::string& unit, const char* where, LasHeader& header) {
  header.degrees = degrees;
  if (degrees)
    header.warnings.push_back({"The coordinates are degrees of latitude and longitude; lengths will not be metres", where});
  else if (std::abs(metresPerUnit - 1) > 1e-9)
    header.warnings.push_back({fmt::format("The coordinates are in {} ({} m); they are used as they stand, as if they were metres",
                                           std::abs(metresPerUnit / 0.3048 - 1) < 1e-5 ? "feet" : fmt::format("units of \"{}\"", unit), metresPerUnit),
                               where});
}

std::string epsgOfGeoKeys(const std::vector<std::uint16_t>& keys, LasHeader& header) {
  // Key directory: version, revision, minor, count; then key, location, count, value (GeoTIFF 1.0, 2.4).
  std::uint16_t projected = 0, geographic = 0, vertical = 0, unit = 0;
  const std::size_t promised = keys.size() >= 4 ? keys[3] : 0;
  const std::size_t entries = std::min(promised, keys.size() / 4 - (keys.size() >= 4 ? 1 : 0));
  if (promised > entries)
    header.warnings.push_back({fmt::format("The GeoTIFF directory promises {} keys and holds {}", promised, entries),
                               "GeoTIFF record"});
  for (std::size_t i = 1; i <= entries; ++i) {
    const std::uint16_t key = keys[4 * i], location = keys[4 * i + 1], value = keys[4 * i + 3];
    if (location != 0) continue;
    if (key == 3072) projected = value;
    if (key == 2048) geographic = value;
    if (key == 4096) vertical = value;
    if (key == 3076) unit = value;
  }
  constexpr std::uint16_t kUserDefined = 32767;
  const bool heights = vertical != 0 && vertical != kUserDefined;
  if (heights) header.crsNote = fmt::format("heights EPSG:{}", vertical);
  if (projected == kUserDefined || (projected == 0 && geographic == kUserDefined))
    header.warnings.push_back({"The coordinate system is user-defined in GeoTIFF keys, which are not read; set it by hand",
                               "GeoTIFF record"});
  const bool plane = projected != 0 && projected != kUserDefined;
  const bool onEllipsoid = projected == 0 && geographic != 0 && geographic != kUserDefined;
  std::string crs;
  if (plane || onEllipsoid) crs = fmt::format("EPSG:{}", plane ? projected : geographic);
  if (heights && !crs.empty()) crs += fmt::format("+{}", vertical);
  const auto units = crsUnits(fmt::format("EPSG:{}", plane ? projected : geographic));
  // The file's own key goes before what its system usually is counted in (GeoTIFF 1.0, 6.3.1.3).
  const double stated = unit == 9002 ? 0.3048 : unit == 9003 ? 1200.0 / 3937.0 : unit == 9001 ? 1.0 : 0.0;
  if (onEllipsoid)
    noteUnits(true, 1, {}, "GeoTIFF key 2048", header);
  else if (stated > 0 || (plane && units && !units->degrees))
    noteUnits(false, stated > 0 ? stated : units->metresPerUnit, units ? units->unit : "", "GeoTIFF key 3076", header);
  return crs;
}

void decideCrs(const CrsRecords& records, LasHeader& header) {
  const bool saysWkt = (header.globalEncoding & 0x10) != 0;
  const bool useWkt = !records.wkt.empty() && (saysWkt || records.geoKeys.empty());
  if (useWkt) {
    const std::string name = epsgOfWkt(records.wkt);
    header.crs = name.empty() ? records.wkt : name;
    if (const auto units = crsUnits(records.wkt)) noteUnits(units->degrees, units->metresPerUnit, units->unit, "WKT record", header);
  } else if (!records.geoKeys.empty()) {
    header.crs = epsgOfGeoKeys(records.geoKeys, header);
  }
  if (saysWkt && records.wkt.empty() && !records.geoKeys.empty())
    header.warnings.push_back({"The header announces a WKT coordinate system, only GeoTIFF keys are there", "header"});
}

/// A record that nothing here reads or makes. Wave forms stay behind, and with them where they stand in the file.
bool isForeign(const std::string& userId, int recordId) {
  if (userId == "LASF_Projection") return recordId != 2112 && recordId != 34735 && recordId != 34736 && recordId != 34737;
  if (userId == "LASF_Spec") return recordId != 4 && recordId != 65535;
  return userId != "laszip encoded" && userId != "copc" && userId != kStationsUser;
}

Result<void> takeRecord(const ByteSource& file, const std::string& userId, int recordId, const std::string& description,
                        std::uint64_t payloadAt, std::uint64_t length, CrsRecords& records, LasHeader& header) {
  const bool wkt = userId == "LASF_Projection" && recordId == 2112;
  const bool geoKeys = userId == "LASF_Projection" && recordId == 34735;
  const bool extra = userId == "LASF_Spec" && recordId == 4;
  const bool laz = userId == "laszip encoded" && recordId == 22204;
  const bool stations = userId == kStationsUser && recordId == kStationsRecord;
  const bool copc = userId == "copc" && recordId == 1 && length >= CopcInfo::kSize;
  const bool foreign = isForeign(userId, recordId);
  if (!wkt && !geoKeys && !extra && !laz && !stations && !copc && !foreign) return {};
  if (length > kLongestPayload) {
    header.warnings.push_back({fmt::format("Record {} of {} is {} bytes long; it is ignored", recordId, userId, length),
                               fmt::format("offset {}", payloadAt)});
    return {};
  }
  if (foreign && (records.foreignBytes += length + kEvlrHeader) > kMostForeign) {
    if (records.foreignBytes - length - kEvlrHeader <= kMostForeign)
      header.warnings.push_back({fmt::format("Records of others take more than {} MiB; record {} of {} and those behind it are ignored",
                                             kMostForeign >> 20, recordId, userId),
                                 fmt::format("offset {}", payloadAt)});
    return {};
  }
  std::vector<std::byte> payload(length);
  if (auto ok = file.readAt(payloadAt, payload); !ok) return fail(ok.error());
  if (foreign) {
    header.foreignRecords.push_back({userId, static_cast<std::uint16_t>(recordId), description, std::move(payload)});
    return {};
  }
  if (copc) header.copc = CopcInfo::parse(payload.data());
  if (stations) {
    auto parsed = parseStations(payload);
    if (parsed)
      header.stations = std::move(*parsed);
    else
      header.warnings.push_back({"The scanner stations cannot be read: " + parsed.error().what, "record 1 of alidade"});
  }
  if (laz) {
    auto layout = parseLazRecord(payload, file.path());
    if (!layout) return fail(layout.error());
    header.laz = std::move(*layout);
  }
  if (wkt) records.wkt = wktOf(payload);
  if (geoKeys) {
    records.geoKeys.resize(payload.size() / 2);
    // An empty vector's data() may be null, which memcpy never takes.
    if (!records.geoKeys.empty()) std::memcpy(records.geoKeys.data(), payload.data(), records.geoKeys.size() * 2);
  }
  if (extra && header.extras.empty()) readExtraBytes(payload, header);
  return {};
}

/// Both kinds of record: reserved u16, user ID 16, record ID u16, length u16 or u64, description 32.
Result<void> walk(const ByteSource& file, bool extended, std::uint64_t at, std::uint64_t end, std::uint32_t count,
                  CrsRecords& records, LasHeader& header) {
  const std::uint64_t size = extended ? kEvlrHeader : kVlrHeader;
  const char* kind = extended ? "extended variable length record" : "variable length record";
  std::array<std::byte, kEvlrHeader> head{};
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool headFits = at <= end && end - at >= size;
    std::uint64_t length = 0;
    if (headFits) {
      if (auto ok = file.readAt(at, std::span(head).first(size)); !ok) return fail(ok.error());
      length = extended ? lasValue<std::uint64_t>(head.data(), 20) : lasValue<std::uint16_t>(head.data(), 20);
    }
    if (!headFits || length > end - at - size) {
      header.warnings.push_back({fmt::format("The {} {} of {} reaches past its room; it and what follows are ignored",
                                             kind, i + 1, count),
                                 fmt::format("offset {}", at)});
      return {};
    }
    const int recordId = lasValue<std::uint16_t>(head.data(), 18);
    auto taken = takeRecord(file, textOf(head.data() + 2, 16), recordId,
                            textOf(head.data() + (extended ? 28 : 22), 32), at + size, length, records, header);
    if (!taken) return taken;
    at += size + length;
  }
  return {};
}

}  // namespace

Result<void> readLasVlrs(const ByteSource& file, LasHeader& header) {
  CrsRecords records;
  auto ok = walk(file, false, header.headerSize, header.pointsOffset, header.vlrCount, records, header);
  if (!ok) return ok;
  if (header.evlrCount > 0) {
    const std::uint64_t pointsEnd =
        header.laz ? header.pointsOffset : header.pointsOffset + header.pointCount * header.recordLength;
    if (header.evlrOffset < pointsEnd || header.evlrOffset > file.size()) {
      header.warnings.push_back({fmt::format("The extended records are said to start at byte {}, where they cannot; "
                                             "they are ignored",
                                             header.evlrOffset),
                                 "header offset 235"});
    } else {
      ok = walk(file, true, header.evlrOffset, file.size(), header.evlrCount, records, header);
      if (!ok) return ok;
    }
  }
  decideCrs(records, header);
  return {};
}

}  // namespace alidade

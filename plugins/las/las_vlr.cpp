// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_vlr.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "las/las_stations.h"

namespace alidade {

namespace {

constexpr std::uint64_t kVlrHeader = 54;
constexpr std::uint64_t kEvlrHeader = 60;
// A description longer than this is none; it bounds what a hostile length makes us read.
constexpr std::uint64_t kLongestPayload = 1 << 20;

/// What the records of interest held, until the CRS is decided.
struct CrsRecords {
  std::string wkt;
  std::vector<std::uint16_t> geoKeys;
};

std::string userIdOf(const std::byte* bytes) {
  const char* text = reinterpret_cast<const char*>(bytes);
  return {text, strnlen(text, 16)};
}

std::string wktOf(const std::vector<std::byte>& payload) {
  std::string text(reinterpret_cast<const char*>(payload.data()), payload.size());
  text.resize(strnlen(text.data(), text.size()));
  while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ') text.pop_back();
  return text;
}

void readExtraBytes(const std::vector<std::byte>& payload, LasHeader& header) {
  constexpr std::size_t kEntry = 192;
  constexpr std::array<std::uint32_t, 11> sizes = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  std::uint32_t offset = lasRecordLength(header.pointFormat);
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
    header.extras.push_back(std::move(extra));
  }
}

void noteLinearUnit(std::uint16_t unit, LasHeader& header) {
  if (unit == 9002 || unit == 9003)
    header.warnings.push_back({"The coordinates are in feet; they are used as they stand, as if they were metres",
                               "GeoTIFF key 3076"});
}

std::string epsgOfGeoKeys(const std::vector<std::uint16_t>& keys, LasHeader& header) {
  // Key directory: version, revision, minor, count; then key, location, count, value (GeoTIFF 1.0, 2.4).
  std::uint16_t projected = 0, geographic = 0, vertical = 0;
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
    if (key == 3076) noteLinearUnit(value, header);
  }
  constexpr std::uint16_t kUserDefined = 32767;
  if (vertical != 0 && vertical != kUserDefined) header.crsNote = fmt::format("heights EPSG:{}", vertical);
  if (projected == kUserDefined || (projected == 0 && geographic == kUserDefined))
    header.warnings.push_back({"The coordinate system is user-defined in GeoTIFF keys, which are not read; set it by hand",
                               "GeoTIFF record"});
  if (projected != 0 && projected != kUserDefined) return fmt::format("EPSG:{}", projected);
  if (projected == 0 && geographic != 0 && geographic != kUserDefined) {
    header.warnings.push_back({"The coordinates are degrees of latitude and longitude; lengths will not be metres",
                               "GeoTIFF key 2048"});
    return fmt::format("EPSG:{}", geographic);
  }
  return {};
}

void decideCrs(const CrsRecords& records, LasHeader& header) {
  const bool saysWkt = (header.globalEncoding & 0x10) != 0;
  const bool useWkt = !records.wkt.empty() && (saysWkt || records.geoKeys.empty());
  if (useWkt) {
    header.crs = records.wkt;
    const bool projected = header.crs.find("PROJC") != std::string::npos;
    if (!projected && (header.crs.starts_with("GEOGCS") || header.crs.starts_with("GEOGCRS")))
      header.warnings.push_back({"The coordinates are degrees of latitude and longitude; lengths will not be metres",
                                 "WKT record"});
    if (projected && header.crs.find("UNIT[\"metre\"") == std::string::npos &&
        header.crs.find("foot") != std::string::npos)
      header.warnings.push_back({"The coordinates are in feet; they are used as they stand, as if they were metres",
                                 "WKT record"});
  } else if (!records.geoKeys.empty()) {
    header.crs = epsgOfGeoKeys(records.geoKeys, header);
  }
  if (saysWkt && records.wkt.empty() && !records.geoKeys.empty())
    header.warnings.push_back({"The header announces a WKT coordinate system, only GeoTIFF keys are there", "header"});
}

Result<void> takeRecord(const ByteSource& file, const std::string& userId, int recordId, std::uint64_t payloadAt,
                        std::uint64_t length, CrsRecords& records, LasHeader& header) {
  const bool wkt = userId == "LASF_Projection" && recordId == 2112;
  const bool geoKeys = userId == "LASF_Projection" && recordId == 34735;
  const bool extra = userId == "LASF_Spec" && recordId == 4;
  const bool laz = userId == "laszip encoded" && recordId == 22204;
  const bool stations = userId == kStationsUser && recordId == kStationsRecord;
  const bool copc = userId == "copc" && recordId == 1 && length >= CopcInfo::kSize;
  if (!wkt && !geoKeys && !extra && !laz && !stations && !copc) return {};
  if (length > kLongestPayload) {
    header.warnings.push_back({fmt::format("Record {} of {} is {} bytes long; it is ignored", recordId, userId, length),
                               fmt::format("offset {}", payloadAt)});
    return {};
  }
  std::vector<std::byte> payload(length);
  if (auto ok = file.readAt(payloadAt, payload); !ok) return fail(ok.error());
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
    auto taken = takeRecord(file, userIdOf(head.data() + 2), recordId, at + size, length, records, header);
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

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_write_header.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "las/las_crs.h"
#include "las/las_stations.h"

namespace alidade {

namespace {

/// A record's length has 16 bits before the points.
constexpr std::size_t kLongestRecord = 65535;

template <class T>
void put(std::vector<std::byte>& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

void putText(std::vector<std::byte>& bytes, std::size_t at, const std::string& text, std::size_t most) {
  std::memcpy(bytes.data() + at, text.data(), std::min(text.size(), most));
}

std::vector<std::byte> terminated(const std::string& text) {
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  std::vector<std::byte> payload(bytes, bytes + text.size());
  payload.push_back(std::byte{0});
  return payload;
}

/// The numbers of "EPSG:n" or "EPSG:n+m"; 0 for anything else.
struct EpsgCodes {
  explicit EpsgCodes(const std::string& crs) {
    if (!crs.starts_with("EPSG:")) return;
    const auto read = [&](std::size_t from, int& code) {
      const auto [end, error] = std::from_chars(crs.data() + from, crs.data() + crs.size(), code);
      if (error != std::errc() || code <= 0 || code >= 32767) code = 0;
      return static_cast<std::size_t>(end - crs.data());
    };
    const std::size_t end = read(5, plane);
    if (end < crs.size() && crs[end] == '+') read(end + 1, heights);
  }
  int plane = 0, heights = 0;
};

/// A GeoTIFF key directory that names the system (GeoTIFF 1.0, 2.4).
std::vector<std::byte> geoKeysOf(const EpsgCodes& epsg) {
  const bool geographic = epsg.plane >= 4000 && epsg.plane < 5000;
  const auto code = [](int n) { return static_cast<std::uint16_t>(n); };
  std::vector<std::uint16_t> keys = {1, 1, 0, code(epsg.heights != 0 ? 3 : 2),
                                     1024, 0, 1, code(geographic ? 2 : 1),
                                     code(geographic ? 2048 : 3072), 0, 1, code(epsg.plane)};
  if (epsg.heights != 0) keys.insert(keys.end(), {4096, 0, 1, code(epsg.heights)});
  const auto* bytes = reinterpret_cast<const std::byte*>(keys.data());
  return {bytes, bytes + keys.size() * sizeof(std::uint16_t)};
}

void appendRecord(std::vector<std::byte>& bytes, const LasRecord& record, bool extended) {
  const std::size_t at = bytes.size(), head = extended ? 60 : 54;
  bytes.resize(at + head);
  putText(bytes, at + 2, record.user, 16);
  put(bytes, at + 18, record.id);
  if (extended)
    put(bytes, at + 20, std::uint64_t{record.payload.size()});
  else
    put(bytes, at + 20, static_cast<std::uint16_t>(record.payload.size()));
  putText(bytes, at + (extended ? 28 : 22), record.description, 32);
  bytes.insert(bytes.end(), record.payload.begin(), record.payload.end());
}

}  // namespace

LasFileFrame LasFileFrame::of(const LasSchema& schema, const ScanWriteOptions& options) {
  LasFileFrame frame;
  const auto add = [&](LasRecord record) {
    auto& list = record.payload.size() <= kLongestRecord ? frame.records : frame.extendedRecords;
    list.push_back(std::move(record));
  };
  if (auto extra = schema.extraBytesRecord(); !extra.empty()) add({"LASF_Spec", 4, "Extra bytes", std::move(extra)});
  const std::string& crs = options.info.crs;
  const EpsgCodes epsg(crs);
  // The formats 6-10 want WKT (LAS 1.4 R15, 2.5), the others have had GeoTIFF keys from the start.
  const std::string wkt = epsg.plane == 0 ? crs : schema.pointFormat() >= 6 ? wktOfEpsg(crs) : std::string();
  if (!wkt.empty()) {
    add({"LASF_Projection", 2112, "OGC coordinate system WKT", terminated(wkt)});
    frame.wkt = true;
  } else if (epsg.plane != 0) {
    add({"LASF_Projection", 34735, "GeoTIFF keys", geoKeysOf(epsg)});
    if (schema.pointFormat() >= 6)
      frame.remarks.push_back(fmt::format("The coordinate system {} is not known here: it stands in the file as GeoTIFF keys, not as WKT", crs));
  }
  for (const ForeignRecord& record : options.notes.records) add({record.user, record.id, record.description, record.payload});
  frame.standardTimes = options.notes.gpsTime == GpsTimeKind::Standard ||
                        (options.notes.gpsTime == GpsTimeKind::Unknown && schema.pointFormat() >= 6);
  if (!options.info.stations.empty())
    add({kStationsUser, kStationsRecord, "Scanner stations", makeStations(options.info.stations)});
  const bool old = schema.pointFormat() <= 3 && !frame.wkt && frame.extendedRecords.empty();
  frame.versionMinor = old ? 2 : 4;
  return frame;
}

std::vector<std::byte> LasFileFrame::bytes(const LasSchema& schema, const LasSchema::Totals& totals,
                                           std::uint64_t extendedAt) const {
  const std::size_t headerSize = versionMinor >= 4 ? 375 : 227;
  std::vector<std::byte> bytes(headerSize);
  putText(bytes, 0, "LASF", 4);
  // Bit 0: times are standard GPS times; bit 4: WKT.
  put(bytes, 6, static_cast<std::uint16_t>((standardTimes ? 1 : 0) | (wkt || schema.pointFormat() >= 6 ? 16 : 0)));
  bytes[24] = std::byte{1};
  bytes[25] = static_cast<std::byte>(versionMinor);
  putText(bytes, 26, "OTHER", 32);
  putText(bytes, 58, "Alidade", 32);
  put(bytes, 94, static_cast<std::uint16_t>(headerSize));
  put(bytes, 100, static_cast<std::uint32_t>(records.size()));
  bytes[104] = static_cast<std::byte>(schema.pointFormat() | (compressed ? 0x80 : 0));
  put(bytes, 105, static_cast<std::uint16_t>(schema.recordLength()));
  const bool legacy = schema.pointFormat() <= 5 && totals.count <= 0xFFFFFFFFu;
  if (legacy) {
    put(bytes, 107, static_cast<std::uint32_t>(totals.count));
    for (int i = 0; i < 5; ++i) put(bytes, 111 + 4 * i, static_cast<std::uint32_t>(totals.byReturn[i]));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double scale = schema.scale()[axis], offset = schema.offset()[axis];
    put(bytes, 131 + 8 * axis, scale);
    put(bytes, 155 + 8 * axis, offset);
    put(bytes, 179 + 16 * axis, scale * totals.high[axis] + offset);
    put(bytes, 187 + 16 * axis, scale * totals.low[axis] + offset);
  }
  if (versionMinor >= 4) {
    put(bytes, 235, extendedRecords.empty() ? std::uint64_t{0} : extendedAt);
    put(bytes, 243, static_cast<std::uint32_t>(extendedRecords.size()));
    put(bytes, 247, totals.count);
    for (int i = 0; i < 15; ++i) put(bytes, 255 + 8 * i, totals.byReturn[i]);
  }
  for (const LasRecord& record : records) appendRecord(bytes, record, false);
  put(bytes, 96, static_cast<std::uint32_t>(bytes.size()));
  return bytes;
}

std::vector<std::byte> LasFileFrame::extendedBytes() const {
  std::vector<std::byte> bytes;
  for (const LasRecord& record : extendedRecords) appendRecord(bytes, record, true);
  return bytes;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/las_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include <nlohmann/json.hpp>

namespace alidade {

namespace {

static_assert(std::endian::native == std::endian::little, "LAS is little-endian and written as it lies");

constexpr std::size_t kHeaderSize = 375;
constexpr std::size_t kPointSize = 36 + 8;
constexpr std::size_t kVlrHeaderSize = 54;
constexpr std::size_t kExtraBytesSize = 192;

template <class T>
void put(std::vector<unsigned char>& bytes, T value) {
  const auto at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

template <class T>
void putAt(std::vector<unsigned char>& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

void putText(std::vector<unsigned char>& bytes, const std::string& text, std::size_t size) {
  const auto at = bytes.size();
  bytes.resize(at + size, 0);
  std::memcpy(bytes.data() + at, text.data(), std::min(text.size(), size));
}

void putVlrHeader(std::vector<unsigned char>& bytes, const char* user, std::uint16_t record, std::size_t size,
                  const char* description) {
  put<std::uint16_t>(bytes, 0);
  putText(bytes, user, 16);
  put<std::uint16_t>(bytes, record);
  put<std::uint16_t>(bytes, static_cast<std::uint16_t>(size));
  putText(bytes, description, 32);
}

void putExtraBytes(std::vector<unsigned char>& bytes, const char* name, const char* description) {
  const auto at = bytes.size();
  bytes.resize(at + kExtraBytesSize, 0);
  bytes[at + 2] = 5;  // unsigned long, 4 bytes
  std::memcpy(bytes.data() + at + 4, name, std::strlen(name));
  std::memcpy(bytes.data() + at + 160, description, std::strlen(description));
}

std::string stationsRecord(const std::vector<Station>& stations) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const Station& s = stations[i];
    const glm::dquat& r = s.worldFromScanner.rotation;
    const glm::dvec3& t = s.worldFromScanner.translation;
    list.push_back({{"name", s.name},
                    {"point_source_id", i + 1},
                    {"rows", s.rows},
                    {"columns", s.columns},
                    {"world_from_scanner",
                     {{"rotation_wxyz", {r.w, r.x, r.y, r.z}}, {"translation_m", {t.x, t.y, t.z}}}}});
  }
  return nlohmann::ordered_json{{"stations", list}}.dump();
}

}  // namespace

Result<void> LasWriter::open(const std::string& path, const glm::dvec3& offset, const std::string& wkt,
                             const std::vector<Station>& stations) {
  if (auto opened = m_file.open(path); !opened) return opened;
  m_offset = glm::round(offset);
  std::vector<unsigned char> bytes(kHeaderSize, 0);
  std::memcpy(bytes.data(), "LASF", 4);
  putAt<std::uint16_t>(bytes, 6, 0x0011);  // standard GPS time, WKT
  bytes[24] = 1;
  bytes[25] = 4;
  std::memcpy(bytes.data() + 26, "SIMULATION", 10);
  std::memcpy(bytes.data() + 58, "Alidade demo site", 17);
  putAt<std::uint16_t>(bytes, 90, 1);  // creation day and year are fixed: same options, same bytes
  putAt<std::uint16_t>(bytes, 92, 2026);
  putAt<std::uint16_t>(bytes, 94, kHeaderSize);
  bytes[104] = 7;
  putAt<std::uint16_t>(bytes, 105, kPointSize);
  for (int axis = 0; axis < 3; ++axis) {
    putAt<double>(bytes, 131 + 8 * axis, kScale);
    putAt<double>(bytes, 155 + 8 * axis, m_offset[axis]);
  }
  std::uint32_t records = 1;
  putVlrHeader(bytes, "LASF_Spec", 4, 2 * kExtraBytesSize, "Extra bytes");
  putExtraBytes(bytes, "row", "scanner row, 0 on top");
  putExtraBytes(bytes, "column", "scanner column");
  if (!wkt.empty()) {
    putVlrHeader(bytes, "LASF_Projection", 2112, wkt.size() + 1, "OGC coordinate system WKT");
    putText(bytes, wkt, wkt.size() + 1);
    ++records;
  }
  const std::string placed = stationsRecord(stations);
  putVlrHeader(bytes, "alidade", 1, placed.size(), "Scanner stations");
  putText(bytes, placed, placed.size());
  ++records;
  putAt<std::uint32_t>(bytes, 96, static_cast<std::uint32_t>(bytes.size()));
  putAt<std::uint32_t>(bytes, 100, records);
  return m_file.write(bytes.data(), bytes.size());
}

Result<void> LasWriter::write(const std::vector<LasPoint>& points) {
  m_buffer.assign(points.size() * kPointSize, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LasPoint& p = points[i];
    unsigned char* out = m_buffer.data() + i * kPointSize;
    const auto store = [out](std::size_t at, const auto& value) {
      std::memcpy(out + at, &value, sizeof value);
    };
    for (int axis = 0; axis < 3; ++axis) {
      const auto step = static_cast<std::int64_t>(std::llround((p.position[axis] - m_offset[axis]) / kScale));
      m_low[axis] = m_count + i == 0 ? step : std::min(m_low[axis], step);
      m_high[axis] = m_count + i == 0 ? step : std::max(m_high[axis], step);
      store(4 * axis, static_cast<std::int32_t>(step));
    }
    store(12, p.intensity);
    out[14] = 0x11;  // return 1 of 1
    out[16] = p.classification;
    store(20, p.pointSource);
    store(22, p.gpsTime);
    for (int channel = 0; channel < 3; ++channel)
      store(30 + 2 * channel, static_cast<std::uint16_t>(p.rgb[channel] * 257));
    store(36, p.row);
    store(40, p.column);
  }
  m_count += points.size();
  return m_file.write(m_buffer.data(), m_buffer.size());
}

Result<void> LasWriter::finish() {
  std::vector<unsigned char> bounds;
  for (int axis = 0; axis < 3; ++axis) {
    put<double>(bounds, static_cast<double>(m_high[axis]) * kScale + m_offset[axis]);
    put<double>(bounds, static_cast<double>(m_low[axis]) * kScale + m_offset[axis]);
  }
  if (auto done = m_file.patch(179, bounds.data(), bounds.size()); !done) return done;
  // The legacy counts at 107 stay 0, as format 7 demands. 247: number of points, then of returns 1 to 15.
  const std::uint64_t counts[2] = {m_count, m_count};
  if (auto done = m_file.patch(247, counts, sizeof counts); !done) return done;
  return m_file.finish();
}

std::string coordinateSystemAt(const glm::dvec3& world) {
  if (world.x < 2'480'000 || world.x > 2'840'000 || world.y < 1'070'000 || world.y > 1'300'000) return {};
  return R"(PROJCS["CH1903+ / LV95",GEOGCS["CH1903+",DATUM["CH1903+",SPHEROID["Bessel 1841",6377397.155,)"
         R"(299.1528128,AUTHORITY["EPSG","7004"]],AUTHORITY["EPSG","6150"]],PRIMEM["Greenwich",0,)"
         R"(AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],)"
         R"(AUTHORITY["EPSG","4150"]],PROJECTION["Hotine_Oblique_Mercator_Azimuth_Center"],)"
         R"(PARAMETER["latitude_of_center",46.9524055555556],PARAMETER["longitude_of_center",7.43958333333333],)"
         R"(PARAMETER["azimuth",90],PARAMETER["rectified_grid_angle",90],PARAMETER["scale_factor",1],)"
         R"(PARAMETER["false_easting",2600000],PARAMETER["false_northing",1200000],UNIT["metre",1,)"
         R"(AUTHORITY["EPSG","9001"]],AXIS["Easting",EAST],AXIS["Northing",NORTH],AUTHORITY["EPSG","2056"]])";
}

}  // namespace alidade

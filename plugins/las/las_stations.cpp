// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_stations.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace alidade {

namespace {

using Json = nlohmann::ordered_json;

LasStation stationOf(const Json& json) {
  LasStation each;
  each.station.name = json.value("name", "");
  each.pointSource = json.at("point_source_id").get<std::uint16_t>();
  each.station.rows = json.value("rows", std::uint32_t{0});
  each.station.columns = json.value("columns", std::uint32_t{0});
  const auto rotation = json.at("world_from_scanner").at("rotation_wxyz").get<std::array<double, 4>>();
  const auto translation = json.at("world_from_scanner").at("translation_m").get<std::array<double, 3>>();
  each.station.worldFromScanner.rotation = glm::dquat(rotation[0], rotation[1], rotation[2], rotation[3]);
  each.station.worldFromScanner.translation = {translation[0], translation[1], translation[2]};
  return each;
}

bool isRigid(const RigidTransform& pose) {
  const glm::dvec3& t = pose.translation;
  return std::abs(glm::length(pose.rotation) - 1) < 1e-6 && std::isfinite(t.x) && std::isfinite(t.y) && std::isfinite(t.z);
}

}  // namespace

Result<std::vector<LasStation>> parseStations(std::span<const std::byte> payload) {
  const char* text = reinterpret_cast<const char*>(payload.data());
  try {
    const Json json = Json::parse(text, text + payload.size());
    std::vector<LasStation> stations;
    for (const Json& each : json.at("stations")) {
      stations.push_back(stationOf(each));
      if (!isRigid(stations.back().station.worldFromScanner)) return fail("a station's pose is no rigid transform");
      if (stations.size() > 65535) return fail("there are more stations than point source IDs");
    }
    return stations;
  } catch (const Json::exception& error) {
    return fail(error.what());
  }
}

std::vector<std::byte> makeStations(const std::vector<Station>& stations) {
  Json list = Json::array();
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const Station& station = stations[i];
    const auto& [r, t] = std::tie(station.worldFromScanner.rotation, station.worldFromScanner.translation);
    list.push_back({{"name", station.name},
                    {"point_source_id", i + 1},
                    {"rows", station.rows},
                    {"columns", station.columns},
                    {"world_from_scanner",
                     {{"rotation_wxyz", {r.w, r.x, r.y, r.z}}, {"translation_m", {t.x, t.y, t.z}}}}});
  }
  const std::string text = Json{{"stations", list}}.dump(-1, ' ', false, Json::error_handler_t::replace);
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

}  // namespace alidade

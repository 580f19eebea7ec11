// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/truth_writer.h"

#include <bit>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "simulate/camera_path.h"
#include "simulate/output_file.h"
#include "simulate/pose_writer.h"

namespace alidade {

namespace {

static_assert(std::endian::native == std::endian::little, "truth is written little-endian as it lies");

using Json = nlohmann::ordered_json;

Json toJson(const glm::dvec3& v) {
  return Json::array({v.x, v.y, v.z});
}
Json toJson(const glm::dvec2& v) {
  return Json::array({v.x, v.y});
}
Json toJson(const RigidTransform& t) {
  return {{"rotation_wxyz", {t.rotation.w, t.rotation.x, t.rotation.y, t.rotation.z}},
          {"translation_m", toJson(t.translation)}};
}
Json toJson(const ProfileRectangle& r) {
  return {{"low_m", toJson(r.low)}, {"high_m", toJson(r.high)}};
}

Json stationsJson(const ScanSummary& scan) {
  Json stations = Json::array();
  for (std::size_t i = 0; i < scan.stations.size(); ++i) {
    const ScanStation& s = scan.stations[i];
    stations.push_back({{"name", s.name},
                        {"point_source_id", i + 1},
                        {"world_from_scanner", toJson(s.worldFromScanner)},
                        {"rows", s.rows},
                        {"columns", s.columns},
                        {"points", s.points},
                        {"mixed_pixels", s.mixedPixels}});
  }
  return stations;
}

Json prismJson(const Prism& prism, const RigidTransform& worldFromSite) {
  Json json{{"origin_m", toJson(worldFromSite * prism.origin)},
            {"x_axis", toJson(worldFromSite.rotation * prism.axes[0])},
            {"y_axis", toJson(worldFromSite.rotation * prism.axes[1])},
            {"z_axis", toJson(worldFromSite.rotation * prism.axes[2])},
            {"depth_m", prism.depth}};
  if (prism.circleRadius > 0)
    json["circle_radius_m"] = prism.circleRadius;
  else
    json["outline"] = toJson(prism.outline);
  Json openings = Json::array();
  for (const auto& opening : prism.openings) openings.push_back(toJson(opening));
  if (!openings.empty()) json["openings"] = openings;
  return json;
}

Json elementsJson(const SiteModel& site) {
  Json elements = Json::array();
  for (const DesignItem& item : site.items)
    elements.push_back({{"name", item.name},
                        {"global_id", item.globalId},
                        {"type", item.ifcType},
                        {"storey", site.storeys[item.storey].name},
                        {"built", item.built},
                        {"prism", prismJson(item.prism, site.worldFromSite)}});
  return elements;
}

Json defectsJson(const SiteModel& site) {
  Json defects = Json::array();
  for (const Defect& defect : site.defects) {
    const DesignItem& item = site.items[defect.item];
    Json json{{"kind", defect.kind}, {"element", item.name}, {"global_id", item.globalId}};
    if (defect.kind == "shifted") {
      json["shift_world_m"] = toJson(site.worldFromSite.rotation * defect.shift);
      json["amount_m"] = glm::length(defect.shift);
    } else if (defect.kind == "tilted") {
      json["axis_point_m"] = toJson(site.worldFromSite * defect.axisPoint);
      json["axis_direction"] = toJson(site.worldFromSite.rotation * defect.axisDirection);
      json["tilt_rad"] = defect.tiltRadians;
      json["top_displacement_m"] = defect.topDisplacement;
    } else {
      json["opening"] = toJson(defect.opening);
    }
    defects.push_back(json);
  }
  return defects;
}

Json cameraJson(const Intrinsics& in) {
  const auto& d = in.distortion;
  return {{"model", "OPENCV5"}, {"width", in.width}, {"height", in.height}, {"fx", in.fx},
          {"fy", in.fy},        {"cx", in.cx},       {"cy", in.cy},         {"k1", d.k[0]},
          {"k2", d.k[1]},       {"p1", d.p1},        {"p2", d.p2},          {"k3", d.k[2]}};
}

Json framesJson(const DemoTruth& truth) {
  Json frames = Json::array();
  for (std::size_t i = 0; i < truth.cameraFromWorld.size(); ++i)
    frames.push_back({{"name", frameFileName(static_cast<int>(i))},
                      {"time_s", static_cast<double>(i) / kFramesPerSecond},
                      {"camera_from_world", toJson(truth.cameraFromWorld[i])},
                      {"has_depth", truth.options->truth && i % truth.truthEvery == 0}});
  return frames;
}

}  // namespace

Result<void> writeStations(const std::string& path, const ScanSummary& scan) {
  return writeWholeFile(path, Json{{"stations", stationsJson(scan)}}.dump(1) + "\n");
}

Result<void> writeTruth(const std::string& path, const DemoTruth& truth) {
  const SiteModel& site = *truth.site;
  Json control = Json::array();
  for (const SeenControlPoint& seen : truth.controlInFirstFrame)
    control.push_back({{"name", site.controlPoints[seen.point].name},
                       {"world_m", toJson(site.worldFromSite * site.controlPoints[seen.point].position)},
                       {"pixel", toJson(seen.pixel)}});
  const Json json{{"seed", truth.options->seed},
                  {"world_from_site", toJson(site.worldFromSite)},
                  {"hidden_tolerance_m", kHiddenTolerance},
                  {"visibility_rule",
                   "2 (hidden) where the as-built depth at the pixel's centre is more than "
                   "hidden_tolerance_m less than the "
                   "design's; else 1 (visible); 0 where the ray meets no design"},
                  {"depth_every_nth_frame", truth.truthEvery},
                  {"camera", cameraJson(truth.intrinsics)},
                  {"frames", framesJson(truth)},
                  {"scan",
                   {{"points", truth.scan.points},
                    {"angular_step_rad", truth.scan.stepRadians},
                    {"highest_elevation_rad", truth.scanner.highestElevation},
                    {"lowest_elevation_rad", truth.scanner.lowestElevation},
                    {"range_noise_m", truth.scanner.rangeNoiseMeters},
                    {"stations", stationsJson(truth.scan)}}},
                  {"control_points_in_first_frame", control},
                  {"defects", defectsJson(site)},
                  {"elements", elementsJson(site)}};
  return writeWholeFile(path, json.dump(1) + "\n");
}

Result<void> writeFrameTruth(const std::string& folder, int frame, const FrameTruth& truth) {
  const auto bytes = [](const auto& image) {
    return std::string_view(reinterpret_cast<const char*>(image.data()),
                            image.size() * sizeof(*image.data()));
  };
  if (auto done = writeWholeFile(fmt::format("{}/depth.{:04}.f32", folder, frame), bytes(truth.depth)); !done)
    return done;
  if (auto done =
          writeWholeFile(fmt::format("{}/designdepth.{:04}.f32", folder, frame), bytes(truth.designDepth));
      !done)
    return done;
  return writeWholeFile(fmt::format("{}/visibility.{:04}.u8", folder, frame), bytes(truth.visibility));
}

}  // namespace alidade

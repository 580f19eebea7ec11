// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/rig_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/device_chain.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr std::uint64_t kMaxBytes = 1 << 20;
constexpr std::size_t kMaxDepth = 16;
const std::string kAdvice = "See the rig file's description in the README";

/// A misspelt key would be passed over in silence.
Result<void> checkKeys(const Json& object, std::initializer_list<const char*> known, const std::string& where) {
  for (const auto& [key, value] : object.items())
    if (std::none_of(known.begin(), known.end(), [&k = key](const char* each) { return k == each; }))
      return fail("The key " + quotedWords(key) + " is unknown", where, kAdvice);
  return {};
}

Result<std::string> textOf(const Json& object, const char* key, const std::string& where) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string() || found->get_ref<const std::string&>().empty())
    return fail(fmt::format("'{}' is missing or no text", key), where, kAdvice);
  return found->get<std::string>();
}

Result<double> numberOf(const Json& object, const char* key, double otherwise, const std::string& where) {
  const auto found = object.find(key);
  if (found == object.end()) return otherwise;
  if (!found->is_number() || !std::isfinite(found->get<double>())) return fail(fmt::format("'{}' is no number", key), where, kAdvice);
  return found->get<double>();
}

template <std::size_t count>
Result<std::array<double, count>> numbersOf(const Json& object, const char* key, const std::string& where) {
  std::array<double, count> numbers{};
  const auto found = object.find(key);
  const bool right = found != object.end() && found->is_array() && found->size() == count &&
                     std::all_of(found->begin(), found->end(), [](const Json& v) { return v.is_number() && std::isfinite(v.get<double>()); });
  if (!right) return fail(fmt::format("'{}' is not a list of {} numbers", key, count), where, kAdvice);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = (*found)[i].get<double>();
  return numbers;
}

/// A position and a unit quaternion.
Result<RigidTransform> mountingOf(const Json& object, const char* position, const char* rotation, const std::string& where) {
  if (!object.is_object()) return fail("The mounting is no object", where, kAdvice);
  if (auto known = checkKeys(object, {position, rotation}, where); !known) return fail(known.error());
  const auto p = numbersOf<3>(object, position, where);
  if (!p) return fail(p.error());
  const auto q = numbersOf<4>(object, rotation, where);
  if (!q) return fail(q.error());
  const glm::dquat quaternion((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
  if (!(std::abs(glm::length(quaternion) - 1) < 1e-3)) return fail(fmt::format("'{}' is no unit quaternion", rotation), where, kAdvice);
  return RigidTransform{glm::normalize(quaternion), {(*p)[0], (*p)[1], (*p)[2]}};
}

Result<std::optional<RigidTransform>> sensorFromCameraOf(const Json& camera, const std::string& where) {
  const auto plain = camera.find("sensor_from_camera"), device = camera.find("device");
  if (plain == camera.end() && device == camera.end() && !camera.contains("camera_axes")) return std::nullopt;
  if ((plain == camera.end()) == (device == camera.end()))
    return fail("One of 'sensor_from_camera' and 'device' is expected", where, kAdvice);
  auto mounting = plain != camera.end() ? mountingOf(*plain, "position_m", "rotation_wxyz", where)
                                        : mountingOf(*device, "camera_in_device_m", "device_from_camera_wxyz", where);
  if (!mounting) return fail(mounting.error());
  const auto axes = camera.find("camera_axes");
  if (axes != camera.end() && *axes != "opencv" && *axes != "opengl")
    return fail("'camera_axes' is neither \"opencv\" nor \"opengl\"", where, kAdvice);
  if (axes != camera.end() && *axes == "opengl") mounting->rotation = mounting->rotation * glm::dquat(0.0, 1.0, 0.0, 0.0);
  return plain != camera.end() ? *mounting : sensorFromCamera({mounting->translation, mounting->rotation});
}

Result<RigCamera> cameraOf(const Json& json, const std::string& path, std::size_t index) {
  std::string where = fmt::format("{}, camera {}", path, index + 1);
  if (!json.is_object()) return fail("The camera is no object", where, kAdvice);
  if (auto known = checkKeys(json, {"name", "pictures", "calibration", "sensor_from_camera", "device", "camera_axes", "start_s", "rate_hz"}, where); !known)
    return fail(known.error());
  RigCamera camera;
  const fs::path folder = fs::path(path).parent_path();
  const std::pair<const char*, std::string*> texts[] = {{"name", &camera.name}, {"pictures", &camera.pictures}, {"calibration", &camera.calibration}};
  for (const auto& [key, into] : texts) {
    auto text = textOf(json, key, where);
    if (!text) return fail(text.error());
    *into = key == std::string_view("name") ? *text : (folder / *text).string();
  }
  auto mounting = sensorFromCameraOf(json, where);
  if (!mounting) return fail(mounting.error());
  camera.sensorFromCamera = *mounting;
  const auto start = numberOf(json, "start_s", 0, where), rate = numberOf(json, "rate_hz", 0, where);
  if (!start) return fail(start.error());
  if (!rate) return fail(rate.error());
  camera.startSecs = *start;
  if (json.contains("rate_hz")) {
    if (!(*rate > 0 && *rate < 1e6)) return fail("'rate_hz' is impossible", where, kAdvice);
    camera.rateHz = *rate;
  } else if (json.contains("start_s")) {
    return fail("'start_s' stands without 'rate_hz'", where, kAdvice);
  }
  return camera;
}

}  // namespace

Result<Rig> parseRig(const std::string& text, const std::string& path) {
  if (jsonDepth(text) > kMaxDepth) return fail("The JSON is nested too deep", path, kAdvice);
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return fail("The JSON is damaged", path, kAdvice);
  if (!json.contains("alidade_rig") || json["alidade_rig"] != 1) return fail("The file does not say \"alidade_rig\": 1", path, kAdvice);
  if (auto known = checkKeys(json, {"alidade_rig", "trajectory", "time_offset_s", "cameras"}, path); !known) return fail(known.error());
  Rig rig;
  const auto trajectory = textOf(json, "trajectory", path);
  if (!trajectory) return fail(trajectory.error());
  rig.trajectory = (fs::path(path).parent_path() / *trajectory).string();
  const auto offset = numberOf(json, "time_offset_s", 0, path);
  if (!offset) return fail(offset.error());
  rig.timeOffsetSecs = *offset;
  const auto cameras = json.find("cameras");
  if (cameras == json.end() || !cameras->is_array() || cameras->empty()) return fail("'cameras' is missing or no list of cameras", path, kAdvice);
  for (std::size_t i = 0; i < cameras->size(); ++i) {
    auto camera = cameraOf((*cameras)[i], path, i);
    if (!camera) return fail(camera.error());
    rig.cameras.push_back(std::move(*camera));
  }
  return rig;
}

Result<Rig> readRigFile(const std::string& path) {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return fail(text.error());
  return parseRig(*text, path);
}

}  // namespace alidade

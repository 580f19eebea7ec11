// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "metashape/metashape_sensor.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

const std::string kAdvice = "Export the cameras from Metashape again";

/// The adjusted calibration, else the initial one, else the only one.
pugi::xml_node calibrationOf(const pugi::xml_node& sensor) {
  for (const char* kind : {"adjusted", "initial"})
    if (const auto found = sensor.find_child_by_attribute("calibration", "class", kind)) return found;
  return sensor.child("calibration");
}

/// Metashape's own letters; what a calibration leaves out is 0.
struct Coefficients {
  double f = 0, cx = 0, cy = 0, b1 = 0, b2 = 0;
  double k1 = 0, k2 = 0, k3 = 0, k4 = 0;
  double p1 = 0, p2 = 0, p3 = 0, p4 = 0;
};

Result<Coefficients> coefficientsOf(const pugi::xml_node& calibration, const std::string& where) {
  Coefficients c;
  const std::pair<const char*, double*> all[] = {{"f", &c.f},   {"cx", &c.cx}, {"cy", &c.cy}, {"b1", &c.b1}, {"b2", &c.b2},
                                                 {"k1", &c.k1}, {"k2", &c.k2}, {"k3", &c.k3}, {"k4", &c.k4}, {"p1", &c.p1},
                                                 {"p2", &c.p2}, {"p3", &c.p3}, {"p4", &c.p4}};
  for (const auto& [name, into] : all) {
    const auto node = calibration.child(name);
    if (!node) continue;
    const auto value = metashapeNumbers(node, 1, fmt::format("the calibration's {}", name), where);
    if (!value) return fail(value.error());
    *into = value->front();
  }
  if (!calibration.child("f") && calibration.child("fx"))
    return fail("The calibration is of PhotoScan before 1.2: it has fx and fy", where, "Open the project in a newer Metashape and export again");
  return c;
}

/// The simplest model that holds the coefficients.
Result<Intrinsics> frameLens(const Coefficients& c, int width, int height) {
  const double fx = c.f + c.b1, u = 0.5 * width + c.cx - 0.5, v = 0.5 * height + c.cy - 0.5;
  if (c.b2 == 0 && c.k4 == 0 && c.p3 == 0 && c.p4 == 0)
    return Intrinsics::fromParameters(CameraModel::OpenCv5, width, height, {fx, c.f, u, v, c.k1, c.k2, c.p2, c.p1, c.k3});
  return Intrinsics::fromParameters(CameraModel::BrownSkewed, width, height,
                                    {fx, c.f, u, v, c.k1, c.k2, c.k3, c.k4, c.p2, c.p1, c.p3, c.p4, c.b2 / fx});
}

}  // namespace

Result<std::vector<double>> metashapeNumbers(const pugi::xml_node& node, std::size_t count, const std::string& what,
                                             const std::string& path) {
  const auto numbers = parseNumbers(node.child_value(), count);
  if (!numbers || numbers->size() != count)
    return fail(fmt::format("The numbers of {} are not {}: {}", what, count, quotedWords(node.child_value())), path, kAdvice);
  if (!std::all_of(numbers->begin(), numbers->end(), [](double v) { return std::isfinite(v); }))
    return fail(fmt::format("A number of {} is not finite", what), path, kAdvice);
  return *numbers;
}

Result<MetashapeSensor> metashapeSensor(const pugi::xml_node& node, const std::string& path) {
  MetashapeSensor sensor;
  sensor.label = node.attribute("label").as_string();
  const std::string where = fmt::format("{}, sensor {}", path, quotedWords(node.attribute("id").as_string()));
  for (const pugi::xml_node property : node.children("property"))
    if (std::string_view(property.attribute("name").as_string()) == "rolling_shutter" && property.attribute("value").as_bool())
      sensor.rollingShutter = true;

  const auto calibration = calibrationOf(node);
  const std::string type = (calibration && calibration.attribute("type") ? calibration : node).attribute("type").as_string();
  if (type != "frame" && type != "fisheye") {
    sensor.refusal = fmt::format("its camera type {} is covered by no camera model here", quotedWords(type));
    return sensor;
  }
  if (!calibration) {
    sensor.refusal = "it has no calibration";
    return sensor;
  }
  const auto resolution = calibration.child("resolution") ? calibration.child("resolution") : node.child("resolution");
  const auto width = parseInteger(resolution.attribute("width").as_string()), height = parseInteger(resolution.attribute("height").as_string());
  constexpr std::int64_t kMaxSide = 1 << 20;
  if (!width || !height || *width < 1 || *height < 1 || *width > kMaxSide || *height > kMaxSide)
    return fail("The calibration has no possible resolution", where, kAdvice);
  const auto c = coefficientsOf(calibration, where);
  if (!c) return fail(c.error());

  const int w = static_cast<int>(*width), h = static_cast<int>(*height);
  auto intrinsics = frameLens(*c, w, h);
  if (type == "fisheye") {
    if (c->p1 != 0 || c->p2 != 0 || c->b2 != 0) {
      sensor.refusal = "it is a fisheye with p1, p2 or b2, which no camera model here covers";
      return sensor;
    }
    intrinsics = Intrinsics::fromParameters(CameraModel::OpenCvFisheye, w, h,
                                            {c->f + c->b1, c->f, 0.5 * w + c->cx - 0.5, 0.5 * h + c->cy - 0.5, c->k1, c->k2, c->k3, c->k4});
  }
  if (!intrinsics) return fail(intrinsics.error().in(where));
  sensor.intrinsics = *intrinsics;
  return sensor;
}

}  // namespace alidade

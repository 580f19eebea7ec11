// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/calibration_writer.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/camera_export_parts.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace {

/// The shortest list of OpenCV's that holds the lens.
Result<std::vector<double>> coefficientsOf(const Intrinsics& in) {
  const Distortion& d = in.distortion;
  if (d.fisheye) return std::vector<double>(d.k.begin(), d.k.begin() + 4);
  const std::pair<std::size_t, const char*> lists[] = {
      {4, "k1 k2 p1 p2"}, {5, "k1 k2 k3 p1 p2"}, {8, "k1 k2 k3 q1 q2 q3 p1 p2"}, {12, "k1 k2 k3 q1 q2 q3 p1 p2 s1 s2 s3 s4"},
      {14, "k1 k2 k3 q1 q2 q3 p1 p2 s1 s2 s3 s4 tauX tauY"}};
  // A calibration with a longer list keeps it, zeros included.
  using enum CameraModel;
  const std::size_t own = in.model == OpenCv5 ? 5 : in.model == OpenCv8 ? 8 : in.model == OpenCv12 ? 12 : in.model == OpenCv14 ? 14 : 4;
  for (const auto& [count, names] : lists) {
    if (count < own || !coefficientBeyond(d, names).empty()) continue;
    std::vector<double> all{d.k[0], d.k[1], d.p1, d.p2, d.k[2], d.q[0], d.q[1], d.q[2], d.s[0], d.s[1], d.s[2], d.s[3], d.tauX, d.tauY};
    all.resize(count);
    return all;
  }
  return fail(fmt::format("OpenCV has no word for the coefficient {} of the lens", coefficientBeyond(d, lists[4].second)), {},
              "Calibrate with one of OpenCV's models, or keep the camera in a project");
}

struct Fields {
  std::array<double, 9> matrix;
  std::vector<double> lens;
};

std::string yamlOf(const Intrinsics& in, const CalibrationRemarks& remarks, const Fields& f) {
  std::string text = fmt::format("%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n", in.width, in.height);
  if (remarks.pictures > 0) text += fmt::format("nframes: {}\n", remarks.pictures);
  const auto matrix = [&](const char* name, int rows, int columns, const auto& values) {
    text += fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n", name, rows, columns, fmt::join(values, ", "));
  };
  matrix("camera_matrix", 3, 3, f.matrix);
  matrix("distortion_coefficients", static_cast<int>(f.lens.size()), 1, f.lens);
  if (in.distortion.fisheye) text += "fisheye_model: 1\n";
  if (remarks.rmsPx > 0) text += fmt::format("avg_reprojection_error: {}\n", remarks.rmsPx);
  return text;
}

std::string xmlOf(const Intrinsics& in, const CalibrationRemarks& remarks, const Fields& f) {
  std::string text = fmt::format("<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>{}</image_width>\n<image_height>{}</image_height>\n",
                                 in.width, in.height);
  if (remarks.pictures > 0) text += fmt::format("<nframes>{}</nframes>\n", remarks.pictures);
  const auto matrix = [&](const char* name, int rows, int columns, const auto& values) {
    text += fmt::format("<{0} type_id=\"opencv-matrix\">\n  <rows>{1}</rows>\n  <cols>{2}</cols>\n  <dt>d</dt>\n  <data>\n    {3}</data></{0}>\n",
                        name, rows, columns, fmt::join(values, " "));
  };
  matrix("camera_matrix", 3, 3, f.matrix);
  matrix("distortion_coefficients", static_cast<int>(f.lens.size()), 1, f.lens);
  if (in.distortion.fisheye) text += "<fisheye_model>1</fisheye_model>\n";
  if (remarks.rmsPx > 0) text += fmt::format("<avg_reprojection_error>{}</avg_reprojection_error>\n", remarks.rmsPx);
  return text + "</opencv_storage>\n";
}

std::string jsonOf(const Intrinsics& in, const CalibrationRemarks& remarks, const Fields& f) {
  std::string text = fmt::format("{{\n    \"image_width\": {},\n    \"image_height\": {},\n", in.width, in.height);
  if (remarks.pictures > 0) text += fmt::format("    \"nframes\": {},\n", remarks.pictures);
  const auto matrix = [&](const char* name, int rows, int columns, const auto& values) {
    text += fmt::format("    \"{}\": {{\n        \"type_id\": \"opencv-matrix\",\n        \"rows\": {},\n        \"cols\": {},\n"
                        "        \"dt\": \"d\",\n        \"data\": [ {} ]\n    }}", name, rows, columns, fmt::join(values, ", "));
  };
  matrix("camera_matrix", 3, 3, f.matrix);
  text += ",\n";
  matrix("distortion_coefficients", static_cast<int>(f.lens.size()), 1, f.lens);
  if (in.distortion.fisheye) text += ",\n    \"fisheye_model\": 1";
  if (remarks.rmsPx > 0) text += fmt::format(",\n    \"avg_reprojection_error\": {}", remarks.rmsPx);
  return text + "\n}\n";
}

}  // namespace

Result<void> writeCalibration(const Intrinsics& in, const CalibrationRemarks& remarks, const std::string& path) {
  if (const auto valid = in.validate(); !valid) return fail(valid.error().in(path));
  const std::string ending = lowerCase(std::filesystem::path(path).extension().string());
  if (ending == ".txt") {
    const auto line = colmapCameraLine(1, in);
    if (!line) return fail(line.error().in(path));
    return writeAtomically(path, "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n" + *line);
  }
  const bool yaml = ending == ".yml" || ending == ".yaml";
  if (!yaml && ending != ".xml" && ending != ".json")
    return fail(fmt::format("A calibration is not written as '{}'", ending), path, "Give a name that ends in .yml, .xml, .json, or .txt for COLMAP");
  const auto lens = coefficientsOf(in);
  if (!lens) return fail(lens.error().in(path));
  const Fields fields{{in.fx, 0, in.cx, 0, in.fy, in.cy, 0, 0, 1}, *lens};
  return writeAtomically(path, yaml ? yamlOf(in, remarks, fields) : ending == ".xml" ? xmlOf(in, remarks, fields) : jsonOf(in, remarks, fields));
}

}  // namespace alidade

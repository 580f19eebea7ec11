// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/camera_export_parts.h"

namespace alidade {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

Result<Json> intrinsicsOf(const CameraRecord& record) {
  const Intrinsics& in = record.camera.intrinsics();
  const Distortion& d = in.distortion;
  Json json = {{"camera_model", "PINHOLE"}, {"w", in.width}, {"h", in.height}, {"fl_x", in.fx}, {"fl_y", in.fy},
               {"cx", in.cx + 0.5},         {"cy", in.cy + 0.5}};
  if (d.fisheye) {
    json["camera_model"] = "OPENCV_FISHEYE";
    for (int i = 0; i < 4; ++i) json[fmt::format("k{}", i + 1)] = d.k[std::size_t(i)];
    return json;
  }
  if (const std::string beyond = coefficientBeyond(d, "k1 k2 k3 p1 p2"); !beyond.empty())
    return fail(fmt::format("transforms.json has no place for the coefficient {} of the lens", beyond), record.name,
                "Calibrate with OpenCV's 4 or 5 coefficients, or a fisheye");
  if (coefficientBeyond(d, "").empty()) return json;
  json["camera_model"] = "OPENCV";
  json.update({{"k1", d.k[0]}, {"k2", d.k[1]}, {"p1", d.p1}, {"p2", d.p2}});
  if (d.k[2] != 0) json["k3"] = d.k[2];
  return json;
}

/// World from camera with OpenGL's axes: half a turn about x, so the second and third column change sign.
Json matrixOf(const RigidTransform& cameraFromWorld) {
  const RigidTransform worldFromCamera = cameraFromWorld.inverse();
  const glm::dmat3 r = worldFromCamera.rotationMatrix();
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({r[0][i], -r[1][i], -r[2][i], worldFromCamera.translation[i]});
  rows.push_back({0.0, 0.0, 0.0, 1.0});
  return rows;
}

}  // namespace

Result<void> writeTransforms(const ExportedSet& set, const std::string& path) {
  std::vector<Json> intrinsics;
  for (const CameraRecord* camera : set.cameras) {
    auto json = intrinsicsOf(*camera);
    if (!json) return fail(json.error());
    intrinsics.push_back(std::move(*json));
  }
  const bool shared = intrinsics.size() == 1;
  Json file = shared ? intrinsics.front() : Json::object();
  file["frames"] = Json::array();
  std::error_code error;
  const fs::path folder = fs::absolute(path, error).parent_path();
  for (const ExportedFrame& each : set.frames) {
    const std::string& image = each.frame->image.path;
    Json frame = {{"file_path", image.empty() ? each.name : fs::path(image).lexically_proximate(folder).generic_string()}};
    if (!shared) frame.update(intrinsics[each.camera]);
    frame["transform_matrix"] = matrixOf(*each.frame->cameraFromWorld);
    file["frames"].push_back(std::move(frame));
  }
  return writeAtomically(path, file.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace alidade

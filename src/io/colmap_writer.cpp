// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "io/camera_export_parts.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

Result<CameraModel> colmapModelOf(const Intrinsics& in) {
  using enum CameraModel;
  constexpr std::array kOwn = {SimplePinhole, Pinhole, SimpleRadial, Radial, OpenCv4, OpenCv8, OpenCvFisheye};
  if (std::find(kOwn.begin(), kOwn.end(), in.model) != kOwn.end()) return in.model;
  if (coefficientBeyond(in.distortion, "").empty()) return Pinhole;
  if (coefficientBeyond(in.distortion, "k1 k2 p1 p2").empty()) return OpenCv4;
  if (const std::string beyond = coefficientBeyond(in.distortion, "k1 k2 k3 q1 q2 q3 p1 p2"); !beyond.empty())
    return fail(fmt::format("No camera model of COLMAP has the coefficient {} of the lens", beyond), {},
                "Calibrate with OpenCV's 4, 5 or 8 coefficients, or a fisheye");
  return OpenCv8;
}

/// A world point with where it was picked.
struct Point {
  std::vector<std::pair<std::size_t, std::size_t>> track;  ///< image (from 0), feature
};

}  // namespace

Result<std::string> colmapCameraLine(std::size_t id, const Intrinsics& intrinsics) {
  const auto model = colmapModelOf(intrinsics);
  if (!model) return fail(model.error());
  Intrinsics in = intrinsics;
  in.model = *model;
  in.cx += 0.5;
  in.cy += 0.5;
  std::string line = fmt::format("{} {} {} {}", id, cameraModelName(*model), in.width, in.height);
  for (const double parameter : in.parameters()) line += fmt::format(" {}", parameter);
  return line + "\n";
}

Result<void> writeColmap(const Project& project, const ExportedSet& set, const std::string& folder, CameraExport& done) {
  std::string cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n";
  for (std::size_t i = 0; i < set.cameras.size(); ++i) {
    const auto line = colmapCameraLine(i + 1, set.cameras[i]->camera.intrinsics());
    if (!line) return fail(line.error().in(set.cameras[i]->name));
    cameras += *line;
  }

  std::map<std::int64_t, std::size_t> imageOf;
  for (std::size_t i = 0; i < set.frames.size(); ++i) imageOf[set.frames[i].frame->id.value] = i;
  std::map<std::tuple<std::string, double, double, double>, std::size_t> pointOf;
  std::vector<Point> points;
  std::vector<std::string> features(set.frames.size());
  std::vector<std::size_t> featureCount(set.frames.size(), 0);
  std::string pointText = "# POINT3D_ID X Y Z R G B ERROR TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  for (const Observation& seen : project.observations) {
    const auto image = imageOf.find(seen.frame.value);
    if (!seen.enabled || !seen.hasPixel() || image == imageOf.end()) continue;
    const auto [at, isNew] = pointOf.emplace(std::tuple(seen.name, seen.world.x, seen.world.y, seen.world.z), points.size());
    if (isNew) points.emplace_back();
    points[at->second].track.emplace_back(image->second, featureCount[image->second]++);
    features[image->second] += fmt::format("{} {} {} ", seen.pixel.x + 0.5, seen.pixel.y + 0.5, at->second + 1);
  }
  std::vector<std::string> lines(points.size());
  for (const auto& [key, index] : pointOf) {
    const auto& [name, x, y, z] = key;
    lines[index] = fmt::format("{} {} {} {} 255 255 255 -1", index + 1, x, y, z);
    for (const auto& [image, feature] : points[index].track) lines[index] += fmt::format(" {} {}", image + 1, feature);
  }
  for (const std::string& line : lines) pointText += line + "\n";

  std::string images = "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then POINTS2D[] as (X, Y, POINT3D_ID)\n";
  for (std::size_t i = 0; i < set.frames.size(); ++i) {
    const RigidTransform& pose = *set.frames[i].frame->cameraFromWorld;
    images += fmt::format("{} {} {} {} {} {} {} {} {} {}\n{}\n", i + 1, pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z,
                          pose.translation.x, pose.translation.y, pose.translation.z, set.frames[i].camera + 1, set.frames[i].name, features[i]);
  }

  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return fail("The folder cannot be made: " + error.message(), folder, "Choose another folder");
  const std::pair<const char*, const std::string*> files[] = {{"cameras.txt", &cameras}, {"images.txt", &images}, {"points3D.txt", &pointText}};
  for (const auto& [name, text] : files)
    if (auto written = writeAtomically((fs::path(folder) / name).string(), *text); !written) return written;
  done.points = points.size();
  return {};
}

}  // namespace alidade

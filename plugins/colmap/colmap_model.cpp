// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap/colmap_model.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

bool allFinite(const auto& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isfinite(v); });
}

/// COLMAP's own names only: Alidade's further names stand in no COLMAP file.
std::optional<CameraModel> colmapModel(std::string_view name) {
  static constexpr std::array<std::string_view, 7> known = {"SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL",
                                                            "OPENCV", "FULL_OPENCV", "OPENCV_FISHEYE"};
  return std::find(known.begin(), known.end(), name) == known.end() ? std::nullopt : parseCameraModel(name);
}

/// COLMAP's two short fisheye models are OPENCV_FISHEYE with one focal length and the last
/// coefficients 0 (COLMAP 3.8, base/camera_models.h).
void expandShortFisheye(std::string_view& name, std::vector<double>& parameters) {
  const std::size_t coefficients = name == "SIMPLE_RADIAL_FISHEYE" ? 1 : name == "RADIAL_FISHEYE" ? 2 : 0;
  if (coefficients == 0 || parameters.size() != 3 + coefficients) return;
  parameters.insert(parameters.begin(), parameters.front());
  parameters.resize(8, 0.0);
  name = "OPENCV_FISHEYE";
}

Result<RigidTransform> poseOf(const ColmapModel::Image& image, const std::string& place) {
  if (!allFinite(image.pose))
    return fail("The pose of " + quotedWords(image.name) + " is not finite", place, "Remove the image from the model or register it again");
  const auto& p = image.pose;
  const double length = std::hypot(std::hypot(p[0], p[1]), std::hypot(p[2], p[3]));
  if (!(length > 1e-6) || !std::isfinite(length))
    return fail("The rotation of " + quotedWords(image.name) + " is zero or no quaternion", place, "Export the model again");
  return RigidTransform{glm::dquat(p[0] / length, p[1] / length, p[2] / length, p[3] / length), {p[4], p[5], p[6]}};
}

}  // namespace

Result<void> ColmapModel::addCamera(std::int64_t id, std::string_view modelName, std::int64_t width, std::int64_t height,
                                    std::vector<double> parameters, const std::string& place) {
  if (!allFinite(parameters)) return fail(fmt::format("A parameter of camera {} is not finite", id), place, "Calibrate the camera again");
  constexpr int kMaxSide = 1 << 20;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
    return fail(fmt::format("Camera {} has the impossible size {} × {}", id, width, height), place, "Export the model again");

  expandShortFisheye(modelName, parameters);
  const auto kind = colmapModel(modelName);
  if (!kind)
    return fail("The camera model " + quotedWords(modelName) + " is not read", place,
                "Read are SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, OPENCV_FISHEYE, "
                "SIMPLE_RADIAL_FISHEYE and RADIAL_FISHEYE: calibrate with one of them, or run COLMAP's image_undistorter");
  auto intrinsics = Intrinsics::fromParameters(*kind, static_cast<int>(width), static_cast<int>(height), parameters);
  if (!intrinsics) return fail(intrinsics.error().in(place));
  intrinsics->cx -= 0.5;
  intrinsics->cy -= 0.5;
  if (auto valid = intrinsics->validate(); !valid) return fail(valid.error().in(place));
  if (!m_cameraById.emplace(id, static_cast<int>(m_set.cameras.size())).second)
    return fail(fmt::format("The camera {} comes twice", id), place, "Remove one of the two");
  m_set.cameras.push_back(*intrinsics);
  return {};
}

Result<void> ColmapModel::addImage(const Image& image, const std::string& place) {
  const auto pose = poseOf(image, place);
  if (!pose) return fail(pose.error());
  const int index = static_cast<int>(m_set.pictures.size());
  if (!m_pictureById.emplace(image.id, index).second)
    return fail(fmt::format("The image id {} comes twice", image.id), place, "Export the model again");
  PosedPicture picture;
  picture.name = std::string(image.name);
  picture.cameraFromWorld = *pose;
  if (!m_names.insert(picture.name).second) m_nameTwice.note(fmt::format("{}: {}", place, quotedWords(image.name)));
  if (const auto camera = m_cameraById.find(image.camera); camera != m_cameraById.end()) picture.camera = camera->second;
  else m_noCamera.note(fmt::format("{}: camera {} of {}", place, image.camera, quotedWords(image.name)));
  m_set.pictures.push_back(std::move(picture));
  m_features.emplace_back();
  return {};
}

Result<void> ColmapModel::addFeature(double x, double y, const std::string& place) {
  if (!std::isfinite(x) || !std::isfinite(y)) return fail("An image point is not finite", place, "Export the model again");
  m_features.back().emplace_back(x - 0.5, y - 0.5);
  return {};
}

Result<void> ColmapModel::startPoint(const std::array<double, 3>& world, const std::array<std::int64_t, 3>& colour,
                                     const std::string& place) {
  if (!allFinite(world)) return fail("The point's coordinates are not finite", place, "Export the model again");
  if (std::any_of(colour.begin(), colour.end(), [](std::int64_t c) { return c < 0 || c > 255; }))
    return fail("The point's colour is not between 0 and 255", place, "Export the model again");
  TiePoint point;
  point.world = {world[0], world[1], world[2]};
  point.colour = {std::uint8_t(colour[0]), std::uint8_t(colour[1]), std::uint8_t(colour[2]), 255};
  m_set.tiePoints.push_back(std::move(point));
  return {};
}

void ColmapModel::addSighting(std::int64_t image, std::int64_t feature, const std::string& place) {
  const auto picture = m_pictureById.find(image);
  const bool known = picture != m_pictureById.end() && feature >= 0 &&
                     feature < static_cast<std::int64_t>(m_features[static_cast<std::size_t>(picture->second)].size());
  if (!known) {
    m_dangling.note(fmt::format("{}: image {}, feature {}", place, image, feature));
    return;
  }
  m_set.tiePoints.back().seenIn.emplace_back(
      picture->second, m_features[static_cast<std::size_t>(picture->second)][static_cast<std::size_t>(feature)]);
}

CameraSet ColmapModel::take() {
  m_noCamera.tell(m_set.warnings, "images are of a camera that the model lacks");
  m_nameTwice.tell(m_set.warnings, m_nameTwice.count == 1 ? "image name comes twice" : "image names come twice");
  m_noPoints.tell(m_set.warnings, "images have no line of points");
  m_dangling.tell(m_set.warnings, "sightings of points are in images or features that the model lacks");
  return std::move(m_set);
}

}  // namespace alidade

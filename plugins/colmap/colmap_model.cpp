// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap/colmap_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr std::size_t kMaxWarnings = 20;  // of one sort; the rest is counted

/// Warnings of one sort: the first few in full, then a count.
class WarningList {
 public:
  WarningList(std::vector<ImportWarning>& warnings, std::string sort) : m_warnings(warnings), m_sort(std::move(sort)) {}
  ~WarningList() {
    if (m_count > kMaxWarnings)
      m_warnings.push_back({std::to_string(m_count - kMaxWarnings) + " more of the kind: " + m_sort, m_lastPlace});
  }
  void add(const std::string& what, const std::string& place) {
    if (++m_count <= kMaxWarnings) m_warnings.push_back({what, place});
    m_lastPlace = place;
  }

 private:
  std::vector<ImportWarning>& m_warnings;
  std::string m_sort;
  std::string m_lastPlace;
  std::size_t m_count = 0;
};

bool isComment(std::string_view line) { return trimmed(line).starts_with('#'); }

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
bool expandShortFisheye(std::string_view& name, std::vector<double>& parameters) {
  const std::size_t coefficients = name == "SIMPLE_RADIAL_FISHEYE" ? 1 : name == "RADIAL_FISHEYE" ? 2 : 0;
  if (coefficients == 0 || parameters.size() != 3 + coefficients) return false;
  parameters.insert(parameters.begin(), parameters.front());
  parameters.resize(8, 0.0);
  name = "OPENCV_FISHEYE";
  return true;
}

struct ImageLine {
  std::int64_t id = 0, camera = 0;
  std::array<double, 7> pose{};  // qw qx qy qz tx ty tz
  std::string_view name;
};

/// IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME
std::optional<ImageLine> parseImageLine(std::string_view line) {
  FieldReader fields(line);
  ImageLine image;
  const auto id = fields.integer();
  if (!id) return std::nullopt;
  image.id = *id;
  for (double& value : image.pose) {
    const auto number = fields.number();
    if (!number) return std::nullopt;
    value = *number;
  }
  const auto camera = fields.integer();
  image.name = fields.rest();
  if (!camera || image.name.empty()) return std::nullopt;
  image.camera = *camera;
  return image;
}

Result<RigidTransform> poseOf(const ImageLine& image, const std::string& place) {
  if (!allFinite(image.pose))
    return fail("The pose of " + quotedWords(image.name) + " is not finite", place, "Remove the image from the model or register it again");
  const auto& p = image.pose;
  const double length = std::hypot(std::hypot(p[0], p[1]), std::hypot(p[2], p[3]));
  if (!(length > 1e-6) || !std::isfinite(length))
    return fail("The rotation of " + quotedWords(image.name) + " is zero or no quaternion", place, "Export the model again");
  return RigidTransform{glm::dquat(p[0] / length, p[1] / length, p[2] / length, p[3] / length), {p[4], p[5], p[6]}};
}

/// X Y POINT3D_ID, again and again.
Result<std::vector<glm::dvec2>> parseFeatures(std::string_view line, const std::string& place) {
  std::vector<glm::dvec2> features;
  FieldReader fields(line);
  std::string_view field;
  while (fields.next(field)) {
    const auto x = parseNumber(field), y = fields.number();
    const bool hasPoint = y && fields.next(field);
    if (!x || !hasPoint || !parseInteger(field))
      return fail("The image's points are no triples of x, y and a point id", place, "Export the model again");
    if (!std::isfinite(*x) || !std::isfinite(*y)) return fail("An image point is not finite", place, "Export the model again");
    features.emplace_back(*x - 0.5, *y - 0.5);
  }
  return features;
}

}  // namespace

Result<void> parseColmapCameras(std::string_view text, const std::string& path, ColmapModel& model) {
  LineReader lines(text);
  std::string_view line;
  while (lines.next(line)) {
    if (trimmed(line).empty() || isComment(line)) continue;
    const std::string place = placeInFile(path, lines.number());
    FieldReader fields(line);
    const auto id = fields.integer();
    std::string_view name;
    const bool named = id && fields.next(name);
    const auto width = fields.integer(), height = fields.integer();
    if (!named || !width || !height)
      return fail("The line is no camera: id, model, width, height and parameters are expected", place, "Export the model again as text");
    std::vector<double> parameters;
    for (std::string_view field; fields.next(field);) {
      const auto number = parseNumber(field);
      if (!number) return fail("The camera parameter " + quotedWords(field) + " is no number", place, "Export the model again");
      parameters.push_back(*number);
    }
    if (!allFinite(parameters)) return fail("A parameter of camera " + std::to_string(*id) + " is not finite", place, "Calibrate the camera again");
    constexpr int kMaxSide = 1 << 20;
    if (*width < 1 || *height < 1 || *width > kMaxSide || *height > kMaxSide)
      return fail("Camera " + std::to_string(*id) + " has the impossible size " + std::to_string(*width) + " × " +
                      std::to_string(*height), place, "Export the model again");

    expandShortFisheye(name, parameters);
    const auto kind = colmapModel(name);
    if (!kind)
      return fail("The camera model " + quotedWords(name) + " is not read", place,
                  "Read are SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, OPENCV_FISHEYE, "
                  "SIMPLE_RADIAL_FISHEYE and RADIAL_FISHEYE: calibrate with one of them, or run COLMAP's image_undistorter");
    auto intrinsics = Intrinsics::fromParameters(*kind, static_cast<int>(*width), static_cast<int>(*height), parameters);
    if (!intrinsics) return fail(intrinsics.error().in(place));
    intrinsics->cx -= 0.5;
    intrinsics->cy -= 0.5;
    if (auto valid = intrinsics->validate(); !valid) return fail(valid.error().in(place));
    if (!model.cameraById.emplace(*id, static_cast<int>(model.set.cameras.size())).second)
      return fail("The camera " + std::to_string(*id) + " comes twice", place, "Remove one of the two");
    model.set.cameras.push_back(*intrinsics);
  }
  return {};
}

Result<void> parseColmapImages(std::string_view text, const std::string& path, bool withFeatures,
                               const Progress& progress, ColmapModel& model) {
  WarningList noCamera(model.set.warnings, "images of a camera that cameras.txt lacks");
  WarningList noPoints(model.set.warnings, "images without their line of points");
  WarningList twice(model.set.warnings, "image names that come twice");
  std::unordered_map<std::string_view, int> names;
  LineReader lines(text);
  std::string_view line;
  bool wantsPoints = false;  // the line after an image's own holds its points, and may be empty
  while (lines.next(line)) {
    if (progress.cancelled()) return fail(cancelledError());
    if (isComment(line)) continue;
    const std::string place = placeInFile(path, lines.number());
    if (wantsPoints) {
      wantsPoints = false;
      if (!parseImageLine(line)) {
        if (!withFeatures) continue;
        auto features = parseFeatures(line, place);
        if (!features) return fail(features.error());
        model.features.back() = std::move(*features);
        continue;
      }
      noPoints.add("The image has no line of points", placeInFile(path, lines.number() - 1));
    } else if (trimmed(line).empty()) {
      continue;
    }
    const auto image = parseImageLine(line);
    if (!image)
      return fail("The line is no image: id, four numbers of rotation, three of translation, camera id and name are expected",
                  place, "Export the model again as text");
    const auto pose = poseOf(*image, place);
    if (!pose) return fail(pose.error());
    const int index = static_cast<int>(model.set.pictures.size());
    if (!model.pictureById.emplace(image->id, index).second)
      return fail("The image id " + std::to_string(image->id) + " comes twice", place, "Export the model again");
    if (!names.emplace(image->name, index).second) twice.add("The image name " + quotedWords(image->name) + " comes twice", place);
    PosedPicture picture;
    picture.name = std::string(image->name);
    picture.cameraFromWorld = *pose;
    if (const auto camera = model.cameraById.find(image->camera); camera != model.cameraById.end()) picture.camera = camera->second;
    else noCamera.add("The camera " + std::to_string(image->camera) + " of " + quotedWords(image->name) + " is not in cameras.txt", place);
    model.set.pictures.push_back(std::move(picture));
    model.features.emplace_back();
    wantsPoints = true;
    progress.report(lines.fraction(), "Reading images.txt");
  }
  return {};
}

Result<void> parseColmapPoints(std::string_view text, const std::string& path, const Progress& progress, ColmapModel& model) {
  WarningList dangling(model.set.warnings, "points seen in images or features that are not there");
  LineReader lines(text);
  std::string_view line;
  while (lines.next(line)) {
    if (trimmed(line).empty() || isComment(line)) continue;
    if (lines.number() % 1024 == 0) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(lines.fraction(), "Reading points3D.txt");
    }
    const auto broken = [&](const std::string& what) {
      return fail(what, placeInFile(path, lines.number()), "Export the model again as text");
    };
    FieldReader fields(line);
    bool complete = fields.integer().has_value();
    std::array<double, 3> world{};
    for (double& value : world) {
      const auto number = fields.number();
      complete = complete && number;
      value = number.value_or(0);
    }
    std::array<std::int64_t, 3> colour{};
    for (auto& value : colour) {
      const auto number = fields.integer();
      complete = complete && number;
      value = number.value_or(0);
    }
    if (!complete || !fields.number()) return broken("The line is no point: id, X, Y, Z, R, G, B, error and track are expected");
    if (!allFinite(world)) return broken("The point's coordinates are not finite");
    if (std::any_of(colour.begin(), colour.end(), [](std::int64_t c) { return c < 0 || c > 255; }))
      return broken("The point's colour is not between 0 and 255");

    TiePoint point;
    point.world = {world[0], world[1], world[2]};
    point.colour = {std::uint8_t(colour[0]), std::uint8_t(colour[1]), std::uint8_t(colour[2]), 255};
    for (std::string_view field; fields.next(field);) {
      const auto imageId = parseInteger(field), feature = fields.integer();
      if (!imageId || !feature) return broken("The point's track is no list of image and feature numbers");
      const auto picture = model.pictureById.find(*imageId);
      const bool known = picture != model.pictureById.end() && *feature >= 0 &&
                         *feature < std::int64_t(model.features[std::size_t(picture->second)].size());
      if (known) point.seenIn.emplace_back(picture->second, model.features[std::size_t(picture->second)][std::size_t(*feature)]);
      else dangling.add("The point is seen in image " + std::to_string(*imageId) + ", feature " + std::to_string(*feature) +
                            ", which images.txt lacks", placeInFile(path, lines.number()));
    }
    model.set.tiePoints.push_back(std::move(point));
  }
  return {};
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "transforms/transforms_reader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "plugin_api/picture_header.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t(128) << 20;
constexpr std::size_t kMaxDepth = 32;
const std::string kAdvice = "Write the file again with Nerfstudio's ns-process-data or instant-ngp's colmap2nerf";

/// A frame's own value, else the file's.
const Json* valueOf(const Json& file, const Json& frame, const char* key) {
  if (const auto own = frame.find(key); own != frame.end() && !own->is_null()) return &*own;
  if (const auto shared = file.find(key); shared != file.end() && !shared->is_null()) return &*shared;
  return nullptr;
}

/// Nothing where the key is not there.
Result<std::optional<double>> numberOf(const Json& file, const Json& frame, const char* key, const std::string& where) {
  const Json* value = valueOf(file, frame, key);
  if (!value) return std::optional<double>();
  if (!value->is_number()) return fail(fmt::format("'{}' is no number", key), where, kAdvice);
  const double number = value->get<double>();
  if (!std::isfinite(number)) return fail(fmt::format("'{}' is not finite", key), where, kAdvice);
  return std::optional<double>(number);
}

enum class Kind { Perspective, Fisheye };

Result<Kind> kindOf(const Json& file, const Json& frame, const std::string& where) {
  const Json* model = valueOf(file, frame, "camera_model");
  const Json* fisheye = valueOf(file, frame, "is_fisheye");
  if (!model) return fisheye && fisheye->is_boolean() && fisheye->get<bool>() ? Kind::Fisheye : Kind::Perspective;
  if (!model->is_string()) return fail("'camera_model' is no text", where, kAdvice);
  const auto& name = model->get_ref<const std::string&>();
  for (const char* known : {"SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV"})
    if (name == known) return Kind::Perspective;
  if (name == "OPENCV_FISHEYE") return Kind::Fisheye;
  return fail("The camera model " + quotedWords(name) + " is not read", where,
              "Read are PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV and OPENCV_FISHEYE");
}

Result<glm::ivec2> sizeOf(const Json& file, const Json& frame, const std::string& name, const PictureSize& pictureSize,
                          const std::string& where) {
  const auto w = numberOf(file, frame, "w", where), h = numberOf(file, frame, "h", where);
  if (!w) return fail(w.error());
  if (!h) return fail(h.error());
  if (!*w || !*h) {
    if (const auto measured = pictureSize(name)) return *measured;
    return fail("The frame has no w and h, and its picture is not there to be measured", where, "Add w and h, the pictures' size in pixels");
  }
  const auto possible = [](double v) { return v >= 1 && v <= 1 << 20 && v == std::floor(v); };
  if (!possible(**w) || !possible(**h)) return fail(fmt::format("The size {} × {} is impossible", **w, **h), where, kAdvice);
  return glm::ivec2(static_cast<int>(**w), static_cast<int>(**h));
}

/// The focal length of a field of view across `pixels`.
double focalOf(double angle, double pixels) { return 0.5 * pixels / std::tan(0.5 * angle); }

Result<Intrinsics> intrinsicsOf(const Json& file, const Json& frame, const std::string& name, const PictureSize& pictureSize,
                                const std::string& where) {
  const auto kind = kindOf(file, frame, where);
  if (!kind) return fail(kind.error());
  const auto size = sizeOf(file, frame, name, pictureSize, where);
  if (!size) return fail(size.error());
  std::map<std::string, std::optional<double>> values;
  for (const char* key : {"fl_x", "fl_y", "cx", "cy", "k1", "k2", "k3", "k4", "p1", "p2", "camera_angle_x", "camera_angle_y"}) {
    const auto number = numberOf(file, frame, key, where);
    if (!number) return fail(number.error());
    values[key] = *number;
  }
  const auto orZero = [&](const char* key) { return values[key].value_or(0.0); };
  if (!values["fl_x"] && values["camera_angle_x"]) values["fl_x"] = focalOf(*values["camera_angle_x"], size->x);
  if (!values["fl_y"] && values["camera_angle_y"]) values["fl_y"] = focalOf(*values["camera_angle_y"], size->y);
  if (!values["fl_x"]) values["fl_x"] = values["fl_y"];
  if (!values["fl_x"]) return fail("The frame has no fl_x and no camera_angle_x", where, "Add fl_x, the focal length in pixels");
  const double fx = *values["fl_x"], fy = values["fl_y"].value_or(fx);
  const double cx = values["cx"].value_or(0.5 * size->x) - 0.5, cy = values["cy"].value_or(0.5 * size->y) - 0.5;
  const double k1 = orZero("k1"), k2 = orZero("k2"), k3 = orZero("k3"), k4 = orZero("k4"), p1 = orZero("p1"), p2 = orZero("p2");

  Result<Intrinsics> made;
  if (*kind == Kind::Fisheye) {
    if (p1 != 0 || p2 != 0) return fail("A fisheye with p1 or p2 is covered by no camera model here", where, "Calibrate without them");
    made = Intrinsics::fromParameters(CameraModel::OpenCvFisheye, size->x, size->y, {fx, fy, cx, cy, k1, k2, k3, k4});
  } else if (k4 != 0) {
    return fail("k4 of an OPENCV lens is not read: some take it for r⁸, some for OpenCV's denominator", where, "Calibrate without k4");
  } else if (k3 != 0) {
    made = Intrinsics::fromParameters(CameraModel::OpenCv5, size->x, size->y, {fx, fy, cx, cy, k1, k2, p1, p2, k3});
  } else if (k1 != 0 || k2 != 0 || p1 != 0 || p2 != 0) {
    made = Intrinsics::fromParameters(CameraModel::OpenCv4, size->x, size->y, {fx, fy, cx, cy, k1, k2, p1, p2});
  } else {
    made = Intrinsics::fromParameters(CameraModel::Pinhole, size->x, size->y, {fx, fy, cx, cy});
  }
  if (!made) return fail(made.error().in(where));
  return made;
}

/// Three or four rows of four numbers with a rotation in them.
Result<RigidTransform> matrixOf(const Json& rows, const std::string& key, const std::string& where) {
  const auto broken = [&](const char* what) { return fail(fmt::format("'{}' {}", key, what), where, kAdvice); };
  if (!rows.is_array() || rows.size() < 3 || rows.size() > 4) return broken("is no matrix of 3 or 4 rows");
  glm::dmat3 rotation(1.0);
  glm::dvec3 translation(0);
  for (int r = 0; r < static_cast<int>(rows.size()); ++r) {
    const Json& row = rows[std::size_t(r)];
    if (!row.is_array() || row.size() != 4) return broken("has a row that is not four numbers");
    for (int c = 0; c < 4; ++c) {
      if (!row[std::size_t(c)].is_number()) return broken("has a row that is not four numbers");
      const double value = row[std::size_t(c)].get<double>();
      if (!std::isfinite(value)) return broken("holds a number that is not finite");
      if (r == 3 && value != (c == 3 ? 1.0 : 0.0)) return broken("does not end with the row 0 0 0 1");
      if (r < 3 && c < 3) rotation[c][r] = value;
      if (r < 3 && c == 3) translation[r] = value;
    }
  }
  const auto turned = nearestRotation(rotation);
  if (!turned) return broken("holds no rotation: it is scaled, sheared or mirrored");
  return RigidTransform{*turned, translation};
}

/// What Nerfstudio did to the survey's coordinates: pInFile = scale (applied pInWorld).
struct Applied {
  RigidTransform fileFromWorld;
  double scale = 1;
  bool any = false;
};

Result<Applied> appliedOf(const Json& file, const std::string& path, CameraSet& set) {
  Applied applied;
  if (const auto found = file.find("applied_transform"); found != file.end() && !found->is_null()) {
    const auto matrix = matrixOf(*found, "applied_transform", path);
    if (!matrix) return fail(matrix.error());
    applied.fileFromWorld = *matrix;
    applied.any = true;
  }
  const auto scale = numberOf(file, Json::object(), "applied_scale", path);
  if (!scale) return fail(scale.error());
  applied.scale = scale->value_or(1.0);
  if (!(applied.scale > 1e-12 && applied.scale < 1e12)) return fail("'applied_scale' is impossible", path, kAdvice);
  applied.any = applied.any || applied.scale != 1;
  if (applied.any)
    set.warnings.push_back({"The file's applied_transform and applied_scale were undone: poses are in the coordinates from before them", path});
  return applied;
}

Result<CameraSet> cameraSetOf(const Json& file, const std::string& path, const PictureSize& pictureSize) {
  CameraSet set;
  const auto frames = file.find("frames");
  if (frames == file.end() || !frames->is_array()) return fail("The JSON has no list of 'frames'", path, kAdvice);
  if (frames->empty()) return fail("The list of 'frames' is empty", path, kAdvice);
  const auto applied = appliedOf(file, path, set);
  if (!applied) return fail(applied.error());
  const RigidTransform openCvFromOpenGl{glm::dquat(0.0, 1.0, 0.0, 0.0), glm::dvec3(0)};  // half a turn about x
  std::map<std::vector<double>, int> known;
  for (std::size_t i = 0; i < frames->size(); ++i) {
    const Json& frame = (*frames)[i];
    const std::string where = fmt::format("{}, frame {}", path, i);
    if (!frame.is_object()) return fail("The frame is no object", where, kAdvice);
    const auto name = frame.find("file_path");
    if (name == frame.end() || !name->is_string()) return fail("The frame has no 'file_path'", where, kAdvice);
    const auto matrix = frame.find("transform_matrix");
    if (matrix == frame.end()) return fail("The frame has no 'transform_matrix'", where, kAdvice);
    auto fileFromCamera = matrixOf(*matrix, "transform_matrix", where);
    if (!fileFromCamera) return fail(fileFromCamera.error());
    PosedPicture picture;
    picture.name = name->get<std::string>();
    const auto intrinsics = intrinsicsOf(file, frame, picture.name, pictureSize, where);
    if (!intrinsics) return fail(intrinsics.error());
    auto key = intrinsics->parameters();
    key.insert(key.end(), {double(intrinsics->model), double(intrinsics->width), double(intrinsics->height)});
    const auto [camera, isNew] = known.emplace(std::move(key), static_cast<int>(set.cameras.size()));
    if (isNew) set.cameras.push_back(*intrinsics);
    picture.camera = camera->second;
    fileFromCamera->translation /= applied->scale;
    const RigidTransform worldFromOpenGl = applied->any ? applied->fileFromWorld.inverse() * *fileFromCamera : *fileFromCamera;
    picture.cameraFromWorld = openCvFromOpenGl * worldFromOpenGl.inverse();
    if (!picture.cameraFromWorld->isFinite()) return fail("The pose is not finite", where, kAdvice);
    set.pictures.push_back(std::move(picture));
  }
  set.details = fmt::format("transforms.json: {} frames, {} cameras", set.pictures.size(), set.cameras.size());
  return set;
}

std::optional<glm::ivec2> measure(const fs::path& folder, const std::string& filePath) {
  for (const char* ending : {"", ".png", ".jpg", ".jpeg"}) {
    const auto header = readPictureHeader((folder / (filePath + ending)).string());
    if (header) return glm::ivec2(header->width, header->height);
  }
  return std::nullopt;
}

}  // namespace

Result<CameraSet> parseTransforms(const std::string& text, const std::string& path, const PictureSize& pictureSize) {
  if (jsonDepth(text) > kMaxDepth) return fail("The JSON is nested too deep", path, kAdvice);
  const Json file = Json::parse(text, nullptr, false);
  if (!file.is_object()) return fail("The JSON is damaged", path, kAdvice);
  return cameraSetOf(file, path, pictureSize);
}

ReaderDescription TransformsReader::description() const { return {"transforms-json", "Nerfstudio transforms.json", {"json"}}; }

int TransformsReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder || probe.extension != "json") return 0;
  if (probe.holds("\"transform_matrix\"") || (probe.holds("\"frames\"") && (probe.holds("\"fl_x\"") || probe.holds("\"camera_angle_x\""))))
    return 80;
  return fs::path(probe.path).filename().string().starts_with("transforms") ? 40 : 0;
}

Result<CameraSet> TransformsReader::inspect(const std::string& path) const { return read(path, Progress()); }

Result<CameraSet> TransformsReader::read(const std::string& path, const Progress&) const {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return fail(text.error());
  const fs::path folder = fs::path(path).parent_path();
  return parseTransforms(*text, path, [&](const std::string& filePath) { return measure(folder, filePath); });
}

}  // namespace alidade

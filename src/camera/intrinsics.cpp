// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "camera/camera.h"

namespace alidade {

namespace {

struct ModelRow {
  CameraModel model;
  std::string_view name;
  int parameters;
};

constexpr std::array<ModelRow, 12> models{{
    {CameraModel::SimplePinhole, "SIMPLE_PINHOLE", 3},
    {CameraModel::Pinhole, "PINHOLE", 4},
    {CameraModel::SimpleRadial, "SIMPLE_RADIAL", 4},
    {CameraModel::Radial, "RADIAL", 5},
    {CameraModel::OpenCv4, "OPENCV", 8},
    {CameraModel::OpenCv5, "OPENCV5", 9},
    {CameraModel::OpenCv8, "FULL_OPENCV", 12},
    {CameraModel::OpenCv12, "OPENCV12", 16},
    {CameraModel::OpenCv14, "OPENCV14", 18},
    {CameraModel::OpenCvFisheye, "OPENCV_FISHEYE", 8},
    {CameraModel::BrownHighOrder, "BROWN_HIGH_ORDER", 21},
    {CameraModel::BrownSkewed, "BROWN_SKEWED", 13},
}};

const ModelRow& rowOf(CameraModel model) {
  for (const ModelRow& row : models)
    if (row.model == model) return row;
  return models[1];
}

bool hasOneFocalLength(CameraModel model) {
  return model == CameraModel::SimplePinhole || model == CameraModel::SimpleRadial || model == CameraModel::Radial;
}

/// The model's distortion coefficients in the order that it writes them.
std::vector<double*> slots(CameraModel model, Distortion& d) {
  std::vector<double*> brown{&d.k[0], &d.k[1], &d.p1, &d.p2, &d.k[2], &d.q[0], &d.q[1],
                             &d.q[2], &d.s[0], &d.s[1], &d.s[2], &d.s[3], &d.tauX, &d.tauY};
  switch (model) {
    case CameraModel::SimplePinhole:
    case CameraModel::Pinhole: return {};
    case CameraModel::SimpleRadial: return {&d.k[0]};
    case CameraModel::Radial: return {&d.k[0], &d.k[1]};
    case CameraModel::OpenCvFisheye: return {&d.k[0], &d.k[1], &d.k[2], &d.k[3]};
    case CameraModel::BrownHighOrder:
      return {&d.k[0], &d.k[1], &d.k[2], &d.k[3], &d.k[4], &d.k[5], &d.q[0], &d.q[1], &d.q[2],
              &d.p1,   &d.p2,   &d.t[0], &d.t[1], &d.t[2], &d.t[3], &d.shear, &d.skew};
    case CameraModel::BrownSkewed:
      return {&d.k[0], &d.k[1], &d.k[2], &d.k[3], &d.p1, &d.p2, &d.t[0], &d.t[1], &d.imageSkew};
    default: brown.resize(static_cast<std::size_t>(parameterCount(model)) - 4); return brown;
  }
}

}  // namespace

std::string_view cameraModelName(CameraModel model) {
  return rowOf(model).name;
}

std::optional<CameraModel> parseCameraModel(std::string_view name) {
  for (const ModelRow& row : models)
    if (row.name == name) return row.model;
  return std::nullopt;
}

int parameterCount(CameraModel model) {
  return rowOf(model).parameters;
}

std::vector<std::string> parameterNames(CameraModel model) {
  std::vector<std::string> names{"f"};
  if (!hasOneFocalLength(model)) names = {"fx", "fy"};
  names.insert(names.end(), {"cx", "cy"});
  Distortion d;
  const std::pair<const double*, const char*> named[] = {
      {&d.k[0], "k1"}, {&d.k[1], "k2"}, {&d.k[2], "k3"}, {&d.k[3], "k4"},   {&d.k[4], "k5"},    {&d.k[5], "k6"},
      {&d.q[0], "q1"}, {&d.q[1], "q2"}, {&d.q[2], "q3"}, {&d.p1, "p1"},     {&d.p2, "p2"},      {&d.t[0], "t3"},
      {&d.t[1], "t4"}, {&d.t[2], "t5"}, {&d.t[3], "t6"}, {&d.s[0], "s1"},   {&d.s[1], "s2"},    {&d.s[2], "s3"},
      {&d.s[3], "s4"}, {&d.shear, "shear"}, {&d.skew, "skew"}, {&d.tauX, "tauX"}, {&d.tauY, "tauY"}, {&d.imageSkew, "imageSkew"}};
  for (const double* slot : slots(model, d))
    for (const auto& [at, name] : named)
      if (at == slot) names.emplace_back(name);
  return names;
}

std::vector<double> Intrinsics::parameters() const {
  std::vector<double> flat{fx};
  if (!hasOneFocalLength(model)) flat.push_back(fy);
  flat.push_back(cx);
  flat.push_back(cy);
  Distortion copy = distortion;
  for (const double* slot : slots(model, copy)) flat.push_back(*slot);
  return flat;
}

Result<Intrinsics> Intrinsics::fromParameters(CameraModel model, int width, int height,
                                              const std::vector<double>& parameters) {
  const ModelRow& row = rowOf(model);
  if (parameters.size() != static_cast<std::size_t>(row.parameters))
    return fail(fmt::format("Camera model {} takes {} parameters, {} were given", row.name, row.parameters,
                            parameters.size()),
                {}, "Check the model's name and its parameters");
  Intrinsics made;
  made.model = model;
  made.width = width;
  made.height = height;
  auto next = parameters.begin();
  made.fx = *next++;
  made.fy = hasOneFocalLength(model) ? made.fx : *next++;
  made.cx = *next++;
  made.cy = *next++;
  made.distortion.fisheye = model == CameraModel::OpenCvFisheye;
  for (double* slot : slots(model, made.distortion)) *slot = *next++;
  if (const auto valid = made.validate(); !valid) return fail(valid.error());
  return made;
}

Result<void> Intrinsics::validate() const {
  std::string problems;
  const auto add = [&](const std::string& sentence) { problems += (problems.empty() ? "" : "; ") + sentence; };
  constexpr int largest = 1 << 20;
  if (width < 1 || height < 1 || width > largest || height > largest)
    add(fmt::format("the picture's size {}×{} is not between 1 and {} pixels", width, height, largest));
  if (!std::isfinite(fx) || !std::isfinite(fy) || !std::isfinite(cx) || !std::isfinite(cy))
    add("the focal length or the principal point is not a finite number");
  else if (!(fx > 0 && fy > 0))
    add(fmt::format("the focal length {} {} px is not positive", fx, fy));
  const Distortion& d = distortion;
  bool finite = true;
  const auto check = [&](double value) { finite = finite && std::isfinite(value); };
  for (const double c : d.k) check(c);
  for (const double c : d.q) check(c);
  for (const double c : d.t) check(c);
  for (const double c : d.s) check(c);
  for (const double c : {d.p1, d.p2, d.shear, d.skew, d.tauX, d.tauY, d.imageSkew}) check(c);
  if (!finite) add("a distortion coefficient is not a finite number");
  if (d.fisheye != (model == CameraModel::OpenCvFisheye))
    add(fmt::format("the distortion does not fit the camera model {}", rowOf(model).name));
  if (problems.empty()) return {};
  return fail("The calibration cannot be used: " + problems, {}, "Correct the calibration and load it again");
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "camera/camera.h"

namespace alidade {

/// One believable lens of every model on a picture of 5472 × 3648.
inline std::vector<Camera> camerasOfEveryModel() {
  constexpr int w = 5472, h = 3648;
  constexpr double f = 3650, g = 3655, cx = 2741.3, cy = 1815.7;
  const std::vector<std::pair<CameraModel, std::vector<double>>> lenses{
      {CameraModel::SimplePinhole, {f, cx, cy}},
      {CameraModel::Pinhole, {f, g, cx, cy}},
      {CameraModel::SimpleRadial, {f, cx, cy, -0.0336}},
      {CameraModel::Radial, {f, cx, cy, -0.21, 0.07}},
      {CameraModel::OpenCv4, {f, g, cx, cy, -0.26, 0.1, 8e-4, -5e-4}},
      {CameraModel::OpenCv5, {f, g, cx, cy, -0.27, 0.11, -6e-4, 4e-4, -0.021}},
      {CameraModel::OpenCv8, {f, g, cx, cy, 0.21, -0.14, 7e-4, 3e-4, 0.02, 0.48, -0.12, 0.01}},
      {CameraModel::OpenCv12,
       {f, g, cx, cy, 0.21, -0.14, 7e-4, 3e-4, 0.02, 0.48, -0.12, 0.01, 2e-3, -1e-3, 1e-3, 5e-4}},
      {CameraModel::OpenCv14,
       {f, g, cx, cy, 0.21, -0.14, 7e-4, 3e-4, 0.02, 0.48, -0.12, 0.01, 2e-3, -1e-3, 1e-3, 5e-4, 0.02,
        -0.015}},
      {CameraModel::OpenCvFisheye, {1800, 1805, cx, cy, -0.02, 0.006, -0.003, 0.0004}},
      {CameraModel::BrownHighOrder, {f,     g,     cx,   cy,    -0.2, 0.08, -0.02, 0.003, -2e-4, 1e-5, 0.02,
                                     -0.01, 0.002, 5e-4, -4e-4, 0.1,  0.02, 0.01,  0.001, 8e-4,  -6e-4}},
      {CameraModel::BrownSkewed, {f, g, cx, cy, -0.2, 0.08, -0.02, 0.003, 5e-4, -4e-4, 0.1, 0.02, 0.008}},
  };
  std::vector<Camera> cameras;
  for (const auto& [model, parameters] : lenses) {
    const auto intrinsics = Intrinsics::fromParameters(model, w, h, parameters);
    if (!intrinsics) {
      ADD_FAILURE() << cameraModelName(model) << ": " << intrinsics.error().text();
      continue;
    }
    cameras.emplace_back(*intrinsics);
  }
  return cameras;
}

inline std::string nameOf(const Camera& camera) {
  return std::string(cameraModelName(camera.intrinsics().model));
}

}  // namespace alidade

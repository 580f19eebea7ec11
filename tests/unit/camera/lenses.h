// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "camera/camera.h"

namespace alidade {

struct NamedCamera {
  std::string name;
  Intrinsics intrinsics;
};

inline void PrintTo(const NamedCamera& camera, std::ostream* out) {
  *out << camera.name;
}

inline Intrinsics made(CameraModel model, int width, int height, const std::vector<double>& parameters) {
  return Intrinsics::fromParameters(model, width, height, parameters).value();
}

/// The published Metashape calibration of a drone's barrel lens; folds back at r = 1.369.
inline Intrinsics droneCamera() {
  return made(CameraModel::OpenCv8, 5472, 3648,
              {3693.1569475809993, 3693.1569475809993, 2731.4405032761174, 1846.493249050933, -0.26439037908330026,
               0.10751677446162797, -0.000503346062832222, -0.0005062622264917514, -0.030410562029402437, 0, 0, 0});
}

/// One lens of every model, then lenses that are hard on an inverse.
inline std::vector<NamedCamera> lensCatalogue() {
  using enum CameraModel;
  return {
      {"SimplePinhole", made(SimplePinhole, 640, 480, {500, 319.5, 239.5})},
      {"Pinhole", made(Pinhole, 640, 480, {510, 495, 320.25, 236})},
      {"SimpleRadial", made(SimpleRadial, 1296, 1936, {2435.38, 647.5, 967.5, -0.0336422})},
      {"Radial", made(Radial, 1296, 1936, {1400, 650, 960, -0.12, 0.03})},
      {"OpenCv4", made(OpenCv4, 1920, 1080, {1400, 1390, 955, 545, -0.28, 0.09, 1e-3, -7e-4})},
      {"OpenCv5", made(OpenCv5, 1280, 960, {560.16, 561.22, 651.15, 498.94, -0.2327, 0.0616, -3e-5, 6e-5, -0.0075})},
      {"OpenCv8", made(OpenCv8, 1920, 1080,
                       {1100, 1100, 960, 540, 0.42, -0.31, 4e-4, -3e-4, 0.06, 0.71, -0.28, 0.013})},
      {"OpenCv12", made(OpenCv12, 1920, 1080,
                        {1300, 1310, 950, 530, -0.2, 0.05, 8e-4, -5e-4, 0.01, 0.02, 0.01, -0.002, 1e-3, -4e-4, -8e-4,
                         3e-4})},
      {"OpenCv14", made(OpenCv14, 1920, 1080,
                        {1300, 1310, 950, 530, -0.2, 0.05, 8e-4, -5e-4, 0.01, 0.02, 0.01, -0.002, 1e-3, -4e-4, -8e-4,
                         3e-4, 0.03, -0.045})},
      {"OpenCvFisheye", made(OpenCvFisheye, 1280, 1024, {480, 482, 641, 510, -0.013, 0.006, -0.004, 0.0007})},
      {"BrownHighOrder", made(BrownHighOrder, 2448, 2048,
                              {2200, 2205, 1230, 1020, -0.11, 0.08, -0.02, 0.004, -5e-4, 2e-5, 0.03, 0.01, -1e-3, 6e-4,
                               -4e-4, 0.2, -0.05, 0.01, 0.002, 3e-4, -2e-4})},
      {"BrownSkewed", made(BrownSkewed, 1920, 1080,
                           {1400, 1390, 955, 545, -0.28, 0.09, -0.02, 0.003, 1e-3, -7e-4, 0.1, -0.05, 0.012})},
      {"Drone", droneCamera()},
      {"StrongBarrelFoldsInsidePicture", made(OpenCv5, 1920, 1080, {700, 700, 960, 540, -0.35, 0.05, 0, 0, 0})},
      {"StrongPincushion", made(OpenCv5, 1920, 1080, {900, 900, 960, 540, 0.6, 0.4, 0, 0, 0.1})},
      {"Moustache", made(OpenCv5, 1920, 1080, {800, 800, 960, 540, -0.3, 0.25, 1e-4, 1e-4, -0.04})},
      {"DecentringHeavy", made(OpenCv5, 1920, 1080, {1000, 1000, 960, 540, -0.1, 0.02, 0.03, -0.04, 0})},
      {"RationalWithPole", made(OpenCv8, 1920, 1080, {1000, 1000, 960, 540, 0.1, 0, 0, 0, 0, -0.3, 0, 0})},
      {"StrongTilt", made(OpenCv14, 1920, 1080,
                          {1200, 1200, 960, 540, -0.15, 0.03, 2e-3, -1e-3, 0, 0, 0, 0, 0, 0, 0, 0, 0.2, -0.25})},
      {"FisheyeFolds", made(OpenCvFisheye, 1280, 1024, {400, 400, 640, 512, -0.12, -0.02, 0, 0})},
      {"FisheyeWide", made(OpenCvFisheye, 1600, 1600, {560, 560, 800, 800, 0.02, -0.003, 0.0005, 0})},
  };
}

struct TestNamer {
  template <class Info>
  std::string operator()(const Info& test) const {
    return test.param.name;
  }
};

}  // namespace alidade

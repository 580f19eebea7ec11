// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "camera/camera.h"
#include "geometry/rigid_transform.h"
#include "unit/raster/street_scene.h"

namespace alidade::test {

inline Camera streetCamera(int width, int height) {
  const double f = 0.62 * width;
  return Camera(
      *Intrinsics::fromParameters(CameraModel::OpenCv5, width, height,
                                  {f, f, width / 2.0, height / 2.0 - 3, -0.12, 0.03, 0.0004, -0.0003, 0.0}));
}

inline const RigidTransform kStreetView = RigidTransform::cameraLookingAt({-1.0, 0.5, 1.7}, {12, 1.5, 1.2});

/// Exact depth a pixel, infinity for sky.
inline DepthImage truthOf(const StreetScene& scene, const Camera& camera, const RigidTransform& pose) {
  DepthImage truth(camera.width(), camera.height());
  const RigidTransform worldFromCamera = pose.inverse();
  for (int y = 0; y < truth.height(); ++y) {
    for (int x = 0; x < truth.width(); ++x) {
      const auto ray = camera.unproject(glm::dvec2(x, y));
      // The ray's z is 1, so the distance in its lengths is the depth.
      truth.at(x, y) =
          ray ? static_cast<float>(scene.cast(worldFromCamera.translation, worldFromCamera.rotation * *ray))
              : std::numeric_limits<float>::infinity();
    }
  }
  return truth;
}

/// Farther than two pixels from where the depth jumps by more than 5 cm and 3 %.
inline bool isInterior(const DepthImage& truth, int cx, int cy) {
  const float z = truth.at(cx, cy);
  for (int y = cy - 2; y <= cy + 2; ++y) {
    for (int x = cx - 2; x <= cx + 2; ++x) {
      if (!truth.contains(x, y)) continue;
      if (std::isinf(z) != std::isinf(truth.at(x, y))) return false;
      // A pixel of slope for each pixel between: a plane is no edge, however steep.
      if (std::abs(1 / truth.at(x, y) - 1 / z) > (0.05f / z + 0.03f) / z) return false;
    }
  }
  return true;
}

/// What the overlay asks: within its own tolerance (2 cm and 0.2 %) and what the surface itself changes over
/// a pixel.
inline bool agrees(const DepthImage& truth, int x, int y, float z) {
  const float t = truth.at(x, y);
  if (std::isinf(t)) return false;
  float slope = 0;
  for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    if (truth.contains(x + dx, y + dy)) slope = std::max(slope, std::abs(truth.at(x + dx, y + dy) - t));
  }
  return std::abs(z - t) <= 0.02f + 0.002f * t + std::min(slope, 0.03f * t + 0.05f);
}

struct Score {
  double precision, recall, unknown;
};

inline Score scoreOf(const DepthImage& truth, const DepthImage& depth, bool interior) {
  std::size_t surface = 0, known = 0, right = 0;
  for (int y = 0; y < truth.height(); ++y) {
    for (int x = 0; x < truth.width(); ++x) {
      if (isInterior(truth, x, y) != interior) continue;
      const bool isKnown = !std::isnan(depth.at(x, y));
      surface += std::isfinite(truth.at(x, y));
      known += isKnown;
      right += isKnown && agrees(truth, x, y, depth.at(x, y));
    }
  }
  return {100.0 * right / known, 100.0 * right / surface,
          100.0 * (1.0 - static_cast<double>(known) / surface)};
}

/// Four panels for the eye, where ALIDADE_TEST_PICTURES names a folder: dots, occlusion, truth, faults.
inline void savePicture(const std::string& name, const DepthImage& truth, const DepthImage& dots,
                 const DepthImage& depth) {
  const char* folder = std::getenv("ALIDADE_TEST_PICTURES");
  if (!folder) return;
  const int w = truth.width(), h = truth.height();
  std::vector<unsigned char> rgb(static_cast<std::size_t>(w) * h * 12, 0);
  const auto set = [&](int x, int y, unsigned char r, unsigned char g, unsigned char b) {
    unsigned char* p = &rgb[(static_cast<std::size_t>(y) * 2 * w + x) * 3];
    p[0] = r, p[1] = g, p[2] = b;
  };
  const auto gray = [](float z) {
    return static_cast<unsigned char>(std::isfinite(z) ? 255 / (1 + 0.15f * z) + 20 : 0);
  };
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const unsigned char d = gray(dots.at(x, y)), o = gray(depth.at(x, y)), t = gray(truth.at(x, y));
      set(x, y, d, d, d);
      if (std::isnan(depth.at(x, y)))
        set(x + w, y, 60, 0, 90);
      else
        set(x + w, y, o, o, o);
      set(x, y + h, t, t, t);
      const bool known = !std::isnan(depth.at(x, y)), right = known && agrees(truth, x, y, depth.at(x, y));
      const unsigned char dim = isInterior(truth, x, y) ? 255 : 110;
      if (!known)
        set(x + w, y + h, 0, 0, std::isinf(truth.at(x, y)) ? 40 : dim);
      else if (right)
        set(x + w, y + h, 30, 60, 30);
      else
        set(x + w, y + h, dim, depth.at(x, y) < truth.at(x, y) ? 0 : dim, 0);
    }
  }
  std::ofstream file(std::string(folder) + "/" + name + ".ppm", std::ios::binary);
  file << "P6\n" << 2 * w << " " << 2 * h << "\n255\n";
  file.write(reinterpret_cast<const char*>(rgb.data()), static_cast<std::streamsize>(rgb.size()));
}

}  // namespace alidade::test

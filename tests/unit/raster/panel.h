// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <limits>
#include <random>

#include "raster/splatter.h"
#include "unit/cloud/test_clouds.h"

namespace alidade::test {

/// A rectangle corner + s a + t b, s and t in [0, 1], with one point at random in each of its cells.
struct Panel {
  glm::dvec3 corner, a, b;

  PointBatch points(std::size_t count) const {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double edge = std::sqrt(glm::length(a) * glm::length(b) / static_cast<double>(count));
    const int along = static_cast<int>(glm::length(a) / edge),
              across = static_cast<int>(glm::length(b) / edge);
    PointBatch batch;
    for (int i = 0; i < along; ++i)
      for (int j = 0; j < across; ++j)
        batch.position.push_back(corner + (i + unit(random)) / along * a + (j + unit(random)) / across * b);
    return batch;
  }

  /// Depth where the pixel's ray meets it; +inf where it does not.
  double depth(const Camera& camera, const RigidTransform& cameraFromWorld, const glm::dvec2& pixel) const {
    const double inf = std::numeric_limits<double>::infinity();
    const auto ray = camera.unproject(pixel);
    if (!ray) return inf;
    const glm::dmat3 rotation = cameraFromWorld.rotationMatrix();
    const glm::dvec3 c = cameraFromWorld * corner, u = rotation * a, v = rotation * b;
    const glm::dvec3 direction = *ray / ray->z;
    const glm::dvec3 st = glm::inverse(glm::dmat3(u, v, -direction)) * -c;
    return st.x >= 0 && st.x <= 1 && st.y >= 0 && st.y <= 1 && st.z > 0 ? st.z : inf;
  }
};

struct Score {
  double meanError = 0;  ///< of the depth, relative, where both are
  double missing = 0;    ///< of the true pixels, not covered
  double fattened = 0;   ///< pixels covered beyond the true ones, as a part of them
};

inline Score scoreOf(const Panel& panel, const Camera& camera, const RigidTransform& pose,
              const SplatOptions& options, std::size_t points) {
  const auto store = storeFrom(panel.points(points));
  const SplatImages drawn = splat({{store, selectAll(*store, camera, pose)}}, camera, pose, options);
  double trueCount = 0, both = 0, beyond = 0, error = 0;
  for (int y = 0; y < camera.height(); ++y) {
    for (int x = 0; x < camera.width(); ++x) {
      const double expected = panel.depth(camera, pose, {x, y});
      const double z = drawn.depth.at(x, y);
      trueCount += std::isfinite(expected);
      if (std::isfinite(expected) && std::isfinite(z)) both += 1, error += std::abs(z - expected) / expected;
      beyond += std::isfinite(z) && !std::isfinite(expected);
    }
  }
  return {error / both, (trueCount - both) / trueCount, beyond / trueCount};
}

inline Camera brown() {
  return Camera(*Intrinsics::fromParameters(CameraModel::OpenCv5, 640, 480,
                                            {420, 420, 318.2, 241.7, -0.21, 0.06, 0.001, -0.002, -0.01}));
}

/// A board 4 m away whose right half holds an eighth of the left one's points, at random: 4 m × 3 m, in nodes that hold both.
inline PointBatch boardWithASparserHalf() {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  PointBatch batch;
  for (int i = 0; i < 20'000; ++i) {
    const double x = -2 + 4 * unit(random);
    if (x < 0 || i % 8 == 0) batch.position.push_back({x, 4, -1.5 + 3 * unit(random)});
  }
  return batch;
}

}  // namespace alidade::test

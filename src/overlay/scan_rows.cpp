// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/scan_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace alidade {

namespace {

constexpr int kMostSteps = 5;
constexpr double kSettled = 1e-4;  // of the depth

/// Rays of all pixels, z 1: the lens is undone at every eighth pixel, and between them it is smooth.
class Rays {
 public:
  explicit Rays(const Camera& camera) : m_ray((camera.width() - 1) / kStep + 2, (camera.height() - 1) / kStep + 2) {
    parallelFor(static_cast<std::size_t>(m_ray.height()), 4, [&](std::size_t first, std::size_t last, int) {
      for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y)
        for (int x = 0; x < m_ray.width(); ++x) {
          const auto ray = camera.unproject({kStep * x, kStep * y});
          m_ray.at(x, y) = ray ? glm::dvec2(*ray) / ray->z : glm::dvec2(std::numeric_limits<double>::quiet_NaN());
        }
    });
  }

  glm::dvec3 at(int x, int y) const {
    const int i = x / kStep, j = y / kStep;
    const double u = static_cast<double>(x % kStep) / kStep, v = static_cast<double>(y % kStep) / kStep;
    return {glm::mix(glm::mix(m_ray.at(i, j), m_ray.at(i + 1, j), u), glm::mix(m_ray.at(i, j + 1), m_ray.at(i + 1, j + 1), u), v), 1.0};
  }

 private:
  static constexpr int kStep = 8;
  Image<glm::dvec2> m_ray;
};

}  // namespace

void moveToRows(const Camera& camera, const RollingShutter& shutter, DepthImage& depth, ColourImage& colour) {
  if (!shutter.isOn() || depth.empty()) return;
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  const Rays rays(camera);
  const DepthImage middle = std::move(depth);
  const ColourImage middleColour = std::move(colour);
  depth = DepthImage(middle.width(), middle.height(), unknown);
  colour = middleColour.empty() ? ColourImage() : ColourImage(middle.width(), middle.height(), Rgba8{0, 0, 0, 0});
  parallelFor(static_cast<std::size_t>(middle.height()), 8, [&](std::size_t first, std::size_t last, int) {
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      const RigidTransform middleFromRow = exponential(shutter.motion * -shutter.secsAtRow(y, camera.height()));
      const glm::dmat3 rotation = middleFromRow.rotationMatrix();
      for (int x = 0; x < middle.width(); ++x) {
        const glm::dvec3 along = rotation * rays.at(x, y);
        if (!(along.z > 0)) continue;
        int column = x, row = y;
        const auto lookUp = [&](const glm::dvec3& p) -> double {
          if (!(p.z > 0)) return unknown;
          const glm::dvec2 pixel = camera.projectUnchecked(p);
          // Also what is no number.
          if (!(pixel.x > -0.5 && pixel.y > -0.5 && pixel.x < middle.width() - 0.5 && pixel.y < middle.height() - 0.5)) return unknown;
          column = static_cast<int>(std::lround(pixel.x)), row = static_cast<int>(std::lround(pixel.y));
          return middle.at(column, row);
        };
        double seen = lookUp(along), z = seen / along.z;
        for (int step = 0; step < kMostSteps && std::isfinite(seen); ++step) {
          const glm::dvec3 p = z * along + middleFromRow.translation;
          seen = lookUp(p);
          const double change = (seen - p.z) / along.z;
          z += change;
          if (std::abs(change) < kSettled * z) break;
        }
        depth.at(x, y) = z > 0 ? static_cast<float>(z) : unknown;
        if (!colour.empty() && middle.contains(column, row)) colour.at(x, y) = middleColour.at(column, row);
      }
    }
  });
}

}  // namespace alidade

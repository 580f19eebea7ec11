// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <random>

#include "align/scan_view.h"
#include "camera/rolling_shutter.h"

namespace alidade::test {

/// The corner of a room, 8 m wide: floor z = 0, back wall y = 6, side wall x = 4, each with a pattern that has a closed
/// form, at survey coordinates. Its photo is cast ray by ray, so that it knows nothing of points.
class Room {
 public:
  static constexpr double kEast = 2'683'500, kNorth = 1'247'800, kHeight = 412;

  static glm::dvec3 world(const glm::dvec3& inRoom) { return inRoom + glm::dvec3(kEast, kNorth, kHeight); }

  /// Sines of directions and lengths that never repeat within the room: 0..255.
  static double brightness(int wall, double a, double b) {
    double sum = 0;
    for (int i = 0; i < 14; ++i) {
      const double angle = 2.39996 * i + wall, length = 0.22 + 0.17 * i;
      sum += std::sin(6.2831853 / length * (a * std::cos(angle) + b * std::sin(angle)) + 1.7 * i + wall);
    }
    return 128 + 26 * sum;
  }

  static double at(const glm::dvec3& p, int wall) {
    return wall == 0 ? brightness(0, p.x, p.y) : wall == 1 ? brightness(1, p.x, p.z) : brightness(2, p.y, p.z);
  }

  /// Wall and distance along a ray.
  static std::optional<std::pair<int, double>> hit(const glm::dvec3& from, const glm::dvec3& along) {
    std::optional<std::pair<int, double>> best;
    const auto offer = [&](int wall, double distance) {
      const glm::dvec3 p = from + distance * along;
      const bool inside = p.x > -4.001 && p.x < 4.001 && p.y > -1 && p.y < 6.001 && p.z > -0.001 && p.z < 4;
      if (distance > 0 && inside && (!best || distance < best->second)) best = {wall, distance};
    };
    if (along.z != 0) offer(0, -from.z / along.z);
    if (along.y != 0) offer(1, (6 - from.y) / along.y);
    if (along.x != 0) offer(2, (4 - from.x) / along.x);
    return best;
  }

  static AlignmentScene scan(std::size_t points = 300'000) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> noise(0, 0.002);
    PointBatch batch;
    for (std::size_t i = 0; i < points; ++i) {
      const int wall = i % 3;
      glm::dvec3 p = wall == 0   ? glm::dvec3(-4 + 8 * unit(random), -1 + 7 * unit(random), 0)
                     : wall == 1 ? glm::dvec3(-4 + 8 * unit(random), 6, 4 * unit(random))
                                 : glm::dvec3(4, -1 + 7 * unit(random), 4 * unit(random));
      const auto shade = static_cast<std::uint16_t>(std::clamp(at(p, wall), 0.0, 255.0));
      p[wall == 0 ? 2 : wall == 1 ? 1 : 0] += noise(random);
      batch.position.push_back(world(p));
      batch.rgb.push_back({shade, shade, shade});
    }
    PointStoreBuilder builder;
    builder.add(batch);
    AlignmentScene scene;
    scene.scans.push_back(*builder.build(Progress()));
    return scene;
  }

  static Camera camera() {
    return Camera(*Intrinsics::fromParameters(CameraModel::OpenCv5, 640, 480, {520, 521, 322.5, 236.1, -0.11, 0.03, 4e-4, -3e-4, 0}));
  }
  static RigidTransform pose() { return RigidTransform::cameraLookingAt(world({-2.2, -0.4, 1.7}), world({1.6, 4.5, 1.2})); }

  /// Another exposure than the scan's colours, and noise.
  static ColourImage photo(const Camera& camera, const RigidTransform& cameraFromWorld, const RollingShutter& shutter = {}) {
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 2);
    ColourImage image(camera.width(), camera.height());
    for (int y = 0; y < image.height(); ++y) {
      const RigidTransform pose = shutter.poseAtRow(cameraFromWorld, y, image.height());
      const glm::dmat3 toWorld = glm::transpose(pose.rotationMatrix());
      const glm::dvec3 from = pose.centre() - glm::dvec3(kEast, kNorth, kHeight);
      for (int x = 0; x < image.width(); ++x) {
        const auto direction = camera.unproject({x, y});
        const glm::dvec3 along = toWorld * *direction;
        const auto seen = hit(from, along);
        const double light = seen ? 20 + 0.7 * at(from + seen->second * along, seen->first) : 230;
        const auto shade = static_cast<std::uint8_t>(std::clamp(light + noise(random), 0.0, 255.0));
        image.at(x, y) = {shade, shade, shade, 255};
      }
    }
    return image;
  }
};

}  // namespace alidade::test

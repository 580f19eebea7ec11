// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "survey/point_batch.h"

namespace alidade::test {

/// A street that rays meet in closed form: ground, facades with recessed windows, a parked van, kerbs,
/// sign posts of 6 and 10 cm and a railing.
class StreetScene {
 public:
  StreetScene() {
    addBox({-30, -10, -0.5}, {60, 12, 0});   // ground
    addBox({-30, -3.2, 0}, {60, -3, 0.12});  // kerb
    addFacade(9.0);
    addBox({8, -6, 0}, {13, -4, 2.2});      // van
    addBox({-30, -10.3, 0}, {60, -10, 7});  // the other side of the street
    for (int i = 0; i < 9; ++i) addPost({4.0 + 4.5 * i, -2.6}, i % 2 ? 0.05 : 0.03, 3.0);
    for (int i = 0; i < 24; ++i) addPost({2.0 + 0.5 * i, 4.5}, 0.02, 1.0);  // railing
    addBox({2, 4.48, 0.98}, {14, 4.52, 1.03});
  }

  /// Distance along `direction` (any length, in its units) to the nearest surface; infinity for sky.
  double cast(const glm::dvec3& eye, const glm::dvec3& direction) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Box& box : m_boxes) nearest = std::min(nearest, hitBox(box, eye, direction));
    for (const Post& post : m_posts) nearest = std::min(nearest, hitPost(post, eye, direction));
    return nearest;
  }

  /// What a scanner there measures: rays evenly spread in angle, each off by up to `jitter` / 2 of a step,
  /// `noiseMeters` along the ray. With its grid: row from the lowest elevation, column from azimuth 0.
  void scan(const glm::dvec3& eye, std::size_t rays, double noiseMeters, std::uint32_t seed, PointBatch& into,
            double jitter = 1.0, std::uint16_t station = 0) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> off(-0.5 * jitter, 0.5 * jitter);
    std::normal_distribution<double> noise(0.0, noiseMeters);
    const double lowest = -1.2, highest = 1.0;
    const auto rows = static_cast<int>(std::sqrt(rays * (highest - lowest) / (2 * M_PI)));
    const auto columns = static_cast<int>(rays / rows);
    for (int c = 0; c < columns; ++c) {
      for (int r = 0; r < rows; ++r) {
        const double azimuth = 2 * M_PI * (c + off(random)) / columns;
        const double elevation = lowest + (highest - lowest) * (r + 0.5 + off(random)) / rows;
        const glm::dvec3 ray(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                             std::sin(elevation));
        const double range = cast(eye, ray);
        if (range >= 80) continue;
        into.position.push_back(eye + (range + noise(random)) * ray);
        into.row.push_back(static_cast<std::uint32_t>(r));
        into.column.push_back(static_cast<std::uint32_t>(c));
        into.scanner.push_back(station);
      }
    }
  }

 private:
  struct Box {
    glm::dvec3 min, max;
  };
  struct Post {
    glm::dvec2 centre;
    double radius, height;
  };

  void addBox(const glm::dvec3& min, const glm::dvec3& max) { m_boxes.push_back({min, max}); }
  void addPost(const glm::dvec2& centre, double radius, double height) {
    m_posts.push_back({centre, radius, height});
  }

  /// A wall at y with windows 0.25 m deep: the panes, and what of the wall is left around them.
  void addFacade(double y) {
    addBox({-30, y + 0.25, 0}, {60, y + 0.5, 8});
    for (const auto& [low, high] : {std::pair{0.0, 0.9}, {2.3, 3.7}, {5.1, 8.0}}) {
      addBox({-30, y, low}, {60, y + 0.25, high});
    }
    for (int i = -10; i < 20; ++i) addBox({3.0 * i, y, 0}, {3.0 * i + 1.6, y + 0.25, 8});
  }

  static double hitBox(const Box& box, const glm::dvec3& eye, const glm::dvec3& direction) {
    double enter = 1e-9, leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (box.min[axis] - eye[axis]) / direction[axis],
                   b = (box.max[axis] - eye[axis]) / direction[axis];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter < leave ? enter : std::numeric_limits<double>::infinity();
  }

  static double hitPost(const Post& post, const glm::dvec3& eye, const glm::dvec3& direction) {
    const glm::dvec2 to = glm::dvec2(eye) - post.centre, way(direction);
    const double a = glm::dot(way, way), b = glm::dot(to, way),
                 c = glm::dot(to, to) - post.radius * post.radius;
    const double inside = b * b - a * c;
    if (inside < 0) return std::numeric_limits<double>::infinity();
    const double t = (-b - std::sqrt(inside)) / a;
    const double z = eye.z + t * direction.z;
    return t > 0 && z >= 0 && z <= post.height ? t : std::numeric_limits<double>::infinity();
  }

  std::vector<Box> m_boxes;
  std::vector<Post> m_posts;
};

}  // namespace alidade::test

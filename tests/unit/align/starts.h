// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "align/auto_align.h"
#include "bench/site.h"

namespace alidade::test {

/// A start up to 3° and 0.3 m off: directions even, amounts uniform up to the limit.
inline RigidTransform disturbed(const RigidTransform& truth, std::mt19937& random, double metres = 0.3, double degrees = 3) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> part(0, 1);
  const auto direction = [&] { return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))); };
  RigidTransform start;
  start.rotation = glm::normalize(glm::angleAxis(degrees / 57.29577951308232 * part(random), direction()) * truth.rotation);
  start.translation = -(start.rotation * (truth.centre() + metres * part(random) * direction()));
  return start;
}

/// How far a pose is off, over what the scan shows in the frame.
struct PoseError {
  double medianPx = 0;  ///< of the picture, or of 1920 across where it is wider
  double mmAt10m = 0;   ///< median, across the line of sight, of points 10 m away
};

inline PoseError poseError(const DepthImage& depth, const Camera& small, double scale, const RigidTransform& truth,
                           const RigidTransform& found) {
  std::vector<double> px, mm;
  const RigidTransform move = found * truth.inverse();
  for (int y = 2; y < depth.height(); y += 7)
    for (int x = 2; x < depth.width(); x += 7) {
      const auto ray = small.unproject({x, y});
      if (!ray || !(depth.at(x, y) > 0)) continue;
      const auto p = small.project(move * (*ray * static_cast<double>(depth.at(x, y))));
      if (!p) continue;
      px.push_back(scale * glm::distance(*p, glm::dvec2(x, y)));
      const glm::dvec3 far = 10.0 * glm::normalize(*ray), moved = move * far;
      mm.push_back(1000 * glm::length(moved - far - glm::dot(moved - far, *ray) / glm::dot(*ray, *ray) * *ray));
    }
  const auto median = [](std::vector<double>& v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  return px.empty() ? PoseError{1e9, 1e9} : PoseError{median(px), median(mm)};
}

struct StartStatistics {
  int starts = 0, converged = 0, within = 0, wrong = 0;
  std::vector<double> px, mm, cpuSecs;
};

}  // namespace alidade::test

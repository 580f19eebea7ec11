// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/pose_search.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "base/parallel.h"

namespace alidade {

namespace {

/// Correlation that unrelated places reach by chance.
constexpr float kChance = 0.3f;
constexpr int kClimbs = 12;
constexpr int kClimbSteps = 160;
/// Samples that share a random sequence, so that the result does not hang on the number of threads.
constexpr std::size_t kBlock = 256;

/// Centre of the camera and its attitude, moved: a vector in metres and one in radians.
struct PoseStep {
  glm::dvec3 metres{0}, radians{0};
};

RigidTransform stepped(const RigidTransform& pose, const PoseStep& step) {
  const double angle = glm::length(step.radians);
  const glm::dquat turn = angle > 0 ? glm::angleAxis(angle, step.radians / angle) : glm::dquat(1, 0, 0, 0);
  RigidTransform to;
  to.rotation = glm::normalize(turn * pose.rotation);
  to.translation = -(to.rotation * (pose.centre() + step.metres));
  return to;
}

class Scorer {
 public:
  Scorer(const std::vector<Anchor>& anchors, const Image<float>& photo, const Camera& camera,
         const RigidTransform& start, const SearchRange& range)
      : m_anchors(anchors), m_camera(camera), m_start(start), m_range(range), m_tables(anchors.size()), m_middle(anchors.size()) {
    const double focal = std::max(camera.intrinsics().fx, camera.intrinsics().fy);
    parallelFor(anchors.size(), 1, [&](std::size_t first, std::size_t last, int) {
      for (std::size_t i = first; i < last; ++i) {
        const glm::dvec3 p = start * anchors[i].world;
        const auto projected = camera.project(p);
        if (!projected || p.z < 0.1) continue;
        m_middle[i] = glm::ivec2(glm::round(*projected - glm::dvec2(anchors[i].patch.at)));
        // Seen off the axis, a turn about it and one across both move a point farther than at the centre.
        const double reach = 1.35 * focal * (range.rotationRad + range.positionM / p.z) + 2;
        const int radius = std::min(static_cast<int>(std::ceil(reach)), std::max(photo.width(), photo.height()) / 3);
        m_tables[i] = correlate(anchors[i].patch, photo, radius, m_middle[i]);
      }
    });
  }

  double score(const RigidTransform& pose) const {
    double sum = 0;
    for (std::size_t i = 0; i < m_anchors.size(); ++i) {
      const Image<float>& table = m_tables[i];
      if (table.empty()) continue;
      const glm::dvec3 p = pose * m_anchors[i].world;
      if (p.z < 0.1) continue;
      const glm::dvec2 pixel = m_camera.projectUnchecked(p);
      const glm::dvec2 at = pixel - glm::dvec2(m_anchors[i].patch.at + m_middle[i]) + 0.5 * (table.width() - 1);
      const double fx = std::floor(at.x), fy = std::floor(at.y);
      if (!(fx >= 0 && fy >= 0 && fx + 1 < table.width() && fy + 1 < table.height())) continue;
      const int x = static_cast<int>(fx), y = static_cast<int>(fy);
      const auto a = static_cast<float>(at.x - fx), b = static_cast<float>(at.y - fy);
      const float value = (1 - b) * ((1 - a) * table.at(x, y) + a * table.at(x + 1, y)) +
                          b * ((1 - a) * table.at(x, y + 1) + a * table.at(x + 1, y + 1));
      sum += std::max(0.0f, value - kChance) / (1 - kChance);
    }
    return m_anchors.empty() ? 0 : sum / static_cast<double>(m_anchors.size());
  }

  bool isInRange(const PoseStep& step) const {
    return glm::length(step.metres) <= 1.1 * m_range.positionM && glm::length(step.radians) <= 1.1 * m_range.rotationRad;
  }
  RigidTransform pose(const PoseStep& step) const { return stepped(m_start, step); }

 private:
  const std::vector<Anchor>& m_anchors;
  const Camera& m_camera;
  const RigidTransform& m_start;
  SearchRange m_range;
  std::vector<Image<float>> m_tables;
  std::vector<glm::ivec2> m_middle;
};

/// Uniform in the unit ball.
glm::dvec3 inBall(std::mt19937_64& random) {
  std::uniform_real_distribution<double> side(-1, 1);
  glm::dvec3 v;
  do v = {side(random), side(random), side(random)};
  while (glm::dot(v, v) > 1);
  return v;
}

struct Climber {
  PoseStep step;
  double score = 0;
};

/// Random steps that shrink; each that climbs is kept.
void climb(const Scorer& scorer, const SearchRange& range, std::mt19937_64& random, Climber& climber) {
  for (int i = 0; i < kClimbSteps; ++i) {
    const double size = 0.35 * std::exp(-4.0 * i / kClimbSteps);
    PoseStep next = climber.step;
    next.metres += size * range.positionM * inBall(random);
    next.radians += size * range.rotationRad * inBall(random);
    if (!scorer.isInRange(next)) continue;
    const double score = scorer.score(scorer.pose(next));
    if (score > climber.score) climber = {next, score};
  }
}

}  // namespace

double distancePx(const std::vector<glm::dvec3>& world, const Camera& camera, const RigidTransform& a, const RigidTransform& b) {
  double sum = 0;
  int count = 0;
  for (const glm::dvec3& w : world) {
    const auto p = camera.project(a * w), q = camera.project(b * w);
    if (p && q) sum += glm::distance(*p, *q), ++count;
  }
  return count == 0 ? 1e9 : sum / count;
}

std::vector<PoseCandidate> searchPoses(const std::vector<Anchor>& anchors, const Image<float>& photo, const Camera& camera,
                                       const RigidTransform& start, const SearchRange& range,
                                       int samples, int count, double apartPx) {
  if (anchors.empty()) return {};
  const Scorer scorer(anchors, photo, camera, start, range);
  std::vector<Climber> drawn(samples);
  parallelFor((drawn.size() + kBlock - 1) / kBlock, 1, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t block = first; block < last; ++block) {
      std::mt19937_64 random(block + 1);
      for (std::size_t i = block * kBlock; i < std::min(drawn.size(), (block + 1) * kBlock); ++i) {
        if (i > 0) drawn[i].step = {range.positionM * inBall(random), range.rotationRad * inBall(random)};
        drawn[i].score = scorer.score(scorer.pose(drawn[i].step));
      }
    }
  });
  const std::size_t climbs = std::min<std::size_t>(kClimbs, drawn.size());
  std::partial_sort(drawn.begin(), drawn.begin() + static_cast<std::ptrdiff_t>(climbs), drawn.end(),
                    [](const Climber& a, const Climber& b) { return a.score > b.score; });
  drawn.resize(climbs);
  parallelFor(drawn.size(), 1, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      std::mt19937_64 random(1000 + i);
      climb(scorer, range, random, drawn[i]);
    }
  });
  std::sort(drawn.begin(), drawn.end(), [](const Climber& a, const Climber& b) { return a.score > b.score; });
  std::vector<glm::dvec3> world;
  for (const Anchor& anchor : anchors) world.push_back(anchor.world);
  std::vector<PoseCandidate> best;
  for (const Climber& climber : drawn) {
    const RigidTransform pose = scorer.pose(climber.step);
    const bool isNew = std::all_of(best.begin(), best.end(), [&](const PoseCandidate& other) {
      return distancePx(world, camera, pose, other.cameraFromWorld) > apartPx;
    });
    if (isNew) best.push_back({pose, climber.score});
    if (static_cast<int>(best.size()) == count) break;
  }
  return best;
}

}  // namespace alidade

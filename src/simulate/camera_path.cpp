// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/camera_path.h"

#include <cmath>
#include <numbers>

#include "geometry/angle.h"
#include "simulate/random.h"

namespace alidade {

namespace {

/// A smooth wander with zero mean and unit amplitude, from a few incommensurate waves.
class Wander {
 public:
  Wander(std::uint32_t seed, std::uint64_t stream, double slowest) {
    Random random(seed, stream);
    for (int i = 0; i < 4; ++i) {
      m_frequency[i] = slowest * std::pow(1.9, i) * random.uniform(0.85, 1.15);
      m_phase[i] = random.uniform(0.0, 2.0 * std::numbers::pi);
    }
  }
  double at(double seconds) const {
    double sum = 0, amplitude = 0.6;
    for (int i = 0; i < 4; ++i, amplitude *= 0.55)
      sum += amplitude * std::sin(2.0 * std::numbers::pi * m_frequency[i] * seconds + m_phase[i]);
    return sum;
  }

 private:
  double m_frequency[4], m_phase[4];
};

}  // namespace

Intrinsics demoIntrinsics(int width, int height) {
  Intrinsics intrinsics;
  intrinsics.model = CameraModel::OpenCv5;
  intrinsics.width = width;
  intrinsics.height = height;
  const double scale = width / 1280.0;
  intrinsics.fx = 861.37 * scale;
  intrinsics.fy = 862.05 * scale;
  intrinsics.cx = 0.5 * (width - 1) + 6.82 * scale;
  intrinsics.cy = 0.5 * (height - 1) - 4.47 * scale;
  intrinsics.distortion.k = {-0.2815, 0.0924, -0.0107, 0, 0, 0};
  intrinsics.distortion.p1 = 1.6e-4;
  intrinsics.distortion.p2 = -2.3e-4;
  return intrinsics;
}

struct Walk::Wanders {
  explicit Wanders(std::uint32_t seed)
      : swayX(seed, 401, 0.45), swayY(seed, 402, 0.45), swayZ(seed, 403, 0.6),
        yaw(seed, 404, 0.35), pitch(seed, 405, 0.4), roll(seed, 406, 0.3) {}
  Wander swayX, swayY, swayZ, yaw, pitch, roll;
};

Walk::Walk(std::uint32_t seed) : m_seed(seed), m_wanders(std::make_unique<const Wanders>(seed)) {}
Walk::~Walk() = default;

RigidTransform Walk::at(double seconds) const {
  const Wanders& w = *m_wanders;
  // Back and forth between the right and the left end of the front, 1.1 m/s on average.
  const double along = std::cos(std::numbers::pi * (0.12 + seconds * 1.1 / 14.0));
  const double x = 6.6 * along + 1.2, y = -12.2 - 0.9 * std::cos(1.3 * along) - 0.4 * along;
  const double ground = groundHeight(m_seed, x, y);
  const double step = 0.018 * std::sin(2.0 * std::numbers::pi * 1.85 * seconds);
  const glm::dvec3 eye(x + 0.012 * w.swayX.at(seconds), y + 0.012 * w.swayY.at(seconds),
                       -0.40 + 0.5 * (ground + 0.40) + 1.66 + step + 0.008 * w.swayZ.at(seconds));
  const glm::dvec3 target(0.38 * x + 0.5 + 0.10 * w.yaw.at(seconds), 0.0, 1.35 + 0.08 * w.pitch.at(seconds));
  RigidTransform pose = RigidTransform::cameraLookingAt(eye, target);
  const glm::dquat tilt =
      glm::angleAxis(radiansFromDegrees(0.9 * w.roll.at(seconds) + 0.4), glm::dvec3(0, 0, 1));
  pose.rotation = glm::normalize(tilt * pose.rotation);
  pose.translation = -(pose.rotation * eye);
  return pose;
}

std::vector<RigidTransform> walkPast(int frames, std::uint32_t seed) {
  const Walk walk(seed);
  std::vector<RigidTransform> poses;
  for (int i = 0; i < frames; ++i) poses.push_back(walk.at(i / kFramesPerSecond));
  return poses;
}

std::vector<RigidTransform> perturbed(const std::vector<RigidTransform>& cameraFromWorld,
                                      std::uint32_t seed) {
  const Wander x(seed, 411, 0.13), y(seed, 412, 0.13), z(seed, 413, 0.13);
  const Wander rx(seed, 414, 0.11), ry(seed, 415, 0.11), rz(seed, 416, 0.11);
  std::vector<RigidTransform> poses;
  for (std::size_t i = 0; i < cameraFromWorld.size(); ++i) {
    const double seconds = static_cast<double>(i) / kFramesPerSecond;
    const glm::dvec3 centre =
        cameraFromWorld[i].centre() + 0.018 * glm::dvec3(x.at(seconds), y.at(seconds), z.at(seconds));
    const glm::dvec3 turn =
        radiansFromDegrees(0.2) * glm::dvec3(rx.at(seconds), ry.at(seconds), rz.at(seconds));
    const double angle = glm::length(turn);
    const glm::dquat off = angle > 0 ? glm::angleAxis(angle, turn / angle) : glm::dquat(1, 0, 0, 0);
    RigidTransform pose;
    pose.rotation = glm::normalize(off * cameraFromWorld[i].rotation);
    pose.translation = -(pose.rotation * centre);
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace alidade

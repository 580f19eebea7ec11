// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/view_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace alidade {

namespace {

constexpr double kDefaultFov = 0.7;
// A drag across this many pixels turns by half a circle.
constexpr double kOrbitPixels = 900.0;
// The view never tips closer to the vertical than this, or left and right would swap.
constexpr double kPoleMargin = 0.01;
constexpr double kNearestMetres = 0.01;
constexpr double kFarthestMetres = 1e7;

glm::dquat attitudeFor(const glm::dvec3& forward, const glm::dvec3& up) {
  const glm::dvec3 back = -glm::normalize(forward);
  glm::dvec3 right = glm::cross(up, back);
  if (glm::length(right) < 1e-9) right = glm::cross(glm::dvec3(0, 1, 0), back);
  if (glm::length(right) < 1e-9) right = glm::dvec3(1, 0, 0);
  right = glm::normalize(right);
  return glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back)));
}

}  // namespace

void ViewCamera::resize(int widthPx, int heightPx) {
  m_width = std::max(1, widthPx);
  m_height = std::max(1, heightPx);
}

double ViewCamera::focalPx() const {
  return 0.5 * m_height / std::tan(0.5 * m_verticalFov);
}

ViewRay ViewCamera::rayThrough(const glm::dvec2& px) const {
  const glm::dvec3 inView(px.x - 0.5 * m_width, 0.5 * m_height - px.y, -focalPx());
  return {m_position, m_worldFromView * glm::normalize(inView)};
}

double ViewCamera::depthOf(const glm::dvec3& world) const {
  return glm::dot(world - m_position, forward());
}

std::optional<glm::dvec3> ViewCamera::project(const glm::dvec3& world) const {
  const glm::dvec3 inView = glm::conjugate(m_worldFromView) * (world - m_position);
  const double depth = -inView.z;
  if (!(depth > 1e-6)) return std::nullopt;
  const double f = focalPx();
  return glm::dvec3(0.5 * m_width + f * inView.x / depth, 0.5 * m_height - f * inView.y / depth, depth);
}

Camera ViewCamera::pinhole() const {
  Intrinsics k;
  k.width = m_width;
  k.height = m_height;
  k.fx = k.fy = focalPx();
  k.cx = 0.5 * m_width - 0.5;
  k.cy = 0.5 * m_height - 0.5;
  return Camera(k);
}

RigidTransform ViewCamera::cameraFromWorld() const {
  const glm::dmat3 rotation = glm::transpose(glm::dmat3(right(), -up(), forward()));
  return RigidTransform::fromMatrix(rotation, -(rotation * m_position));
}

double ViewCamera::metresPerPixel(double depth) const {
  return depth / focalPx();
}

void ViewCamera::fit(const Bounds& bounds) {
  if (bounds.empty()) return;
  m_verticalFov = kDefaultFov;
  const glm::dvec3 look = glm::normalize(glm::dvec3(-0.55, 0.75, -0.5));
  m_worldFromView = attitudeFor(look, {0, 0, 1});
  // The eye goes back until the last corner is in the picture, with a margin.
  constexpr double kMargin = 1.06;
  const double vertical = std::tan(0.5 * m_verticalFov), horizontal = vertical * m_width / m_height;
  double distance = 0.5;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner = glm::conjugate(m_worldFromView) * (bounds.corner(i) - bounds.centre());
    const double needed = kMargin * std::max(std::abs(corner.x) / horizontal, std::abs(corner.y) / vertical);
    distance = std::max(distance, needed + corner.z);
  }
  m_position = bounds.centre() - distance * look;
}

void ViewCamera::lookFrom(const glm::dvec3& position, const glm::dvec3& forward, const glm::dvec3& up,
                          double horizontalFov, double verticalFov) {
  m_position = position;
  m_worldFromView = attitudeFor(forward, up);
  const double aspect = static_cast<double>(m_width) / m_height;
  const double tangent = std::max(std::tan(0.5 * verticalFov), std::tan(0.5 * horizontalFov) / aspect);
  m_verticalFov = std::clamp(2.0 * std::atan(tangent), 0.02, 2.6);
}

void ViewCamera::orbit(const glm::dvec3& pivot, const glm::dvec2& deltaPx) {
  const double perPixel = std::numbers::pi / kOrbitPixels;
  const glm::dquat yaw = glm::angleAxis(-deltaPx.x * perPixel, glm::dvec3(0, 0, 1));
  const double polar = std::acos(std::clamp(forward().z, -1.0, 1.0));  // 0 looks straight up
  const double wanted = std::clamp(polar + deltaPx.y * perPixel, kPoleMargin, std::numbers::pi - kPoleMargin);
  const glm::dquat pitch = glm::angleAxis(polar - wanted, right());
  const glm::dquat turn = yaw * pitch;
  m_position = pivot + turn * (m_position - pivot);
  m_worldFromView = glm::normalize(turn * m_worldFromView);
}

void ViewCamera::pan(const glm::dvec3& grabbed, const glm::dvec2& deltaPx) {
  const double scale = metresPerPixel(std::max(depthOf(grabbed), kNearestMetres));
  m_position += scale * (-deltaPx.x * right() + deltaPx.y * up());
}

void ViewCamera::zoomTowards(const glm::dvec3& target, double factor) {
  if (!(factor > 0)) return;
  const glm::dvec3 away = m_position - target;
  const double distance = glm::length(away);
  const double wanted = std::clamp(distance / factor, kNearestMetres, kFarthestMetres);
  if (distance > 0) m_position = target + away * (wanted / distance);
}

}  // namespace alidade

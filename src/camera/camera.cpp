// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "camera/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace alidade {

namespace {

constexpr double farthestRadius = 1e4;

/// Pixels around the picture's border, `perSide` on each side, corners included.
std::vector<glm::dvec2> borderOf(const Intrinsics& in, int perSide) {
  const double right = in.width - 0.5, bottom = in.height - 0.5;
  std::vector<glm::dvec2> border;
  for (int i = 0; i < perSide; ++i) {
    const double t = static_cast<double>(i) / perSide;
    border.emplace_back(-0.5 + t * in.width, -0.5);
    border.emplace_back(right, -0.5 + t * in.height);
    border.emplace_back(right - t * in.width, bottom);
    border.emplace_back(-0.5, bottom - t * in.height);
  }
  return border;
}

}  // namespace

Camera::Camera(const Intrinsics& intrinsics) : m_intrinsics(intrinsics), m_domain(intrinsics.distortion) {
  m_foldBackRadius = m_domain.foldBackRadius();
  const std::vector<glm::dvec2> border = borderOf(m_intrinsics, 32);
  for (const glm::dvec2& pixel : border) {
    if (const auto ray = unproject(pixel)) {
      m_imageRadius = std::max(m_imageRadius, std::hypot(ray->x, ray->y));
      continue;
    }
    m_imageRadius = std::max(m_imageRadius, farthestSeenTowards(pixel));
  }
  m_imageRadius = std::min(m_imageRadius, m_foldBackRadius);
}

/// How far along the ray towards a border pixel that has no inverse the picture still sees.
double Camera::farthestSeenTowards(const glm::dvec2& pixel) const {
  const glm::dvec2 towards = normalized(pixel);
  const double angle = std::atan2(towards.y, towards.x);
  const double limit = m_domain.limitAlong(angle);
  const double c = std::cos(angle), s = std::sin(angle);
  const double last = std::atan(std::min(limit, farthestRadius));
  constexpr int steps = 64;
  for (int i = steps; i > 0; --i) {
    const double r = std::tan(last * i / steps);
    if (!inPicture(pixelOf(m_domain.distorted(r * c, r * s)))) continue;
    return i == steps ? limit : std::tan(last * (i + 1) / steps);
  }
  return 0;
}

std::optional<glm::dvec2> Camera::project(const glm::dvec3& pInCamera) const {
  if (!(pInCamera.z > 0)) return std::nullopt;
  const double x = pInCamera.x / pInCamera.z, y = pInCamera.y / pInCamera.z;
  if (!m_domain.contains(x, y)) return std::nullopt;
  return pixelOf(m_domain.distorted(x, y));
}

std::optional<glm::dvec2> Camera::project(const glm::dvec3& pInCamera, ProjectionJacobian& jacobian) const {
  if (!(pInCamera.z > 0)) return std::nullopt;
  const double inverse = 1 / pInCamera.z;
  const double x = pInCamera.x / pInCamera.z, y = pInCamera.y / pInCamera.z;
  if (!m_domain.contains(x, y)) return std::nullopt;
  const DistortedPoint at = m_domain.distortedWithJacobian(x, y);
  const auto chained = [&](double focal, double byX, double byY) {
    return focal * inverse * glm::dvec3(byX, byY, -(byX * x + byY * y));
  };
  jacobian.du = chained(m_intrinsics.fx, at.dx.x, at.dy.x);
  jacobian.dv = chained(m_intrinsics.fy, at.dx.y, at.dy.y);
  return pixelOf(at.position);
}

glm::dvec2 Camera::projectUnchecked(const glm::dvec3& pInCamera) const {
  return pixelOf(m_domain.distorted(pInCamera.x / pInCamera.z, pInCamera.y / pInCamera.z));
}

std::optional<glm::dvec3> Camera::unproject(const glm::dvec2& pixel) const {
  const auto p = m_domain.undistorted(normalized(pixel));
  if (!p) return std::nullopt;
  return glm::dvec3(*p, 1);
}

bool Camera::inPicture(const glm::dvec2& pixel) const {
  return pixel.x >= -0.5 && pixel.y >= -0.5 && pixel.x < m_intrinsics.width - 0.5 &&
         pixel.y < m_intrinsics.height - 0.5;
}

bool Camera::sees(double x, double y) const {
  return m_domain.contains(x, y) && inPicture(pixelOf(m_domain.distorted(x, y)));
}

Intrinsics Camera::maskPinhole(int width, int height) const {
  const Camera scaled = scaledTo(width, height);
  Intrinsics pinhole = scaled.intrinsics();
  pinhole.model = CameraModel::Pinhole;
  pinhole.distortion = {};
  // One factor for both axes, so that the mask keeps the picture's aspect. A super-wide lens sees
  // to the horizon: the mask stops at 80 degrees.
  const double widest = std::tan(80 * std::numbers::pi / 180);
  double factor = 1;
  for (const glm::dvec2& pixel : borderOf(m_intrinsics, 512)) {
    const glm::dvec2 d = normalized(pixel);
    const double length = glm::length(d);
    if (!(length > 0)) continue;
    const auto ray = unproject(pixel);
    glm::dvec2 p = ray ? glm::dvec2(*ray) : d * (std::min(m_imageRadius, widest) / length);
    if (const double r = glm::length(p); r > widest) p *= widest / r;
    const auto fit = [&](double focal, double centre, double size, double at) {
      const double room = at > 0 ? size - 0.5 - centre : centre + 0.5;
      if (room > 0 && std::abs(at) * focal > 0) factor = std::min(factor, room / (std::abs(at) * focal));
    };
    fit(pinhole.fx, pinhole.cx, width, p.x);
    fit(pinhole.fy, pinhole.cy, height, p.y);
  }
  pinhole.fx *= factor;
  pinhole.fy *= factor;
  return pinhole;
}

Image<unsigned char> Camera::undistortionMask(int width, int height) const {
  const Intrinsics pinhole = maskPinhole(width, height);
  Image<unsigned char> mask(width, height, 0);
  for (int v = 0; v < height; ++v) {
    unsigned char* row = mask.row(v);
    const double y = (v - pinhole.cy) / pinhole.fy;
    for (int u = 0; u < width; ++u) row[u] = sees((u - pinhole.cx) / pinhole.fx, y) ? 255 : 0;
  }
  return mask;
}

Camera Camera::scaledTo(int width, int height) const {
  Camera scaled = *this;
  Intrinsics& to = scaled.m_intrinsics;
  const double sx = static_cast<double>(width) / to.width, sy = static_cast<double>(height) / to.height;
  to.width = width;
  to.height = height;
  to.fx *= sx;
  to.fy *= sy;
  to.cx = (to.cx + 0.5) * sx - 0.5;
  to.cy = (to.cy + 0.5) * sy - 0.5;
  return scaled;
}

}  // namespace alidade

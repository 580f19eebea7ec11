// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/calibration_start.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace alidade {

namespace {

/// Moves the points' centre to the origin and their mean distance to √2.
std::optional<Eigen::Matrix3d> normalising(const std::vector<glm::dvec2>& points) {
  glm::dvec2 centre(0);
  for (const glm::dvec2& p : points) centre += p / static_cast<double>(points.size());
  double distance = 0;
  for (const glm::dvec2& p : points) distance += glm::length(p - centre) / static_cast<double>(points.size());
  if (!(distance > 0) || !std::isfinite(distance)) return std::nullopt;
  const double s = std::sqrt(2.0) / distance;
  Eigen::Matrix3d t;
  t << s, 0, -s * centre.x, 0, s, -s * centre.y, 0, 0, 1;
  return t;
}

glm::dvec2 through(const Eigen::Matrix3d& h, const glm::dvec2& p) {
  const Eigen::Vector3d q = h * Eigen::Vector3d(p.x, p.y, 1);
  return {q[0] / q[2], q[1] / q[2]};
}

/// A lens of one focal length: the pinhole, or the fisheye that draws angles to scale.
struct PlainLens {
  double focal = 1;
  bool fisheye = false;

  /// On the plane z = 1; nothing where the direction lies too far to the side for that.
  std::optional<glm::dvec2> undistorted(const glm::dvec2& fromCentre) const {
    constexpr double widest = 1.45;
    const glm::dvec2 p = fromCentre / focal;
    if (!fisheye) return p;
    const double theta = glm::length(p);
    if (theta > widest) return std::nullopt;
    return theta < 1e-9 ? p : p * (std::tan(theta) / theta);
  }
  glm::dvec2 project(const glm::dvec3& p) const {
    const glm::dvec2 q(p.x / p.z, p.y / p.z);
    const double r = glm::length(q);
    return focal * (fisheye && r > 1e-9 ? q * (std::atan(r) / r) : q);
  }
};

struct Seen {
  std::vector<glm::dvec2> plane, pixel;  ///< pixels from the picture's middle
};

struct Placed {
  std::optional<RigidTransform> pose;
  double squared = std::numeric_limits<double>::infinity();  ///< mean over its corners, px²
};

Placed place(const Seen& seen, const PlainLens& lens) {
  std::vector<glm::dvec2> plane, image;
  for (std::size_t i = 0; i < seen.plane.size(); ++i)
    if (const auto p = lens.undistorted(seen.pixel[i])) plane.push_back(seen.plane[i]), image.push_back(*p);
  if (2 * plane.size() < seen.plane.size()) return {};
  const auto homography = homographyOf(plane, image);
  const auto pose = homography ? poseOfHomography(*homography, plane.front()) : std::nullopt;
  if (!pose) return {};
  Placed placed{pose, 0};
  for (std::size_t i = 0; i < seen.plane.size(); ++i) {
    const glm::dvec3 p = *pose * glm::dvec3(seen.plane[i], 0);
    if (!(p.z > 0)) return {};
    const glm::dvec2 d = lens.project(p) - seen.pixel[i];
    placed.squared += glm::dot(d, d) / static_cast<double>(seen.plane.size());
  }
  return placed;
}

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<Eigen::Matrix3d> homographyOf(const std::vector<glm::dvec2>& plane, const std::vector<glm::dvec2>& image) {
  if (plane.size() < 4 || plane.size() != image.size()) return std::nullopt;
  const auto t = normalising(plane), u = normalising(image);
  if (!t || !u) return std::nullopt;
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const glm::dvec2 p = through(*t, plane[i]), q = through(*u, image[i]);
    Eigen::Matrix<double, 2, 9> rows;
    rows << p.x, p.y, 1, 0, 0, 0, -q.x * p.x, -q.x * p.y, -q.x, 0, 0, 0, p.x, p.y, 1, -q.y * p.x, -q.y * p.y, -q.y;
    normal += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(normal);
  // A second null direction: the points lie on a line.
  if (!(eigen.eigenvalues()[1] > 1e-12 * eigen.eigenvalues()[8])) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = eigen.eigenvectors().col(0);
  Eigen::Matrix3d m;
  m << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  const Eigen::Matrix3d full = u->inverse() * m * *t;
  return full.allFinite() && std::abs(full.determinant()) > 0 ? std::optional(full) : std::nullopt;
}

std::optional<RigidTransform> poseOfHomography(const Eigen::Matrix3d& h, const glm::dvec2& inFront) {
  const double length = h.col(0).norm() + h.col(1).norm();
  if (!(length > 0)) return std::nullopt;
  const double depth = h(2, 0) * inFront.x + h(2, 1) * inFront.y + h(2, 2);
  const double scale = (depth < 0 ? -2 : 2) / length;
  const Eigen::Vector3d x = scale * h.col(0), y = scale * h.col(1), t = scale * h.col(2), z = x.cross(y);
  const glm::dmat3 rotation(x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]);
  constexpr double anyShape = 1e9;
  const auto nearest = nearestRotation(rotation, anyShape);
  if (!nearest) return std::nullopt;
  return RigidTransform{*nearest, {t[0], t[1], t[2]}};
}

std::optional<double> focalOfHomographies(const std::vector<Eigen::Matrix3d>& pixelFromPlane) {
  // a w = b for w = 1/f².
  double aa = 0, ab = 0;
  for (const Eigen::Matrix3d& h : pixelFromPlane) {
    const Eigen::Matrix3d m = h / std::sqrt(h.col(0).norm() * h.col(1).norm());
    const auto row = [&](double a, double b) { aa += a * a, ab += a * b; };
    row(m(0, 0) * m(0, 1) + m(1, 0) * m(1, 1), -m(2, 0) * m(2, 1));
    row(m(0, 0) * m(0, 0) + m(1, 0) * m(1, 0) - m(0, 1) * m(0, 1) - m(1, 1) * m(1, 1),
        m(2, 1) * m(2, 1) - m(2, 0) * m(2, 0));
  }
  const double w = ab / aa;
  return w > 0 && std::isfinite(w) ? std::optional(1 / std::sqrt(w)) : std::nullopt;
}

std::optional<CalibrationStart> calibrationStart(const std::vector<glm::dvec3>& board, int width, int height,
                                                 const std::vector<BoardPicture>& pictures, bool fisheye) {
  const glm::dvec2 middle(0.5 * (width - 1), 0.5 * (height - 1));
  std::vector<Seen> seen;
  std::vector<Eigen::Matrix3d> homographies;
  for (const BoardPicture& picture : pictures) {
    Seen& s = seen.emplace_back();
    for (const BoardCorner& c : picture.corners) s.plane.emplace_back(board[c.corner]), s.pixel.push_back(c.pixel - middle);
    if (const auto h = homographyOf(s.plane, s.pixel)) homographies.push_back(*h);
  }
  std::vector<double> focals;
  if (const auto zhang = focalOfHomographies(homographies); zhang && !fisheye) focals.push_back(*zhang);
  constexpr double narrowest = 8, widest = 0.15, step = 1.15;
  for (double f = widest * width; f < narrowest * width; f *= step) focals.push_back(f);

  CalibrationStart best;
  double least = std::numeric_limits<double>::infinity();
  for (const double focal : focals) {
    CalibrationStart start{focal, {}};
    std::vector<double> squares;
    for (const Seen& s : seen) {
      const Placed placed = place(s, {focal, fisheye});
      start.cameraFromBoard.push_back(placed.pose);
      squares.push_back(placed.squared);
    }
    const double typical = medianOf(squares);
    // The first is the closed form: a rung of the ladder must be clearly better.
    if (typical < (focal == focals.front() ? 1.0 : 0.9) * least) least = typical, best = std::move(start);
  }
  return std::isfinite(least) ? std::optional(best) : std::nullopt;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "geometry/rigid_transform.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace alidade {

RigidTransform RigidTransform::fromMatrix(const glm::dmat3& rotationMatrix, const glm::dvec3& translation) {
  return {glm::normalize(glm::quat_cast(rotationMatrix)), translation};
}

RigidTransform RigidTransform::cameraLookingAt(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up) {
  const glm::dvec3 forward = glm::normalize(target - eye);
  glm::dvec3 right = glm::cross(forward, up);
  if (glm::length(right) < 1e-9) right = glm::cross(forward, glm::dvec3(0, 1, 0));
  right = glm::normalize(right);
  const glm::dvec3 down = glm::cross(forward, right);
  const glm::dmat3 worldFromCamera(right, down, forward);
  const glm::dmat3 cameraFromWorld = glm::transpose(worldFromCamera);
  return fromMatrix(cameraFromWorld, -(cameraFromWorld * eye));
}

RigidTransform RigidTransform::operator*(const RigidTransform& inner) const {
  return {glm::normalize(rotation * inner.rotation), rotation * inner.translation + translation};
}

RigidTransform RigidTransform::inverse() const {
  const glm::dquat back = glm::conjugate(rotation);
  return {back, -(back * translation)};
}

bool RigidTransform::isFinite() const {
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(translation[i])) return false;
  const double norm = glm::dot(rotation, rotation);
  return std::isfinite(norm) && norm > 0.5 && norm < 2.0;
}

std::optional<glm::dquat> nearestRotation(const glm::dmat3& matrix, double tolerance) {
  const glm::dmat3 deviation = glm::transpose(matrix) * matrix - glm::dmat3(1.0);
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      if (!(std::abs(deviation[c][r]) <= tolerance)) return std::nullopt;
  if (!(glm::determinant(matrix) > 0)) return std::nullopt;
  // The nearest in the sum of squares: U Vᵀ of the singular value decomposition.
  Eigen::Matrix3d m;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) m(r, c) = matrix[c][r];
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  glm::dmat3 rotation;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) rotation[c][r] = nearest(r, c);
  return glm::normalize(glm::quat_cast(rotation));
}

double rotationAngleBetween(const RigidTransform& a, const RigidTransform& b) {
  const glm::dquat between = glm::conjugate(a.rotation) * b.rotation;
  const double sine = std::sqrt(between.x * between.x + between.y * between.y + between.z * between.z);
  return 2.0 * std::atan2(sine, std::abs(between.w));
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace alidade {

/// Rotation then translation, double: `pInA = aFromB * pInB`. Named for the frames it joins:
/// `cameraFromWorld`, `worldFromScanner`.
struct RigidTransform {
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  ///< unit; GLM's order w, x, y, z
  glm::dvec3 translation{0.0};              ///< metres

  static RigidTransform identity() { return {}; }
  /// From a rotation matrix (columns as GLM stores them) and a translation.
  static RigidTransform fromMatrix(const glm::dmat3& rotationMatrix, const glm::dvec3& translation);
  /// A camera that stands at `eye` and looks at `target`; OpenCV axes (x right, y down, z forward).
  static RigidTransform cameraLookingAt(const glm::dvec3& eye, const glm::dvec3& target,
                                        const glm::dvec3& up = {0, 0, 1});

  glm::dvec3 operator*(const glm::dvec3& p) const { return rotation * p + translation; }
  RigidTransform operator*(const RigidTransform& inner) const;
  RigidTransform inverse() const;

  glm::dmat3 rotationMatrix() const { return glm::mat3_cast(rotation); }
  /// Origin of B in A's inverse: for cameraFromWorld, the camera's centre in the world.
  glm::dvec3 centre() const { return inverse().translation; }
  bool isFinite() const;
};

/// The rotation nearest to a matrix that a file calls one; nothing where an entry of RᵀR - I is beyond
/// `tolerance`, or the matrix mirrors or is not finite.
std::optional<glm::dquat> nearestRotation(const glm::dmat3& matrix, double tolerance = 1e-3);

/// Angle in radians between the two attitudes, in [0, pi].
double rotationAngleBetween(const RigidTransform& a, const RigidTransform& b);

}  // namespace alidade

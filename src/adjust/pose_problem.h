// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "adjust/pose_state.h"
#include "adjust/resection.h"

namespace alidade {

using Matrix26 = Eigen::Matrix<double, 2, 6>;

/// Residual of one observation and its derivatives.
struct Linearised {
  glm::dvec2 residualPx{0};  ///< projected - observed
  Matrix26 jacobian;         ///< d(pixel) / d(centre E N H, rotation about the camera's x y z)
};

/// One space resection: who was seen where, what is free, and its linear algebra. The derivatives are
/// analytic: with p = R (X - C), dp/dC = -R and, for R' = exp(w) R, dp/dw = -[p]x. A row of a rolling shutter sees E p, where E,
/// what the camera moved since the middle row, is known from where the observation was made: a constant.
class PoseProblem {
 public:
  PoseProblem(const Camera& camera, const RigidTransform& start,
              const std::vector<ResectionObservation>& observations, const ResectionOptions& options);

  const Camera& camera() const { return m_camera; }
  const std::vector<ResectionObservation>& observations() const { return m_observations; }
  int size() const { return static_cast<int>(m_observations.size()); }

  glm::dvec3 origin() const { return m_origin; }
  PoseState startState() const { return m_start; }
  RigidTransform pose(const PoseState& state) const;
  glm::dvec3 inCamera(const PoseState& state, const glm::dvec3& world) const;
  /// An observed point in the axes of the camera at the row where it was seen.
  glm::dvec3 inCamera(const PoseState& state, int observation) const;

  /// Columns of the 6-vector that may move, and their number.
  const std::vector<int>& freeColumns() const { return m_free; }
  int freeCount() const { return static_cast<int>(m_free.size()); }
  bool positionFree() const;
  bool attitudeFree() const;
  bool allFree() const { return freeCount() == 6; }
  /// The fewest points that fix the free parameters uniquely: half as many, rounded up, and one more
  /// for the whole pose, where three points leave up to four poses.
  int pointsNeeded() const;

  /// Nothing for a point behind the camera.
  std::optional<Linearised> linearise(const PoseState& state, int observation) const;
  /// Inverse covariance of each observation's pixel, the point's own standard deviation carried into the picture at
  /// this state; from the start state until called again.
  void weighAt(const PoseState& state);
  const glm::dmat2& weight(int observation) const { return m_weights[observation]; }
  /// |residual| in standard deviations; infinite behind the camera.
  double sigmas(const PoseState& state, int observation) const;
  /// Sum of squared sigmas over the chosen observations; infinite where one is behind the camera.
  double cost(const PoseState& state, const std::vector<int>& chosen) const;

  /// Jᵀ P J over the chosen observations; locked rows and columns are zero.
  Matrix6 normalMatrix(const PoseState& state, const std::vector<int>& chosen) const;
  /// Inverse over the free parameters, zero elsewhere; nothing where it is singular.
  std::optional<Matrix6> covariance(const Matrix6& normal) const;

  /// Length of the Gauss-Newton step from here in standard deviations, sqrt(gᵀ N⁻¹ g): zero at a minimum,
  /// infinite where the normal equations are singular.
  double decrement(const PoseState& state, const std::vector<int>& chosen) const;

  /// Levenberg-Marquardt, with Huber's loss where `huberSigmas` > 0. Returns where it stood last; `used` counts the
  /// iterations.
  PoseState descend(PoseState state, const std::vector<int>& chosen, int iterations, double huberSigmas = 0,
                    int* used = nullptr) const;

 private:
  /// Normal equations of the free columns and the (robust) sum of squares; infinite cost behind the camera.
  struct Normals {
    Matrix6 matrix = Matrix6::Zero();
    Vector6 gradient = Vector6::Zero();
    double cost = 0;
  };
  struct RowPose {
    glm::dmat3 rotation{1};
    glm::dvec3 translation{0};
  };
  std::optional<Linearised> lineariseAt(const PoseState& state, const glm::dvec3& world, const RowPose* row) const;
  Normals normals(const PoseState& state, const std::vector<int>& chosen, double huberSigmas, bool skipBehind) const;

  const Camera& m_camera;
  const std::vector<ResectionObservation>& m_observations;
  glm::dvec3 m_origin{0};
  PoseState m_start;
  std::vector<int> m_free;
  std::vector<glm::dmat2> m_weights;
  std::vector<RowPose> m_rows;  ///< rowFromMiddle of each observation; empty: one pose for all
};

}  // namespace alidade

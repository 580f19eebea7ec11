// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "adjust/network_state.h"

namespace alidade {

/// One observation as the solver sees it: its kind, the blocks and the point that it depends on.
struct Term {
  ResidualKind kind = ResidualKind::Control;
  int index = -1;  ///< into the network's list of that kind; for a trajectory or smoothness into the lists below
  int frame = -1;
  int point = -1;  ///< of the network; -1: none
  int slot = -1;   ///< of that point, -1: none or known exactly
  std::array<int, 3> blocks{-1, -1, -1};
  bool heldOut = false;
  int row = -1;         ///< into the poses of rows; -1: the frame's own
  bool robust = false;  ///< Huber's loss and the hunt for outliers apply
};

/// A whitened residual with its derivatives.
struct TermValue {
  static constexpr int mostRows = 6;
  int rows = 0;
  std::array<double, mostRows> residual{};
  glm::dvec2 pixels{std::numeric_limits<double>::quiet_NaN()};  ///< unwhitened, where the kind has any
  double metres = std::numeric_limits<double>::quiet_NaN();     ///< unwhitened, of depths and surfaces
  std::array<double, mostRows * 3> byPoint;      ///< row by row
  std::array<std::array<double, mostRows * VaryingCamera::largestCount>, 3> byBlock;  ///< row by row, block.size wide

  double squares() const {
    double sum = 0;
    for (int i = 0; i < rows; ++i) sum += residual[i] * residual[i];
    return sum;
  }
};

/// All terms of a network and their values at a state. Thread-safe once made. The derivatives: with
/// p = R (X - C), dp/dC = -R, dp/dX = R and, for R' = exp([w]×) R, dp/dw = -[p]×. A row of a rolling shutter sees E p, where E, what
/// the camera moved since the middle row, is known from where the observation was made: a constant.
class NetworkTerms {
 public:
  NetworkTerms(const Network& network, const NetworkLayout& layout);

  const Network& network() const { return m_network; }
  const NetworkLayout& layout() const { return m_layout; }
  const std::vector<Term>& terms() const { return m_terms; }

  /// Rotations as matrices, once a state.
  struct Prepared {
    struct View {
      glm::dmat3 bodyFromWorld, cameraFromBody;
      glm::dvec3 centre, translation;
      const VaryingCamera* camera = nullptr;
      bool mounted = false, cameraVaries = false;
      glm::dvec3 inCamera(const glm::dvec3& pointFromOrigin) const;
    };
    std::vector<View> views;  ///< one a frame
  };
  Prepared prepare(const NetworkState& state) const;

  /// False where it has no value: behind the camera. `derivatives`: fills byPoint and byBlock.
  bool evaluate(const NetworkState& state, const Prepared& prepared, const Term& term, bool derivatives,
                TermValue& to) const;
  /// Where a point of the world, relative to the origin, falls in a frame, with derivatives by the frame's blocks and
  /// by the point; unwhitened.
  bool project(const Prepared& prepared, const Term& frameTerm, const glm::dvec3& pointFromOrigin, bool derivatives,
               TermValue& to) const;
  /// A term of that frame's blocks alone.
  Term frameTerm(int frame) const;

 private:
  struct PriorForm {  ///< whitening rows of a prior: inverse Cholesky factor, zero for what is not known
    Matrix6 whitening = Matrix6::Zero();
  };
  struct TrajectoryUse { int trajectory, pose; };
  struct SmoothnessUse { int smoothness, a, b, c; };

  struct RowPose {  ///< rowFromMiddle of a rolling shutter
    glm::dmat3 rotation;
    glm::dvec3 translation;
    glm::dvec3 operator*(const glm::dvec3& p) const { return rotation * p + translation; }
  };

  int rowPose(int frame, const glm::dvec2& pixel);
  void addObservations();
  void addMotion();
  bool edge(const Prepared& prepared, const Term& term, bool derivatives, TermValue& to) const;
  bool depth(const Prepared& prepared, const Term& term, const NetworkState& state, bool derivatives, TermValue& to) const;
  void poseDifference(const PoseState& state, const PoseState& known, const Matrix6& whitening, bool derivatives,
                      TermValue& to) const;
  bool trajectory(const NetworkState& state, const Term& term, bool derivatives, TermValue& to) const;
  void smooth(const NetworkState& state, const Term& term, bool derivatives, TermValue& to) const;

  const Network& m_network;
  const NetworkLayout& m_layout;
  std::vector<Term> m_terms;
  std::vector<RowPose> m_rowPoses;
  std::vector<PriorForm> m_priors;
  std::vector<TrajectoryUse> m_trajectoryUses;
  std::vector<SmoothnessUse> m_smoothnessUses;
};

}  // namespace alidade

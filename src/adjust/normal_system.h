// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "adjust/network_terms.h"
#include "adjust/normal_factor.h"

namespace alidade {

/// Normal equations of a network with its points eliminated (Schur complement).
///
///     | B  W | | x |   | g |        S = B - W P⁻¹ Wᵀ,   S x = g - W P⁻¹ h,   y = P⁻¹ (h - Wᵀ x)
///     | Wᵀ P | | y | = | h |
///
/// B holds one square for every pair of blocks that some term or point joins, P a 3×3 block a point, W the runs of
/// a point against its blocks. S is factored dense where it is small or full, sparse where a long video makes it a
/// band. Work is spread over points: each worker sums into its own copy of S.
class NormalSystem {
 public:
  explicit NormalSystem(const NetworkTerms& terms);

  /// Which terms take part from now on (one flag a term); their structure is laid out anew.
  void use(const std::vector<char>& active);

  /// Linearises all active terms; `huberSigmas` > 0 weighs robust ones down. False where a term has no value.
  bool linearise(const NetworkState& state, double huberSigmas);

  /// Solves with the diagonal raised by the factor 1 + damping. False where the equations are singular.
  bool solve(double damping);
  const Eigen::VectorXd& blockStep() const { return m_step; }
  const std::vector<glm::dvec3>& pointStep() const { return m_pointStep; }
  /// Decrease of the cost that the linear model promises for the last step, and the gradient's part of it.
  double promisedDecrease() const;
  /// sqrt(gᵀ step): the step's length in standard deviations where the damping is nothing.
  double stepInSigmas() const;

  /// Factors without damping, for covariance(). False where something free is left open.
  bool factorUndamped();
  /// What the given sigmas are too small by: covariances are multiplied by its square from now on.
  void useSigmaScale(double scale) { m_sigmaScale = scale; }
  /// Covariance of a few blocks together (rows in the blocks' order; locked rows are zero), after factorUndamped().
  Eigen::MatrixXd covariance(const std::vector<int>& blocks) const;
  /// The free parameter that is worst determined: the largest entry of the null vector, by block and column.
  struct Weakest { int block = -1, column = 0; };
  Weakest weakest() const;
  /// Points whose own 3×3 block is singular.
  std::vector<int> openPoints() const;

 private:
  struct PointRun {  ///< a point's terms and blocks
    int firstTerm = 0, termCount = 0;
    int firstBlock = 0, blockCount = 0;
    std::int64_t firstW = 0;
  };
  struct Sums {  ///< of one worker
    std::vector<double> squares;
    Eigen::VectorXd gradient;
  };

  int pairOffset(int high, int low) const { return m_pairs[static_cast<std::size_t>(high) * m_blockCount + low]; }
  void addPair(int a, int b);
  void layOutPoints(const std::vector<char>& active);
  bool accumulate(const NetworkState& state, const NetworkTerms::Prepared& prepared, const Term& term, double huber,
                  const PointRun* run, Sums& sums);
  void reduce(double damping);
  void eliminate(const PointRun& run, int slot, double damping, Sums& sums);
  bool factor();
  void addDamping(double damping);
  double& diagonal(int block, int column, std::vector<double>& squares) const;

  const NetworkTerms& m_terms;
  int m_blockCount = 0, m_size = 0;
  std::vector<std::int32_t> m_pairs;      ///< offset of a pair's square in a Sums, -1: none; lower triangle
  std::vector<std::array<int, 3>> m_pairList;  ///< high, low, offset
  std::int32_t m_squareCount = 0;

  std::vector<int> m_termOrder;           ///< active terms, those of a point together, pointless ones last
  std::size_t m_pointlessFrom = 0;
  std::vector<PointRun> m_runs;           ///< one a slot
  std::vector<int> m_runBlocks;           ///< block indices of all runs
  std::vector<double> m_w, m_p;           ///< Wᵀ: three rows of block.size a run block; P: 9 a slot
  std::vector<glm::dvec3> m_h;

  Sums m_base;                            ///< B and g
  std::vector<Sums> m_worker;
  Sums m_reduced;
  double m_damping = 0;
  double m_sigmaScale = 1;
  NormalFactor m_factor;
  Eigen::VectorXd m_step;
  std::vector<glm::dvec3> m_pointStep;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

#include "adjust/network_state.h"

namespace alidade {

/// Cholesky factor of the reduced normal matrix, scaled to a unit diagonal first: metres, radians and pixels differ
/// by orders of magnitude. Dense, or sparse (approximate minimum degree) where a large matrix is mostly empty.
class NormalFactor {
 public:
  /// `pairs`: high block, low block, offset of their square in `squares`. False where it is not positive definite.
  bool compute(const NetworkLayout& layout, const std::vector<std::array<int, 3>>& pairs,
               const std::vector<double>& squares, int size);

  template <class Matrix>
  Matrix solve(const Matrix& right) const {
    const Matrix scaled = m_scale.asDiagonal() * right;
    const Matrix x = m_sparse ? Matrix(m_sparseFactor.solve(scaled)) : Matrix(m_denseFactor.solve(scaled));
    return m_scale.asDiagonal() * x;
  }
  /// Of the scaled matrix: what is left of a unit diagonal once all before it are known, at the worst row.
  double smallestPivot() const { return m_smallestPivot; }
  /// Largest entry of the vector that the matrix shrinks most, by inverse iteration.
  int weakestRow() const;

 private:
  bool m_sparse = false;
  Eigen::VectorXd m_scale;
  Eigen::LLT<Eigen::MatrixXd> m_denseFactor;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> m_sparseFactor;
  double m_smallestPivot = 0;
  int m_worstRow = -1;
  std::size_t m_patternPairs = 0;
};

}  // namespace alidade

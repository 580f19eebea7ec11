// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/normal_factor.h"

#include <cmath>

namespace alidade {

namespace {

constexpr int alwaysDenseBelow = 900;

}  // namespace

bool NormalFactor::compute(const NetworkLayout& layout, const std::vector<std::array<int, 3>>& pairs,
                           const std::vector<double>& squares, int size) {
  m_scale.resize(size);
  m_smallestPivot = 0;
  for (const auto& [high, low, offset] : pairs) {
    if (high != low) continue;
    const ParameterBlock& block = layout.blocks[high];
    for (int c = 0; c < block.size; ++c) {
      const double d = squares[offset + c * (block.size + 1)];
      if (!(d > 0) || !std::isfinite(d)) return m_worstRow = block.offset + c, false;
      m_scale[block.offset + c] = 1 / std::sqrt(d);
    }
  }
  const auto each = [&](auto&& put) {
    for (const auto& [high, low, offset] : pairs) {
      const ParameterBlock &h = layout.blocks[high], &l = layout.blocks[low];
      for (int r = 0; r < h.size; ++r)
        for (int c = 0; c < (high == low ? r + 1 : l.size); ++c)
          put(h.offset + r, l.offset + c, squares[offset + r * l.size + c] * m_scale[h.offset + r] * m_scale[l.offset + c]);
    }
  };
  m_sparse = size > alwaysDenseBelow &&
             static_cast<double>(squares.size()) < 0.1 * static_cast<double>(size) * static_cast<double>(size);
  Eigen::VectorXd pivots;
  bool good = false;
  if (m_sparse) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(squares.size());
    each([&](int r, int c, double value) { entries.emplace_back(r, c, value); });
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (m_patternPairs != pairs.size()) m_sparseFactor.analyzePattern(matrix);
    m_patternPairs = pairs.size();
    m_sparseFactor.factorize(matrix);
    good = m_sparseFactor.info() == Eigen::Success;
    if (good) {
      const Eigen::SparseMatrix<double> factor = m_sparseFactor.matrixL();
      const Eigen::VectorXd diagonal = factor.diagonal();
      pivots = (m_sparseFactor.permutationPinv() * diagonal).cwiseAbs2();
    }
  } else {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
    each([&](int r, int c, double value) { matrix(r, c) = value; });
    m_denseFactor.compute(matrix);
    good = m_denseFactor.info() == Eigen::Success;
    if (good) pivots = m_denseFactor.matrixLLT().diagonal().cwiseAbs2();
  }
  if (good) m_smallestPivot = pivots.minCoeff(&m_worstRow);
  return good;
}

int NormalFactor::weakestRow() const {
  if (!(m_smallestPivot > 0)) return m_worstRow;
  Eigen::VectorXd v = Eigen::VectorXd::Ones(m_scale.size());
  for (int i = 0; i < 5; ++i) {
    const Eigen::VectorXd next = m_sparse ? Eigen::VectorXd(m_sparseFactor.solve(v)) : Eigen::VectorXd(m_denseFactor.solve(v));
    if (!next.allFinite() || !(next.norm() > 0)) return m_worstRow;
    v = next.normalized();
  }
  int row = 0;
  v.cwiseAbs().maxCoeff(&row);
  return row;
}

}  // namespace alidade

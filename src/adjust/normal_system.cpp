// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/normal_system.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <Eigen/LU>

#include "adjust/schur_kernel.h"
#include "base/parallel.h"

namespace alidade {

namespace {

constexpr std::size_t pointGrain = 64;

/// Inverse of a symmetric 3×3 block scaled to a unit diagonal; false where it is singular.
bool inverted(const double* m, double damping, Eigen::Matrix3d& inverse) {
  Eigen::Vector3d scale;
  for (int i = 0; i < 3; ++i) {
    if (!(m[4 * i] > 0)) return false;
    scale[i] = 1 / std::sqrt(m[4 * i]);
  }
  Eigen::Matrix3d a;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) a(r, c) = m[3 * r + c] * scale[r] * scale[c];
  for (int i = 0; i < 3; ++i) a(i, i) = 1 + damping;
  const double determinant = a.determinant();
  if (!(determinant > 1e-14)) return false;
  inverse = scale.asDiagonal() * a.inverse() * scale.asDiagonal();
  return true;
}

}  // namespace

NormalSystem::NormalSystem(const NetworkTerms& terms)
    : m_terms(terms),
      m_blockCount(static_cast<int>(terms.layout().blocks.size())),
      m_size(terms.layout().unknowns),
      m_worker(workerCount()) {}

void NormalSystem::addPair(int a, int b) {
  const auto [low, high] = std::minmax(a, b);
  std::int32_t& offset = m_pairs[static_cast<std::size_t>(high) * m_blockCount + low];
  if (offset >= 0) return;
  const auto& blocks = m_terms.layout().blocks;
  offset = m_squareCount;
  m_squareCount += blocks[high].size * blocks[low].size;
  m_pairList.push_back({high, low, offset});
}

void NormalSystem::use(const std::vector<char>& active) {
  m_pairs.assign(static_cast<std::size_t>(m_blockCount) * m_blockCount, -1);
  m_pairList.clear();
  m_squareCount = 0;
  for (int b = 0; b < m_blockCount; ++b) addPair(b, b);
  layOutPoints(active);
  for (const int t : m_termOrder) {
    const Term& term = m_terms.terms()[t];
    for (const int a : term.blocks)
      for (const int b : term.blocks)
        if (a >= 0 && b >= 0) addPair(a, b);
  }
  for (const PointRun& run : m_runs)
    for (int i = 0; i < run.blockCount; ++i)
      for (int j = 0; j <= i; ++j) addPair(m_runBlocks[run.firstBlock + i], m_runBlocks[run.firstBlock + j]);
  for (Sums* sums : {&m_base, &m_reduced}) {
    sums->squares.assign(m_squareCount, 0);
    sums->gradient.setZero(m_size);
  }
  for (Sums& sums : m_worker) {
    sums.squares.assign(m_squareCount, 0);
    sums.gradient.setZero(m_size);
  }
}

void NormalSystem::layOutPoints(const std::vector<char>& active) {
  const auto& layout = m_terms.layout();
  const auto& terms = m_terms.terms();
  m_termOrder.clear();
  for (std::size_t t = 0; t < terms.size(); ++t)
    if (active[t]) m_termOrder.push_back(static_cast<int>(t));
  const int none = static_cast<int>(layout.slotPoint.size());
  const auto slotOf = [&](int t) { return terms[t].slot < 0 ? none : terms[t].slot; };
  std::stable_sort(m_termOrder.begin(), m_termOrder.end(), [&](int a, int b) { return slotOf(a) < slotOf(b); });
  m_runs.assign(layout.slotPoint.size(), {});
  m_runBlocks.clear();
  std::int64_t w = 0;
  std::size_t at = 0;
  std::vector<int> blocks;
  for (int slot = 0; slot < none; ++slot) {
    PointRun& run = m_runs[slot];
    run.firstTerm = static_cast<int>(at);
    blocks.clear();
    for (; at < m_termOrder.size() && slotOf(m_termOrder[at]) == slot; ++at)
      for (const int b : terms[m_termOrder[at]].blocks)
        if (b >= 0) blocks.push_back(b);
    run.termCount = static_cast<int>(at) - run.firstTerm;
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    run.firstBlock = static_cast<int>(m_runBlocks.size());
    run.blockCount = static_cast<int>(blocks.size());
    run.firstW = w;
    for (const int b : blocks) w += 3 * layout.blocks[b].size;
    m_runBlocks.insert(m_runBlocks.end(), blocks.begin(), blocks.end());
  }
  m_pointlessFrom = at;
  m_w.assign(static_cast<std::size_t>(w), 0);
  m_p.assign(9 * m_runs.size(), 0);
  m_h.assign(m_runs.size(), glm::dvec3(0));
  m_pointStep.assign(m_runs.size(), glm::dvec3(0));
}

bool NormalSystem::accumulate(const NetworkState& state, const NetworkTerms::Prepared& prepared, const Term& term,
                              double huber, const PointRun* run, Sums& sums) {
  const auto& blocks = m_terms.layout().blocks;
  TermValue value;
  if (!m_terms.evaluate(state, prepared, term, true, value)) return false;
  double weight = 1;
  if (huber > 0 && term.robust)
    if (const double s = std::sqrt(value.squares()); s > huber) weight = huber / s;
  for (int b = 0; b < 3; ++b) {
    if (term.blocks[b] < 0) continue;
    const ParameterBlock& block = blocks[term.blocks[b]];
    for (int c = 0; c < block.size; ++c)
      if (block.locked[c])
        for (int r = 0; r < value.rows; ++r) value.byBlock[b][r * block.size + c] = 0;
  }
  for (int b = 0; b < 3; ++b) {
    const int high = term.blocks[b];
    if (high < 0) continue;
    const int n = blocks[high].size;
    const double* jb = value.byBlock[b].data();
    double* gradient = sums.gradient.data() + blocks[high].offset;
    for (int r = 0; r < value.rows; ++r)
      for (int c = 0; c < n; ++c) gradient[c] -= weight * jb[r * n + c] * value.residual[r];
    for (int a = 0; a < 3; ++a) {
      const int low = term.blocks[a];
      if (low < 0 || low > high) continue;
      const int m = blocks[low].size;
      const double* ja = value.byBlock[a].data();
      double* square = sums.squares.data() + pairOffset(high, low);
      for (int r = 0; r < value.rows; ++r)
        for (int i = 0; i < n; ++i) {
          const double left = weight * jb[r * n + i];
          for (int j = 0; j < m; ++j) square[i * m + j] += left * ja[r * m + j];
        }
    }
    if (!run) continue;
    double* w = m_w.data() + run->firstW;
    for (const int* at = m_runBlocks.data() + run->firstBlock; *at != high; ++at) w += 3 * blocks[*at].size;
    for (int r = 0; r < value.rows; ++r)
      for (int k = 0; k < 3; ++k) {
        const double left = weight * value.byPoint[3 * r + k];
        for (int c = 0; c < n; ++c) w[k * n + c] += left * jb[r * n + c];
      }
  }
  if (run) {
    double* p = m_p.data() + 9 * term.slot;
    glm::dvec3& h = m_h[term.slot];
    for (int r = 0; r < value.rows; ++r) {
      const double* j = value.byPoint.data() + 3 * r;
      for (int k = 0; k < 3; ++k) {
        h[k] -= weight * j[k] * value.residual[r];
        for (int l = 0; l < 3; ++l) p[3 * k + l] += weight * j[k] * j[l];
      }
    }
  }
  return true;
}

bool NormalSystem::linearise(const NetworkState& state, double huberSigmas) {
  const NetworkTerms::Prepared prepared = m_terms.prepare(state);
  std::fill(m_w.begin(), m_w.end(), 0);
  std::fill(m_p.begin(), m_p.end(), 0);
  std::fill(m_h.begin(), m_h.end(), glm::dvec3(0));
  for (Sums& sums : m_worker) {
    std::fill(sums.squares.begin(), sums.squares.end(), 0);
    sums.gradient.setZero();
  }
  std::atomic<bool> good{true};
  const auto& terms = m_terms.terms();
  parallelFor(m_runs.size(), pointGrain, [&](std::size_t first, std::size_t last, int worker) {
    for (std::size_t slot = first; slot < last; ++slot)
      for (int i = 0; i < m_runs[slot].termCount; ++i)
        if (!accumulate(state, prepared, terms[m_termOrder[m_runs[slot].firstTerm + i]], huberSigmas, &m_runs[slot],
                        m_worker[worker]))
          good = false;
  });
  parallelFor(m_termOrder.size() - m_pointlessFrom, 256, [&](std::size_t first, std::size_t last, int worker) {
    for (std::size_t i = first; i < last; ++i)
      if (!accumulate(state, prepared, terms[m_termOrder[m_pointlessFrom + i]], huberSigmas, nullptr, m_worker[worker]))
        good = false;
  });
  std::fill(m_base.squares.begin(), m_base.squares.end(), 0);
  m_base.gradient.setZero();
  for (const Sums& sums : m_worker) {
    for (std::size_t i = 0; i < sums.squares.size(); ++i) m_base.squares[i] += sums.squares[i];
    m_base.gradient += sums.gradient;
  }
  return good;
}

double& NormalSystem::diagonal(int block, int column, std::vector<double>& squares) const {
  return squares[pairOffset(block, block) + column * (m_terms.layout().blocks[block].size + 1)];
}

/// Y = W P⁻¹, then S -= Y Wᵀ and g -= Y h, for all blocks of one point.
void NormalSystem::eliminate(const PointRun& run, int slot, double damping, Sums& sums) {
  Eigen::Matrix3d inverse;
  if (run.termCount == 0 || !inverted(m_p.data() + 9 * slot, damping, inverse)) return;
  const auto& blocks = m_terms.layout().blocks;
  const double* w = m_w.data() + run.firstW;
  const glm::dvec3& h = m_h[slot];
  double y[3 * VaryingCamera::largestCount];
  const double* wHigh = w;
  for (int i = 0; i < run.blockCount; ++i) {
    const int high = m_runBlocks[run.firstBlock + i], n = blocks[high].size;
    for (int k = 0; k < 3; ++k)
      for (int c = 0; c < n; ++c)
        y[k * n + c] = inverse(k, 0) * wHigh[c] + inverse(k, 1) * wHigh[n + c] + inverse(k, 2) * wHigh[2 * n + c];
    double* gradient = sums.gradient.data() + blocks[high].offset;
    for (int c = 0; c < n; ++c) gradient[c] -= y[c] * h.x + y[n + c] * h.y + y[2 * n + c] * h.z;
    const double* wLow = w;
    for (int j = 0; j <= i; ++j) {
      const int low = m_runBlocks[run.firstBlock + j], m = blocks[low].size;
      subtractOuter(y, n, wLow, m, sums.squares.data() + pairOffset(high, low));
      wLow += 3 * m;
    }
    wHigh += 3 * n;
  }
}

void NormalSystem::reduce(double damping) {
  for (Sums& sums : m_worker) {
    std::fill(sums.squares.begin(), sums.squares.end(), 0);
    sums.gradient.setZero();
  }
  parallelFor(m_runs.size(), pointGrain, [&](std::size_t first, std::size_t last, int worker) {
    for (std::size_t slot = first; slot < last; ++slot)
      eliminate(m_runs[slot], static_cast<int>(slot), damping, m_worker[worker]);
  });
  m_reduced = m_base;
  addDamping(damping);
  for (const Sums& sums : m_worker) {
    for (std::size_t i = 0; i < sums.squares.size(); ++i) m_reduced.squares[i] += sums.squares[i];
    m_reduced.gradient += sums.gradient;
  }
}

void NormalSystem::addDamping(double damping) {
  const auto& blocks = m_terms.layout().blocks;
  for (int b = 0; b < m_blockCount; ++b)
    for (int c = 0; c < blocks[b].size; ++c) {
      double& d = diagonal(b, c, m_reduced.squares);
      d = blocks[b].locked[c] ? 1 : d * (1 + damping);
    }
}

bool NormalSystem::factor() {
  return m_factor.compute(m_terms.layout(), m_pairList, m_reduced.squares, m_size);
}

bool NormalSystem::solve(double damping) {
  m_damping = damping;
  reduce(damping);
  if (!factor()) return false;
  m_step = m_factor.solve(m_reduced.gradient);
  if (!m_step.allFinite()) return false;
  const auto& blocks = m_terms.layout().blocks;
  parallelFor(m_runs.size(), 4 * pointGrain, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t slot = first; slot < last; ++slot) {
      const PointRun& run = m_runs[slot];
      m_pointStep[slot] = glm::dvec3(0);
      Eigen::Matrix3d inverse;
      if (run.termCount == 0 || !inverted(m_p.data() + 9 * slot, damping, inverse)) continue;
      Eigen::Vector3d right(m_h[slot].x, m_h[slot].y, m_h[slot].z);
      const double* w = m_w.data() + run.firstW;
      for (int i = 0; i < run.blockCount; ++i) {
        const ParameterBlock& block = blocks[m_runBlocks[run.firstBlock + i]];
        for (int k = 0; k < 3; ++k)
          for (int c = 0; c < block.size; ++c) right[k] -= w[k * block.size + c] * m_step[block.offset + c];
        w += 3 * block.size;
      }
      const Eigen::Vector3d step = inverse * right;
      m_pointStep[slot] = {step[0], step[1], step[2]};
    }
  });
  return true;
}

double NormalSystem::stepInSigmas() const {
  double slope = m_base.gradient.dot(m_step);
  for (std::size_t i = 0; i < m_h.size(); ++i) slope += glm::dot(m_h[i], m_pointStep[i]);
  return std::sqrt(std::max(0.0, slope));
}

/// With (N + D) x = g: ½ xᵀ(g + D x).
double NormalSystem::promisedDecrease() const {
  const auto& blocks = m_terms.layout().blocks;
  double twice = m_base.gradient.dot(m_step);
  for (int b = 0; b < m_blockCount; ++b)
    for (int c = 0; c < blocks[b].size; ++c) {
      const double x = m_step[blocks[b].offset + c];
      twice += m_damping * m_base.squares[pairOffset(b, b) + c * (blocks[b].size + 1)] * x * x;
    }
  for (std::size_t i = 0; i < m_h.size(); ++i) {
    twice += glm::dot(m_h[i], m_pointStep[i]);
    for (int k = 0; k < 3; ++k) twice += m_damping * m_p[9 * i + 4 * k] * m_pointStep[i][k] * m_pointStep[i][k];
  }
  return 0.5 * twice;
}

bool NormalSystem::factorUndamped() {
  reduce(0);
  return factor() && m_factor.smallestPivot() > 1e-11;
}

Eigen::MatrixXd NormalSystem::covariance(const std::vector<int>& wanted) const {
  const auto& blocks = m_terms.layout().blocks;
  int n = 0;
  for (const int b : wanted) n += blocks[b].size;
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(m_size, n), result(n, n);
  int at = 0;
  for (const int b : wanted)
    for (int c = 0; c < blocks[b].size; ++c, ++at) unit(blocks[b].offset + c, at) = blocks[b].locked[c] ? 0 : 1;
  const Eigen::MatrixXd columns = m_factor.solve(unit);
  at = 0;
  for (const int b : wanted)
    for (int c = 0; c < blocks[b].size; ++c, ++at) result.row(at) = columns.row(blocks[b].offset + c);
  return 0.5 * m_sigmaScale * m_sigmaScale * (result + result.transpose());
}

NormalSystem::Weakest NormalSystem::weakest() const {
  const int row = m_factor.weakestRow();
  const auto& blocks = m_terms.layout().blocks;
  for (int b = 0; b < m_blockCount; ++b)
    if (row >= blocks[b].offset && row < blocks[b].offset + blocks[b].size) return {b, row - blocks[b].offset};
  return {};
}

std::vector<int> NormalSystem::openPoints() const {
  std::vector<int> open;
  Eigen::Matrix3d inverse;
  for (std::size_t slot = 0; slot < m_runs.size(); ++slot)
    if (m_runs[slot].termCount > 0 && !inverted(m_p.data() + 9 * slot, 0, inverse))
      open.push_back(m_terms.layout().slotPoint[slot]);
  return open;
}

}  // namespace alidade

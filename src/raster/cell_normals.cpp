// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/cell_normals.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <Eigen/Eigenvalues>

namespace alidade {

namespace {

/// Some 64 to 100 cells hold surface, so that each gets about 40 of them.
constexpr std::size_t kSample = 4096;
constexpr int kFewest = 6;
/// A plane's points leave it by less than this part of their narrower spread (rms), and lie on no line.
constexpr float kThickest = 0.2f;
constexpr float kNarrowest = 0.15f;

/// Sums over the points of a cell, about its corner.
struct CellSums {
  float n = 0, x = 0, y = 0, z = 0, xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  void add(float px, float py, float pz) {
    n += 1;
    x += px, y += py, z += pz;
    xx += px * px, yy += py * py, zz += pz * pz;
    xy += px * py, xz += px * pz, yz += py * pz;
  }
};

glm::dvec3 normalOf(const CellSums& s) {
  if (s.n < kFewest) return glm::dvec3(0);
  const Eigen::Vector3f mean = Eigen::Vector3f(s.x, s.y, s.z) / s.n;
  Eigen::Matrix3f spread;
  spread << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  spread = spread / s.n - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(spread);
  const Eigen::Vector3f& variance = solver.eigenvalues();
  const bool isPlane = variance[0] <= kThickest * kThickest * variance[1] &&
                       variance[1] >= kNarrowest * kNarrowest * variance[2];
  if (!isPlane) return glm::dvec3(0);
  const Eigen::Vector3f normal = solver.eigenvectors().col(0);
  return {normal.x(), normal.y(), normal.z()};
}

}  // namespace

CellNormals cellNormals(std::span<const DisplayPoint> points, const glm::dmat3& cameraFromWorld) {
  CellNormals cells;
  const auto sample = points.first(std::min(points.size(), kSample));
  if (sample.empty()) return cells;
  glm::ivec3 low(65535), high(0);
  for (const DisplayPoint& p : sample) {
    low = glm::min(low, glm::ivec3(p.x, p.y, p.z));
    high = glm::max(high, glm::ivec3(p.x, p.y, p.z));
  }
  const glm::ivec3 edge = high - low;
  while (std::max({edge.x, edge.y, edge.z}) >> cells.shift >= CellNormals::kPerEdge) ++cells.shift;
  cells.low = {low.x, low.y, low.z};

  std::vector<CellSums> sums(cells.normal.size());
  const float cell = static_cast<float>(1 << cells.shift);
  for (const DisplayPoint& p : sample) {
    const glm::ivec3 at = glm::ivec3(p.x, p.y, p.z) - low;
    const glm::ivec3 c = at >> cells.shift;
    const glm::vec3 within = glm::vec3(at - (c << cells.shift)) / cell;
    sums[c.x + CellNormals::kPerEdge * (c.y + CellNormals::kPerEdge * c.z)].add(within.x, within.y, within.z);
  }
  for (std::size_t i = 0; i < sums.size(); ++i)
    cells.normal[i] = glm::vec3(cameraFromWorld * normalOf(sums[i]));
  return cells;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/cell_normals.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

namespace alidade {

namespace {

/// Some 64 to 100 cells hold surface, so that each gets about 20 of them.
constexpr std::size_t kSample = 2048;
constexpr float kFewest = 6;
/// A plane's points leave it by less than this part of their narrower spread (rms), and lie on no line.
constexpr float kThickest = 0.2f;
constexpr float kNarrowest = 0.15f;
/// Against estimates from few points.
constexpr float kClosest = 1.0f, kWidest = 2.5f;

typedef float Four __attribute__((vector_size(16)));
typedef std::int32_t FourInts __attribute__((vector_size(16)));

/// Sums over the points of a cell, about its corner.
struct CellSums {
  Four place{};    ///< x, y, z, 1
  Four squares{};  ///< xx, yy, zz, -
  Four mixed{};    ///< xy, yz, zx, -

  void add(const Four& p) {
    place += p;
    squares += p * p;
    mixed += p * __builtin_shufflevector(p, p, 1, 2, 0, 3);
  }
  float count() const { return place[3]; }
};

struct CellPlane {
  glm::dvec3 normal{0};
  float area = 0;  ///< of a rectangle that spreads as the points do, cells²
};

CellPlane planeOf(const CellSums& s) {
  if (s.count() < kFewest) return {};
  const Eigen::Vector3f mean = Eigen::Vector3f(s.place[0], s.place[1], s.place[2]) / s.count();
  Eigen::Matrix3f spread;
  spread << s.squares[0], s.mixed[0], s.mixed[2], s.mixed[0], s.squares[1], s.mixed[1], s.mixed[2], s.mixed[1], s.squares[2];
  spread = spread / s.count() - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(spread);
  const Eigen::Vector3f& variance = solver.eigenvalues();
  const bool isPlane = variance[0] <= kThickest * kThickest * variance[1] &&
                       variance[1] >= kNarrowest * kNarrowest * variance[2];
  if (!isPlane) return {};
  const Eigen::Vector3f normal = solver.eigenvectors().col(0);
  return {{normal.x(), normal.y(), normal.z()}, 12.0f * std::sqrt(variance[1] * variance[2])};
}

/// Cells of a few points, and those that an edge of two surfaces runs through, have no plane to tell how far apart their points
/// are: that is taken from the cells around them.
void spreadWidening(CellNormals& cells, const std::vector<CellSums>& sums) {
  constexpr int n = CellNormals::kPerEdge;
  const auto hasPlane = [&](int i) { return cells.normal[static_cast<std::size_t>(i)] != glm::vec4(0, 0, 0, 1); };
  std::vector<std::pair<int, float>> found;
  for (int i = 0; i < n * n * n; ++i) {
    if (sums[static_cast<std::size_t>(i)].count() == 0 || hasPlane(i)) continue;
    const glm::ivec3 c(i % n, i / n % n, i / (n * n));
    const glm::ivec3 first = glm::max(c - 1, glm::ivec3(0)), last = glm::min(c + 1, glm::ivec3(n - 1));
    float sum = 0, count = 0;
    for (int z = first.z; z <= last.z; ++z)
      for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x)
          if (const int j = x + n * (y + n * z); hasPlane(j)) sum += cells.normal[static_cast<std::size_t>(j)].w, count += 1;
    if (count > 0) found.emplace_back(i, sum / count);
  }
  for (const auto& [i, widening] : found) cells.normal[static_cast<std::size_t>(i)].w = widening;
}

}  // namespace

CellNormals cellNormals(std::span<const DisplayPoint> points, double spacing, const glm::dmat3& cameraFromWorld) {
  CellNormals cells;
  cells.normal.fill({0, 0, 0, 1});
  if (points.empty()) return cells;
  // Evenly over all levels: a prefix would be as dense everywhere.
  const std::size_t stride = (points.size() + kSample - 1) / kSample;
  std::vector<FourInts> sample;
  sample.reserve(kSample);
  FourInts low = FourInts{} + 65535, high{};
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const FourInts p{points[i].x, points[i].y, points[i].z, 0};
    low = p < low ? p : low;
    high = p > high ? p : high;
    sample.push_back(p);
  }
  const FourInts edge = high - low;
  while (std::max({edge[0], edge[1], edge[2]}) >> cells.shift >= CellNormals::kPerEdge) ++cells.shift;
  cells.low = {low[0], low[1], low[2]};

  std::vector<CellSums> sums(cells.normal.size());
  const float cell = static_cast<float>(1 << cells.shift), perCell = 1.0f / cell;
  for (const FourInts& p : sample) {
    const FourInts at = p - low, c = at >> cells.shift;
    Four within = __builtin_convertvector(at - (c << cells.shift), Four) * perCell;
    within[3] = 1.0f;
    sums[static_cast<std::size_t>(c[0] + CellNormals::kPerEdge * (c[1] + CellNormals::kPerEdge * c[2]))].add(within);
  }
  const auto sampledSpacing = static_cast<float>(spacing / cell * std::sqrt(static_cast<double>(stride)));
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const CellPlane plane = planeOf(sums[i]);
    if (plane.area == 0) continue;
    const float apart = sampledSpacing > 0 ? std::sqrt(plane.area / sums[i].count()) / sampledSpacing : 1.0f;
    cells.normal[i] = glm::vec4(glm::vec3(cameraFromWorld * plane.normal), std::clamp(apart, kClosest, kWidest));
  }
  spreadWidening(cells, sums);
  return cells;
}

}  // namespace alidade

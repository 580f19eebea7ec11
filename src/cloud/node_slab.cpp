// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/node_slab.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Eigenvalues>

namespace alidade {

namespace {

constexpr std::size_t kFewest = 16;

}  // namespace

NodeSlab slabOf(std::span<const glm::vec3> places) {
  if (places.size() < kFewest) return {};
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const glm::vec3& p : places) mean += Eigen::Vector3d(p.x, p.y, p.z);
  mean /= static_cast<double>(places.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const glm::vec3& p : places) {
    const Eigen::Vector3d apart = Eigen::Vector3d(p.x, p.y, p.z) - mean;
    spread += apart * apart.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread / static_cast<double>(places.size()));
  const double least = std::sqrt(std::max(0.0, axes.eigenvalues()[0])), middle = std::sqrt(std::max(0.0, axes.eigenvalues()[1]));
  const Eigen::Vector3d normal = axes.eigenvectors().col(0);
  NodeSlab slab;
  slab.normal = glm::vec3(normal.x(), normal.y(), normal.z());
  slab.along = static_cast<float>(normal.dot(mean));
  slab.thickness = static_cast<float>(4.0 * least);
  const double breadth = std::sqrt(12.0) * middle;  // of an even spread
  slab.roughness = slab.thickness < breadth ? static_cast<float>(slab.thickness / breadth) : 1.0f;
  slab.area = static_cast<float>(12.0 * middle * std::sqrt(std::max(0.0, axes.eigenvalues()[2])));
  return slab;
}

void openUp(NodeSlab& slab, double covered) {
  const double open = slab.area > 0 ? 1.0 - std::min(covered / slab.area, 1.0) : 1.0;
  slab.roughness = std::max(slab.roughness, static_cast<float>(open));
}

double facingOf(const NodeSlab& slab, const glm::dvec3& eye, double distance) {
  const double height = std::abs(glm::dot(glm::dvec3(slab.normal), eye) - slab.along) + 0.5 * slab.thickness;
  const double facing = height / distance + slab.roughness;
  return facing < 1.0 ? std::max(facing, kLeastFacing) : 1.0;  // 1 where the eye lies in the node, too
}

}  // namespace alidade

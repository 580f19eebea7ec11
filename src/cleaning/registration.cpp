// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cleaning/registration.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <pcl/kdtree/kdtree_flann.h>

#include "cleaning/cleaning.h"
#include "cleaning/tile_search.h"
#include "geometry/bounds.h"

namespace alidade {

namespace {

constexpr std::size_t kFewestPoints = 100;
constexpr double kStepMeters = 1e-5;  // a step that moves no point further ends the search
// The weakest of the six directions against the strongest: below, a surface slides on itself within its noise.
constexpr double kWeakest = 1e-4;

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Points first, first + step, … so that about `most` are left; local to `origin`.
std::vector<glm::dvec3> thinned(std::span<const glm::dvec3> points, std::size_t most, const glm::dvec3& origin) {
  const std::size_t step = std::max<std::size_t>(1, points.size() / std::max<std::size_t>(most, 1));
  std::vector<glm::dvec3> some;
  for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i] - origin);
  return some;
}

struct Fixed {
  std::vector<glm::dvec3> points;
  std::vector<glm::vec3> normals;
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
};

/// The normal equations of one step, and the residuals before it.
struct Equations {
  Matrix6 normal = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  double planeSquares = 0, pointSquares = 0;
  std::size_t pairs = 0;
};

/// Pairs within `reach`. Parameters: a small rotation about `middle`, scaled to metres at `radius`, and a shift.
Equations equationsOf(const std::vector<glm::dvec3>& moving, const Fixed& fixed, const RigidTransform& transform, const glm::dvec3& middle,
                      double radius, double reach) {
  Equations equations;
  pcl::Indices found(1);
  std::vector<float> squared(1);
  for (const glm::dvec3& point : moving) {
    const glm::dvec3 p = transform * point;
    const pcl::PointXYZ query(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z));
    if (fixed.tree.nearestKSearch(query, 1, found, squared) < 1 || static_cast<double>(squared[0]) > reach * reach) continue;
    const auto partner = static_cast<std::size_t>(found[0]);
    const glm::dvec3 n(fixed.normals[partner]), gap = fixed.points[partner] - p;
    const double residual = glm::dot(n, gap);
    const glm::dvec3 turn = glm::cross(p - middle, n) / radius;
    Vector6 row;
    row << turn.x, turn.y, turn.z, n.x, n.y, n.z;
    equations.normal.noalias() += row * row.transpose();
    equations.right += row * residual;
    equations.planeSquares += residual * residual;
    equations.pointSquares += glm::dot(gap, gap);
    ++equations.pairs;
  }
  return equations;
}

RigidTransform stepOf(const Vector6& x, const glm::dvec3& middle, double radius) {
  const glm::dvec3 turn = glm::dvec3(x[0], x[1], x[2]) / radius, shift(x[3], x[4], x[5]);
  const double angle = glm::length(turn);
  RigidTransform step;
  if (angle > 0) step.rotation = glm::angleAxis(angle, turn / angle);
  step.translation = middle + shift - step.rotation * middle;
  return step;
}

Result<void> checkOptions(const RegistrationOptions& options) {
  if (options.reachMeters > 0 && std::isfinite(options.reachMeters) && options.leastShare > 0 && options.leastShare <= 1 &&
      options.iterations > 0 && options.mostPoints >= kFewestPoints)
    return {};
  return fail("The reach, the share and the number of iterations must be above 0, the share at most 1", {}, "Leave them at their defaults");
}

Error noFit(const std::string& what, const std::string& advice) { return {what, {}, advice}; }

}  // namespace

std::string Registration::report() const {
  const glm::dvec3 t = shiftMeters;
  const double angle = glm::degrees(rotationAngleBetween(fixedFromMoving, RigidTransform::identity()));
  return fmt::format("  pairs     {} ({:.1f} % of the moving points)\n  residuals {:.2f} mm to the surface, {:.2f} mm to the nearest point (rms)\n"
                     "  rotation  {:.5f}°\n  shift     {:.4f} {:.4f} {:.4f} m at the scan's middle\n  steps     {}\n",
                     pairs, 100 * share, 1e3 * rmsPlaneMeters, 1e3 * rmsPointMeters, angle, t.x, t.y, t.z, iterations);
}

Result<Registration> registerScan(std::span<const glm::dvec3> moving, std::span<const glm::dvec3> fixed, const RegistrationOptions& options,
                                  const Progress& progress) {
  if (auto ok = checkOptions(options); !ok) return fail(ok.error());
  if (moving.size() < kFewestPoints || fixed.size() < kFewestPoints)
    return fail(fmt::format("Scans of {} and {} points cannot be fitted", moving.size(), fixed.size()), {}, "Give scans of at least 100 points");
  Bounds movingBounds;
  for (const glm::dvec3& p : moving) movingBounds.add(p);
  const glm::dvec3 origin = movingBounds.centre();
  const std::vector<glm::dvec3> points = thinned(moving, options.mostPoints, origin);
  const double radius = std::max(movingBounds.diagonal() / 2, 1e-3);

  try {
    Fixed target;
    target.points = thinned(fixed, options.mostPoints, origin);
    auto normals = estimateNormals(target.points, {}, {}, {}, progress.part(0, 0.2));
    if (!normals) return fail(normals.error());
    target.normals = std::move(*normals);
    std::vector<std::uint32_t> all(target.points.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);
    target.cloud = pclCloud(target.points, all, glm::dvec3(0));
    target.tree.setInputCloud(target.cloud);

    RigidTransform transform;
    const glm::dvec3 middle(0);
    double reach = options.reachMeters;
    for (int i = 1; i <= options.iterations; ++i) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(0.2 + 0.8 * i / options.iterations, "Fitting");
      const Equations e = equationsOf(points, target, transform, middle, radius, reach);
      const double share = static_cast<double>(e.pairs) / static_cast<double>(points.size());
      if (e.pairs < kFewestPoints / 2 || share < options.leastShare)
        return fail(noFit(fmt::format("Only {:.1f} % of the moving points find a partner within {:.3f} m", 100 * share, reach),
                          "Bring the scans closer, allow a longer reach, or choose scans that overlap more"));
      const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(e.normal);
      const auto& strengths = eigen.eigenvalues();
      if (!(strengths[0] > kWeakest * strengths[5]))
        return fail(noFit("The surfaces leave a direction open: the scans could slide along them", "Choose scans with walls or edges in several directions"));
      const Vector6 x = eigen.eigenvectors() * (eigen.eigenvectors().transpose() * e.right).cwiseQuotient(strengths);
      transform = stepOf(x, middle, radius) * transform;
      transform.rotation = glm::normalize(transform.rotation);
      // Residuals say how near the scans are by now: what lies much further apart is no pair.
      const double rms = std::sqrt(e.pointSquares / static_cast<double>(e.pairs));
      const double nextReach = std::min(reach, std::max(3 * rms, options.reachMeters / 50));
      const bool settled = nextReach > 0.98 * reach;
      reach = nextReach;
      if (!settled || x.norm() > kStepMeters) continue;

      const Equations last = equationsOf(points, target, transform, middle, radius, reach);
      Registration result;
      const RigidTransform toLocal{glm::dquat(1, 0, 0, 0), -origin}, toWorld{glm::dquat(1, 0, 0, 0), origin};
      result.fixedFromMoving = toWorld * transform * toLocal;
      result.shiftMeters = transform.translation;
      result.pairs = last.pairs;
      result.share = static_cast<double>(last.pairs) / static_cast<double>(points.size());
      result.rmsPlaneMeters = std::sqrt(last.planeSquares / static_cast<double>(std::max<std::size_t>(last.pairs, 1)));
      result.rmsPointMeters = std::sqrt(last.pointSquares / static_cast<double>(std::max<std::size_t>(last.pairs, 1)));
      result.iterations = i;
      if (result.share < options.leastShare)
        return fail(noFit(fmt::format("Only {:.1f} % of the moving points agree with the fixed scan", 100 * result.share),
                          "Choose scans that overlap more"));
      return result;
    }
  } catch (const std::exception& error) {
    return fail(std::string("The scans cannot be fitted: ") + error.what(), {}, "Thin the scans first");
  }
  return fail(noFit(fmt::format("The fit did not converge in {} steps", options.iterations), "Bring the scans closer or allow more steps"));
}

}  // namespace alidade

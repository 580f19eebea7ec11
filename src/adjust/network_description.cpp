// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/network_description.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>

#include "adjust/network_checks.h"
#include "adjust/robust.h"

namespace alidade {

namespace {

constexpr double noNumber = std::numeric_limits<double>::quiet_NaN();
/// Beyond this two unknowns can hardly be told apart.
constexpr double kHighCorrelation = 0.95;
constexpr double chiSquared95 = 5.991464547107979;  // two degrees of freedom

std::vector<int> blocksOf(const Term& term) {
  std::vector<int> blocks;
  for (const int b : term.blocks)
    if (b >= 0) blocks.push_back(b);
  return blocks;
}

/// From everything adjusted that the frame hangs on: the pixel's ellipse, and what it is across the ray at the point.
ExpectedError expectedAt(const NetworkTerms& terms, const NetworkState& state, const NormalSystem& normals,
                         const NetworkOptions::At& at, double wider) {
  ExpectedError expected;
  expected.world = at.world;
  expected.ellipseSemiMajorPx = expected.ellipseSemiMinorPx = expected.ellipseAngleRad = expected.millimetres = noNumber;
  const Term term = terms.frameTerm(at.frame);
  const auto prepared = terms.prepare(state);
  const glm::dvec3 point = at.world - terms.layout().origin, inCamera = prepared.views[at.frame].inCamera(point);
  TermValue value;
  if (!Camera(state.cameras[terms.network().frames[at.frame].camera].intrinsics()).project(inCamera) ||
      !terms.project(prepared, term, point, true, value))
    return expected;
  const std::vector<int> blocks = blocksOf(term);
  Eigen::Matrix2d pixel = Eigen::Matrix2d::Zero();
  if (!blocks.empty()) {
    const Eigen::MatrixXd covariance = normals.covariance(blocks);
    Eigen::MatrixXd jacobian(2, covariance.cols());
    int column = 0;
    for (int b = 0; b < 3; ++b) {
      if (term.blocks[b] < 0) continue;
      const int n = terms.layout().blocks[term.blocks[b]].size;
      for (int c = 0; c < n; ++c, ++column)
        for (int r = 0; r < 2; ++r) jacobian(r, column) = value.byBlock[b][r * n + c];
    }
    pixel = wider * wider * jacobian * covariance * jacobian.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(pixel);
  expected.ellipseSemiMinorPx = std::sqrt(chiSquared95 * std::max(0.0, axes.eigenvalues()[0]));
  expected.ellipseSemiMajorPx = std::sqrt(chiSquared95 * std::max(0.0, axes.eigenvalues()[1]));
  const Eigen::Vector2d major = axes.eigenvectors().col(1);
  expected.ellipseAngleRad = std::atan2(major[1], major[0]);
  // A basis across the ray, in world axes: the ray is the direction in which the pixel does not move.
  const glm::dvec3 du(value.byPoint[0], value.byPoint[1], value.byPoint[2]), dv(value.byPoint[3], value.byPoint[4], value.byPoint[5]);
  const glm::dvec3 ray = glm::normalize(glm::cross(du, dv)), first = glm::normalize(du), second = glm::cross(ray, first);
  Eigen::Matrix2d byAcross;
  byAcross << glm::dot(du, first), glm::dot(du, second), glm::dot(dv, first), glm::dot(dv, second);
  const Eigen::Matrix2d inverse = byAcross.inverse();
  const Eigen::Matrix2d across = inverse * pixel * inverse.transpose();
  const double largest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(across).eigenvalues()[1];
  expected.millimetres = 1000 * std::sqrt(chiSquared95 * std::max(0.0, largest));
  return expected;
}

void describePoses(const NetworkTerms& terms, const NormalSystem& normals, double wider, NetworkSummary& summary) {
  for (std::size_t i = 0; i < summary.poses.size(); ++i) {
    const int block = terms.layout().poseBlock[i];
    if (block < 0) continue;
    AdjustedPose& pose = summary.poses[i];
    const Eigen::MatrixXd covariance = normals.covariance({block});
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) pose.covariance[r][c] = covariance(r, c);
    for (int k = 0; k < 3; ++k) {
      pose.positionStdM[k] = std::sqrt(std::max(0.0, covariance(k, k)));
      pose.rotationStdRad[k] = std::sqrt(std::max(0.0, covariance(3 + k, 3 + k)));
    }
    Covariance6 region = pose.covariance;
    for (auto& row : region)
      for (double& entry : row) entry *= wider * wider;
    pose.ellipse = positionEllipse(region);
  }
}

void describeCameras(const NetworkTerms& terms, const NetworkState& state, const NormalSystem& normals,
                     NetworkSummary& summary) {
  const Network& network = terms.network();
  const NetworkLayout& layout = terms.layout();
  summary.cameraAccuracy.resize(network.cameras.size());
  for (std::size_t i = 0; i < network.cameras.size(); ++i) {
    if (layout.cameraBlock[i] < 0) continue;
    const Eigen::MatrixXd covariance = normals.covariance({layout.cameraBlock[i]});
    summary.cameraAccuracy[i].covariance.assign(covariance.data(), covariance.data() + covariance.size());
  }
  for (const NetworkFrame& frame : network.frames) {
    const int pose = layout.poseBlock[frame.pose], camera = layout.cameraBlock[frame.camera];
    if (pose < 0 || camera < 0 || frame.mount >= 0) continue;
    const Eigen::MatrixXd both = normals.covariance({pose, camera});
    const glm::dvec3 axis = glm::conjugate(state.poses[frame.pose].rotation) * glm::dvec3(0, 0, 1);
    const Eigen::Vector3d along(axis.x, axis.y, axis.z);
    const double product = along.dot(both.topLeftCorner<3, 3>() * along) * both(6, 6);
    if (product > 0)
      summary.cameraAccuracy[frame.camera].focalWithDistance.push_back(along.dot(both.block<3, 1>(0, 6)) / std::sqrt(product));
  }
}

void describeMounts(const NetworkTerms& terms, const NormalSystem& normals, NetworkSummary& summary) {
  summary.mountAccuracy.resize(summary.cameraFromBody.size());
  for (std::size_t i = 0; i < summary.mountAccuracy.size(); ++i) {
    const int block = terms.layout().mountBlock[i];
    if (block < 0) continue;
    const Eigen::MatrixXd covariance = normals.covariance({block});
    for (int k = 0; k < 3; ++k) {
      summary.mountAccuracy[i].offsetStdM[k] = std::sqrt(std::max(0.0, covariance(k, k)));
      summary.mountAccuracy[i].rotationStdRad[k] = std::sqrt(std::max(0.0, covariance(3 + k, 3 + k)));
    }
  }
}

/// Where nothing but the focal length tells how far away the scene is, no single axis of the world need show it.
void describeFocalAndDistance(const Network& network, NetworkSummary& summary) {
  for (std::size_t i = 0; i < network.cameras.size(); ++i) {
    const std::vector<double>& all = summary.cameraAccuracy[i].focalWithDistance;
    const auto worst = std::max_element(all.begin(), all.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    if (worst != all.end() && std::abs(*worst) > kHighCorrelation)
      summary.correlations.push_back(fmt::format("the focal length of {} and how far away its pictures were taken can hardly be told "
                                                 "apart (correlation {:.3f}); add points nearer or farther, or lock the focal length",
                                                 network.cameras[i].name, *worst));
  }
}

/// Pairs of unknowns that a frame hangs on with a correlation above 0.95.
void describeCorrelations(const NetworkTerms& terms, const NormalSystem& normals, NetworkSummary& summary) {
  const auto& blocks = terms.layout().blocks;
  std::map<std::pair<std::string, std::string>, double> found;
  for (std::size_t f = 0; f < terms.network().frames.size(); ++f) {
    const std::vector<int> own = blocksOf(terms.frameTerm(static_cast<int>(f)));
    if (own.empty()) continue;
    const Eigen::MatrixXd covariance = normals.covariance(own);
    std::vector<std::pair<int, int>> names;
    for (const int b : own)
      for (int c = 0; c < blocks[b].size; ++c) names.emplace_back(b, c);
    for (int r = 0; r < covariance.rows(); ++r)
      for (int c = 0; c < r; ++c) {
        const double product = covariance(r, r) * covariance(c, c);
        if (!(product > 0)) continue;
        const double correlation = covariance(r, c) / std::sqrt(product);
        if (std::abs(correlation) < kHighCorrelation) continue;
        const auto name = [&](int i) { return unknownName(terms.network(), terms.layout(), names[i].first, names[i].second); };
        found[{name(c), name(r)}] = correlation;
      }
  }
  for (const auto& [names, correlation] : found)
    summary.correlations.push_back(fmt::format("{} and {} can hardly be told apart (correlation {:.3f})", names.first,
                                               names.second, correlation));
}

void describeCheckPoints(const NetworkTerms& terms, const NetworkState& state, NetworkSummary& summary) {
  const Network& network = terms.network();
  std::vector<std::vector<int>> held(network.points.size());
  std::vector<char> fitted(network.points.size(), 0);
  for (std::size_t i = 0; i < network.observations.size(); ++i) {
    const PictureObservation& o = network.observations[i];
    if (o.heldOut) held[o.point].push_back(static_cast<int>(i));
    else fitted[o.point] = 1;
  }
  std::vector<Camera> cameras;
  for (std::size_t p = 0; p < network.points.size(); ++p) {
    if (network.points[p].kind == PointKind::Tie || fitted[p] || held[p].size() < 2) continue;
    if (cameras.empty()) cameras = camerasOf(state);
    if (const auto met = intersectRays(network, cameras, state, held[p]))
      summary.checkPoints.push_back({static_cast<int>(p), network.points[p].name,
                                     *met + terms.layout().origin - *network.points[p].world});
  }
}

void describeResiduals(const NetworkTerms& terms, const NetworkState& state, const std::vector<char>& active,
                       NetworkSummary& summary) {
  struct Sum { ResidualGroup group; double pixels = 0, metres = 0, sigmas = 0; int fitted = 0; };
  std::map<std::pair<int, bool>, Sum> groups;
  const auto prepared = terms.prepare(state);
  const Network& network = terms.network();
  std::vector<double> pixelSquares(network.poses.size(), 0);
  std::vector<int> inPixels(network.poses.size(), 0);
  TermValue value;
  for (std::size_t t = 0; t < terms.terms().size(); ++t) {
    const Term& term = terms.terms()[t];
    value.pixels = glm::dvec2(noNumber), value.metres = noNumber;
    const bool valued = (term.point < 0 || std::isfinite(state.points[term.point].x)) &&
                        terms.evaluate(state, prepared, term, false, value);
    NetworkResidual r;
    r.kind = term.kind, r.index = term.index, r.frame = term.frame, r.point = term.point;
    r.name = residualName(terms, static_cast<int>(t));
    r.residualPx = valued ? value.pixels : glm::dvec2(noNumber);
    r.residualM = valued ? value.metres : noNumber;
    r.sigmas = valued ? std::sqrt(value.squares()) : std::numeric_limits<double>::infinity();
    r.heldOut = term.heldOut;
    r.outlier = !term.heldOut && !active[t];
    Sum& sum = groups[{static_cast<int>(term.kind), term.heldOut}];
    sum.group.kind = term.kind, sum.group.heldOut = term.heldOut;
    ++sum.group.count;
    sum.group.outliers += r.outlier;
    AdjustedPose* pose = term.frame < 0 ? nullptr : &summary.poses[network.frames[term.frame].pose];
    if (valued && !r.outlier) {
      ++sum.fitted;
      sum.pixels += glm::dot(value.pixels, value.pixels);
      sum.metres += value.metres * value.metres;
      sum.sigmas += value.squares() / value.rows;
      if (!term.heldOut) {
        summary.finalCost += 0.5 * value.squares();
        summary.redundancy += value.rows;
        if (pose) {
          ++pose->observations;
          const int at = network.frames[term.frame].pose;
          if (std::isfinite(value.pixels.x)) pixelSquares[at] += glm::dot(value.pixels, value.pixels), ++inPixels[at];
        }
      }
    }
    if (pose && r.outlier) ++pose->outliers;
    summary.residuals.push_back(std::move(r));
  }
  for (std::size_t i = 0; i < summary.poses.size(); ++i)
    if (inPixels[i] > 0) summary.poses[i].rmsPx = std::sqrt(pixelSquares[i] / inPixels[i]);
  for (auto& [key, sum] : groups) {
    sum.group.rmsPx = std::sqrt(sum.pixels / sum.fitted);
    sum.group.rmsM = std::sqrt(sum.metres / sum.fitted);
    sum.group.rmsSigmas = std::sqrt(sum.sigmas / sum.fitted);
    summary.groups.push_back(sum.group);
  }
}

}  // namespace

const char* residualKindName(ResidualKind kind) {
  static constexpr const char* names[] = {"control", "scan point", "tie point", "edge", "depth",
                                          "surface", "coordinates", "prior", "trajectory", "smoothness"};
  return names[static_cast<int>(kind)];
}

std::string residualName(const NetworkTerms& terms, int t) {
  const Term& term = terms.terms()[t];
  const Network& network = terms.network();
  std::string name = term.kind == ResidualKind::Edge ? network.edges[term.index].name
                     : term.point >= 0               ? network.points[term.point].name
                                                     : std::string();
  if (name.empty()) name = fmt::format("{} {}", residualKindName(term.kind), (term.point >= 0 ? term.point : term.index) + 1);
  return name;
}

NetworkSummary startSummary(const NetworkTerms& terms, const NetworkState& start) {
  NetworkSummary summary;
  const glm::dvec3 origin = terms.layout().origin;
  const Network& network = terms.network();
  for (std::size_t i = 0; i < network.poses.size(); ++i) {
    AdjustedPose pose;
    const bool untouched = network.poses[i].bodyFromWorld && terms.layout().poseBlock[i] < 0;
    pose.bodyFromWorld = untouched ? *network.poses[i].bodyFromWorld : transformOf(start.poses[i], origin);
    summary.poses.push_back(pose);
  }
  for (const MountState& mount : start.mounts) summary.cameraFromBody.push_back({mount.rotation, mount.translation});
  for (const VaryingCamera& camera : start.cameras) summary.cameras.push_back(camera.intrinsics());
  summary.clockOffsetSecs = start.clocks;
  summary.clockStdSecs.assign(start.clocks.size(), 0);
  for (const glm::dvec3& p : start.points) summary.points.push_back(p + origin);
  return summary;
}

NetworkSummary describe(const NetworkTerms& terms, const NetworkState& state, const std::vector<char>& active,
                        const NetworkOptions& options) {
  NetworkSummary summary = startSummary(terms, state);
  describeResiduals(terms, state, active, summary);
  std::vector<char> seen(terms.layout().slotPoint.size(), 0);
  for (std::size_t t = 0; t < active.size(); ++t)
    if (active[t] && terms.terms()[t].slot >= 0) seen[terms.terms()[t].slot] = 1;
  summary.redundancy -= terms.layout().freeUnknowns + 3 * static_cast<int>(std::count(seen.begin(), seen.end(), 1));
  // Origin, direction and scale of a free network are no information lost.
  if (options.freeNetwork) summary.redundancy += 7;
  summary.sigma0 = summary.redundancy > 0 ? std::sqrt(2 * summary.finalCost / summary.redundancy) : 0;
  for (std::size_t slot = 0; slot < seen.size(); ++slot) {
    const int p = terms.layout().slotPoint[slot];
    if (!seen[slot] && terms.network().points[p].kind == PointKind::Tie) summary.points[p] = glm::dvec3(noNumber);
  }
  describeCheckPoints(terms, state, summary);
  return summary;
}

void describeAccuracy(const NetworkTerms& terms, const NetworkState& state, const NormalSystem& normals,
                      const NetworkOptions& options, NetworkSummary& summary) {
  const double wider = summary.sigmaScale > 1 ? widening95(summary.redundancy) : 1;
  describePoses(terms, normals, wider, summary);
  describeCameras(terms, state, normals, summary);
  describeMounts(terms, normals, summary);
  describeCorrelations(terms, normals, summary);
  describeFocalAndDistance(terms.network(), summary);
  for (std::size_t i = 0; i < summary.clockStdSecs.size(); ++i)
    if (terms.layout().clockBlock[i] >= 0)
      summary.clockStdSecs[i] = std::sqrt(std::max(0.0, normals.covariance({terms.layout().clockBlock[i]})(0, 0)));
  for (const NetworkOptions::At& at : options.at) summary.expected.push_back(expectedAt(terms, state, normals, at, wider));
}

}  // namespace alidade

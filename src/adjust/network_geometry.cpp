// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Where a network starts from, and whether its geometry can carry the answer.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "adjust/network_checks.h"
#include "adjust/resection_checks.h"
#include "adjust/start_pose.h"

namespace alidade {

namespace {

std::string frameName(const Network& network, int i) {
  const std::string& name = network.frames[i].name;
  return name.empty() ? fmt::format("frame {}", i + 1) : fmt::format("frame \"{}\"", name);
}

/// The start pose of a camera of its own from the known points that it sees.
Result<PoseState> posedByPoints(const Network& network, const NetworkLayout& layout, int pose) {
  std::vector<ResectionObservation> seen;
  int frameOfPose = -1;
  for (const PictureObservation& o : network.observations) {
    const NetworkFrame& frame = network.frames[o.frame];
    const NetworkPoint& point = network.points[o.point];
    if (frame.pose != pose || frame.mount >= 0) continue;
    frameOfPose = o.frame;
    if (point.kind == PointKind::Tie || o.heldOut) continue;
    seen.push_back({o.pixel, *point.world, o.sigmaPx, point.name});
  }
  const std::string name = frameOfPose < 0 ? fmt::format("pose {}", pose + 1) : frameName(network, frameOfPose);
  if (frameOfPose < 0)
    return fail(fmt::format("{} has no pose to start from", name), name, "Give an approximate pose");
  const auto found = findStartPose(Camera(network.cameras[network.frames[frameOfPose].camera].intrinsics), seen,
                                   network.frames[frameOfPose].shutter);
  if (!found) return fail(fmt::format("{} has no pose to start from: {}", name, found.error().what), name, found.error().advice);
  return stateOf(*found, layout.origin);
}

RigidTransform cameraAt(const Network& network, const NetworkState& state, int frame) {
  const NetworkFrame& f = network.frames[frame];
  const RigidTransform body = transformOf(state.poses[f.pose], glm::dvec3(0));
  if (f.mount < 0) return body;
  return RigidTransform{state.mounts[f.mount].rotation, state.mounts[f.mount].translation} * body;
}

struct FrameView {
  std::vector<glm::dvec3> points;      ///< seen, from the origin
  std::vector<glm::dvec3> directions;  ///< of edges, unit
  glm::dvec2 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  double sigmaPx = 0;
  int known = 0, tied = 0, edges = 0;
};

std::map<int, FrameView> viewsOf(const NetworkTerms& terms, const NetworkState& state, const std::vector<char>& active) {
  std::map<int, FrameView> views;
  const Network& network = terms.network();
  for (std::size_t t = 0; t < terms.terms().size(); ++t) {
    const Term& term = terms.terms()[t];
    if (!active[t] || term.frame < 0) continue;
    FrameView& view = views[term.frame];
    const auto widen = [&](const glm::dvec2& pixel, double sigma) {
      view.low = glm::min(view.low, pixel), view.high = glm::max(view.high, pixel);
      view.sigmaPx = std::max(view.sigmaPx, sigma);
    };
    if (term.kind == ResidualKind::Edge) {
      const EdgeObservation& edge = network.edges[term.index];
      view.directions.push_back(glm::normalize(edge.to - edge.from));
      view.points.push_back(0.5 * (edge.from + edge.to) - terms.layout().origin);
      widen(edge.pixel, edge.sigmaPx);
      ++view.edges;
    } else if (term.kind != ResidualKind::Depth) {
      const PictureObservation& o = network.observations[term.index];
      view.points.push_back(state.points[term.point]);
      widen(o.pixel, o.sigmaPx);
      ++(term.kind == ResidualKind::Tie ? view.tied : view.known);
    }
  }
  return views;
}

/// Directions more than two degrees apart, counted until three are found.
int distinctDirections(const std::vector<glm::dvec3>& directions) {
  constexpr double apart = 0.0349;
  std::vector<glm::dvec3> kept;
  for (const glm::dvec3& d : directions) {
    if (std::all_of(kept.begin(), kept.end(), [&](const auto& k) { return glm::length(glm::cross(k, d)) > apart; })) kept.push_back(d);
    if (kept.size() == 3) break;
  }
  return static_cast<int>(kept.size());
}

bool collinear(const std::vector<glm::dvec3>& points) {
  glm::dvec3 centre(0);
  for (const auto& p : points) centre += p / static_cast<double>(points.size());
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const auto& p : points) {
    const Eigen::Vector3d d(p.x - centre.x, p.y - centre.y, p.z - centre.z);
    moment += d * d.transpose();
  }
  const Eigen::Vector3d spread = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moment).eigenvalues();
  return spread[1] <= 1e-8 * spread[2];
}

}  // namespace

std::optional<glm::dvec3> intersectRays(const Network& network, const std::vector<Camera>& cameras,
                                        const NetworkState& state, const std::vector<int>& observations) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  std::vector<std::pair<glm::dvec3, glm::dvec3>> rays;
  for (const int i : observations) {
    const PictureObservation& o = network.observations[i];
    const auto ray = cameras[network.frames[o.frame].camera].unproject(o.pixel);
    if (!ray) continue;
    const RigidTransform camera = cameraAt(network, state, o.frame);
    const glm::dvec3 centre = camera.centre(), d = glm::normalize(glm::conjugate(camera.rotation) * *ray);
    const Eigen::Vector3d e(d.x, d.y, d.z), c(centre.x, centre.y, centre.z);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - e * e.transpose();
    normal += across;
    right += across * c;
    rays.emplace_back(centre, d);
  }
  double widest = 0;
  for (const auto& [c, d] : rays) widest = std::max(widest, glm::length(glm::cross(d, rays.front().second)));
  // A twentieth of a degree: a tenth of a pixel then moves the point by an eighth of its distance.
  if (rays.size() < 2 || widest < 1e-3) return std::nullopt;
  const Eigen::Vector3d x = normal.ldlt().solve(right);
  const glm::dvec3 point(x[0], x[1], x[2]);
  for (const auto& [c, d] : rays)
    if (!(glm::dot(point - c, d) > 0)) return std::nullopt;
  return point;
}

std::vector<Camera> camerasOf(const NetworkState& state) {
  std::vector<Camera> cameras;
  for (const VaryingCamera& camera : state.cameras) cameras.emplace_back(camera.intrinsics());
  return cameras;
}

Result<NetworkState> startState(const Network& network, const NetworkLayout& layout, std::vector<std::string>& warnings) {
  NetworkState state;
  for (std::size_t i = 0; i < network.poses.size(); ++i) {
    if (network.poses[i].bodyFromWorld) {
      state.poses.push_back(stateOf(*network.poses[i].bodyFromWorld, layout.origin));
      continue;
    }
    const auto found = posedByPoints(network, layout, static_cast<int>(i));
    if (!found) return fail(found.error());
    state.poses.push_back(*found);
  }
  for (const NetworkMount& mount : network.mounts)
    state.mounts.push_back({glm::normalize(mount.cameraFromBody.rotation), mount.cameraFromBody.translation});
  for (const NetworkCamera& camera : network.cameras) state.cameras.emplace_back(camera.intrinsics);
  for (const NetworkTrajectory& trajectory : network.trajectories) state.clocks.push_back(trajectory.clockOffsetSecs);
  std::vector<std::vector<int>> seenBy(network.points.size());
  for (std::size_t i = 0; i < network.observations.size(); ++i)
    if (!network.observations[i].heldOut) seenBy[network.observations[i].point].push_back(static_cast<int>(i));
  const std::vector<Camera> cameras = camerasOf(state);
  std::size_t lost = 0;
  std::string first;
  for (std::size_t i = 0; i < network.points.size(); ++i) {
    const NetworkPoint& point = network.points[i];
    std::optional<glm::dvec3> start;
    if (point.world) start = *point.world - layout.origin;
    else start = intersectRays(network, cameras, state, seenBy[i]);
    if (!start && point.surface) start = point.surface->through - layout.origin;
    if (!start && lost++ == 0) first = point.name.empty() ? fmt::format("{}", i + 1) : point.name;
    state.points.push_back(start.value_or(glm::dvec3(std::numeric_limits<double>::quiet_NaN())));
  }
  if (lost > 0)
    warnings.push_back(fmt::format("{} tie points are left out, their rays meet nowhere in front of the cameras or are "
                                   "nearly parallel (\"{}\" first); observe them from places farther apart", lost, first));
  return state;
}

std::optional<std::string> refusalOfFrames(const NetworkTerms& terms, const NetworkState& state,
                                           const std::vector<char>& active) {
  const Network& network = terms.network();
  std::vector<char> held(network.poses.size(), 0);
  for (const PosePrior& prior : network.priors) held[prior.pose] = 1;
  for (const auto& t : network.trajectories)
    for (const int pose : t.poses) held[pose] = 1;
  for (const auto& s : network.smoothness)
    for (const int pose : s.poses) held[pose] = 1;
  std::vector<int> framesOfPose(network.poses.size(), 0);
  for (const NetworkFrame& frame : network.frames) ++framesOfPose[frame.pose];
  const auto views = viewsOf(terms, state, active);
  for (std::size_t f = 0; f < network.frames.size(); ++f) {
    const NetworkFrame& frame = network.frames[f];
    const NetworkPose& pose = network.poses[frame.pose];
    const auto free = std::count(pose.locked.begin(), pose.locked.end(), false);
    if (free == 0 || held[frame.pose] || framesOfPose[frame.pose] > 1) continue;
    const auto at = views.find(static_cast<int>(f));
    const std::string name = frameName(network, static_cast<int>(f));
    const int rows = at == views.end() ? 0 : 2 * (at->second.known + at->second.tied) + at->second.edges;
    if (rows < free)
      return fmt::format("{} has {} measured pixel coordinates for {} free parameters; observe more points in it", name, rows, free);
    const FrameView& view = at->second;
    if (free == 6 && view.edges == 0 && view.known + view.tied < 4)
      return fmt::format("{} has {} observations for 6 free parameters, at least 4 are needed (three leave up to four poses, the fourth decides); observe more points in it",
                         name, view.known + view.tied);
    if (free >= 3 && glm::length(view.high - view.low) < std::max(1.0, 6 * view.sigmaPx))
      return fmt::format("All pixels of {} lie in one spot; observe points all over the picture", name);
    if (free == 6 && view.known + view.tied < 3 && distinctDirections(view.directions) < 3)
      return fmt::format("The edges observed in {} have fewer than three directions: the camera could move along them; "
                         "observe an edge of another direction, or points", name);
    if (free == 6 && view.edges == 0 && collinear(view.points))
      return fmt::format("All points observed in {} are collinear: the camera could turn about their line; observe points "
                         "beside the line", name);
  }
  return std::nullopt;
}

std::optional<std::string> refusalOfWeakness(const NetworkTerms& terms, const NetworkState& state,
                                             const std::vector<char>& active, const NormalSystem& normals) {
  const Network& network = terms.network();
  const NetworkLayout& layout = terms.layout();
  const auto views = viewsOf(terms, state, active);
  constexpr double weakest = 0.05;
  for (const auto& [f, view] : views) {
    const int pose = network.frames[f].pose, block = layout.poseBlock[pose];
    if (block < 0 || view.points.empty()) continue;
    std::vector<double> distances;
    for (const glm::dvec3& p : view.points) distances.push_back(glm::length(p - state.poses[pose].centre));
    std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
    const double distance = distances[distances.size() / 2];
    const Eigen::MatrixXd covariance = normals.covariance({block});
    const auto largest = [&](int first) {
      return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(
                                         Eigen::Matrix3d(covariance.block<3, 3>(first, first))).eigenvalues()[2]));
    };
    if (const double position = largest(0); !(position <= weakestPositionM(distance)))
      return fmt::format("The position of {} is undetermined: its standard deviation would be {:.3g} m with what it sees "
                         "{:.3g} m away; observe what is nearer, spread over the picture and in depth, or lock the position",
                         frameName(network, f), position, distance);
    if (const double rotation = largest(3); !(rotation <= weakest))
      return fmt::format("The attitude of {} is undetermined: its standard deviation would be {:.2g} rad; observe points "
                         "spread over the picture, or lock the attitude", frameName(network, f), rotation);
  }
  return std::nullopt;
}

}  // namespace alidade

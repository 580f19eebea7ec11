// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/network_checks.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Cholesky>
#include <fmt/format.h>

namespace alidade {

namespace {

bool isFinite(const glm::dvec2& p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}
bool isFinite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}
bool isSigma(double s) {
  return s > 0 && std::isfinite(s);
}
template <class List>
bool inside(int index, const List& list) {
  return index >= 0 && index < static_cast<int>(list.size());
}

std::string quoted(const std::string& kind, const std::string& name, std::size_t index) {
  return name.empty() ? fmt::format("{} {}", kind, index + 1) : fmt::format("{} \"{}\"", kind, name);
}

tl::unexpected<Error> notFinite(const std::string& what) {
  return fail(fmt::format("{} holds a number that is not finite", what), what, "Correct or delete it");
}
tl::unexpected<Error> badSigma(const std::string& what, double sigma) {
  return fail(fmt::format("{} has the standard deviation {}", what, sigma), what, "Give a positive one");
}

Result<void> checkFrames(const Network& n) {
  std::vector<char> carried(n.poses.size(), 0);
  for (std::size_t i = 0; i < n.frames.size(); ++i) {
    const NetworkFrame& frame = n.frames[i];
    const std::string what = quoted("frame", frame.name, i);
    if (!inside(frame.pose, n.poses)) return fail(fmt::format("{} has no pose", what), what, "Add a pose for it or leave it out");
    if (!inside(frame.camera, n.cameras)) return fail(fmt::format("{} has no camera", what), what, "Add its calibration");
    if (frame.mount != -1 && !inside(frame.mount, n.mounts)) return fail(fmt::format("{} has no mount {}", what, frame.mount), what);
    const Intrinsics& in = n.cameras[frame.camera].intrinsics;
    if (frame.pictureWidth > 0 && (frame.pictureWidth != in.width || frame.pictureHeight != in.height))
      return fail(fmt::format("The picture of {} has {}×{} pixels, its calibration is for {}×{}", what, frame.pictureWidth,
                              frame.pictureHeight, in.width, in.height),
                  what, "Use the calibration of this picture size");
    carried[frame.pose] = 1;
  }
  for (std::size_t i = 0; i < n.poses.size(); ++i) {
    const std::string what = quoted("pose", n.poses[i].name, i);
    if (!carried[i]) return fail(fmt::format("{} belongs to no frame", what), what, "Add its picture or leave the pose out");
    if (n.poses[i].bodyFromWorld && !n.poses[i].bodyFromWorld->isFinite()) return notFinite(what);
    if (!std::isfinite(n.poses[i].timeSecs)) return notFinite(what);
  }
  for (std::size_t i = 0; i < n.cameras.size(); ++i)
    if (!n.cameras[i].held.empty() && n.cameras[i].held.size() != n.cameras[i].intrinsics.parameters().size())
      return fail(fmt::format("{} parameters of {} are held or not, it has {}", n.cameras[i].held.size(), quoted("camera", n.cameras[i].name, i),
                              n.cameras[i].intrinsics.parameters().size()));
  for (std::size_t i = 0; i < n.cameras.size(); ++i)
    if (const auto valid = n.cameras[i].intrinsics.validate(); !valid)
      return fail(valid.error().in(quoted("camera", n.cameras[i].name, i)));
  for (std::size_t i = 0; i < n.mounts.size(); ++i)
    if (!n.mounts[i].cameraFromBody.isFinite()) return notFinite(quoted("mount", n.mounts[i].name, i));
  return {};
}

Result<void> checkPoints(const Network& n) {
  for (std::size_t i = 0; i < n.points.size(); ++i) {
    const NetworkPoint& point = n.points[i];
    const std::string what = quoted("point", point.name, i);
    if (point.world && !isFinite(*point.world)) return notFinite(what);
    if (point.kind != PointKind::Tie && !point.world)
      return fail(fmt::format("{} is a known point without coordinates", what), what, "Give its coordinates, or make it a tie point");
    for (int k = 0; k < 3; ++k)
      if (!(point.sigmaM[k] >= 0) || !std::isfinite(point.sigmaM[k])) return badSigma(what, point.sigmaM[k]);
    if (!point.surface) continue;
    if (!isFinite(point.surface->through) || !isFinite(point.surface->normal)) return notFinite(what);
    if (!(glm::length(point.surface->normal) > 0)) return fail(fmt::format("The surface of {} has no normal", what), what);
    if (!isSigma(point.surface->sigmaM)) return badSigma(what, point.surface->sigmaM);
  }
  return {};
}

Result<void> checkObservations(const Network& n) {
  std::set<std::pair<int, int>> seen, measured;
  for (std::size_t i = 0; i < n.observations.size(); ++i) {
    const PictureObservation& o = n.observations[i];
    const std::string number = fmt::format("observation {}", i + 1);
    if (!inside(o.frame, n.frames)) return fail(fmt::format("{} belongs to no frame", number), number);
    if (!inside(o.point, n.points)) return fail(fmt::format("{} belongs to no point", number), number);
    const std::string what = fmt::format("{} of {} in {}", number, quoted("point", n.points[o.point].name, o.point),
                                         quoted("frame", n.frames[o.frame].name, o.frame));
    if (!isFinite(o.pixel)) return notFinite(what);
    if (!isSigma(o.sigmaPx)) return badSigma(what, o.sigmaPx);
    if (!seen.emplace(o.frame, o.point).second)
      return fail(fmt::format("{} is a duplicate: the point was observed in this frame before", what), what,
                  "Delete one of the two");
  }
  for (std::size_t i = 0; i < n.edges.size(); ++i) {
    const EdgeObservation& o = n.edges[i];
    const std::string what = quoted("edge", o.name, i);
    if (!inside(o.frame, n.frames)) return fail(fmt::format("{} belongs to no frame", what), what);
    if (!isFinite(o.from) || !isFinite(o.to) || !isFinite(o.pixel)) return notFinite(what);
    if (!isSigma(o.sigmaPx)) return badSigma(what, o.sigmaPx);
    if (!(glm::length(o.to - o.from) > 1e-6)) return fail(fmt::format("Both ends of {} are one point", what), what, "Give two points of the edge");
  }
  for (std::size_t i = 0; i < n.depths.size(); ++i) {
    const DepthObservation& o = n.depths[i];
    const std::string what = fmt::format("depth {}", i + 1);
    if (!inside(o.frame, n.frames) || !inside(o.point, n.points)) return fail(fmt::format("{} belongs to no frame or point", what), what);
    if (!std::isfinite(o.depthM) || !(o.depthM > 0)) return fail(fmt::format("{} is {} m", what, o.depthM), what, "A depth is positive");
    if (!isSigma(o.sigmaM)) return badSigma(what, o.sigmaM);
    if (!measured.emplace(o.frame, o.point).second)
      return fail(fmt::format("{} is a duplicate of one before", what), what, "Delete one of the two");
  }
  return {};
}

Result<void> checkPrior(const Network& n, std::size_t i) {
  const PosePrior& prior = n.priors[i];
  const std::string what = fmt::format("pose prior {}", i + 1);
  if (!inside(prior.pose, n.poses)) return fail(fmt::format("{} belongs to no pose", what), what);
  if (!prior.bodyFromWorld.isFinite()) return notFinite(what);
  std::vector<int> known;
  for (int k = 0; k < 6; ++k) {
    if (!std::isfinite(prior.covariance[k][k]) || prior.covariance[k][k] < 0) return badSigma(what, prior.covariance[k][k]);
    if (prior.covariance[k][k] > 0) known.push_back(k);
  }
  Eigen::MatrixXd covariance(known.size(), known.size());
  for (std::size_t r = 0; r < known.size(); ++r)
    for (std::size_t c = 0; c < known.size(); ++c) covariance(r, c) = prior.covariance[known[r]][known[c]];
  if (!covariance.allFinite() || !covariance.isApprox(covariance.transpose()) ||
      covariance.llt().info() != Eigen::Success)
    return fail(fmt::format("The covariance of {} is not positive definite", what), what, "Give a symmetric covariance with correlations below one");
  return {};
}

Result<void> checkMotion(const Network& n) {
  for (std::size_t i = 0; i < n.priors.size(); ++i)
    if (const auto good = checkPrior(n, i); !good) return good;
  for (std::size_t i = 0; i < n.trajectories.size(); ++i) {
    const NetworkTrajectory& way = n.trajectories[i];
    const std::string what = fmt::format("trajectory {}", i + 1);
    if (way.timeSecs.size() < 2 || way.timeSecs.size() != way.bodyFromWorld.size())
      return fail(fmt::format("{} has {} times and {} poses", what, way.timeSecs.size(), way.bodyFromWorld.size()), what,
                  "Give two poses or more with a time each");
    for (std::size_t k = 0; k < way.timeSecs.size(); ++k) {
      if (!std::isfinite(way.timeSecs[k]) || !way.bodyFromWorld[k].isFinite()) return notFinite(what);
      if (k > 0 && !(way.timeSecs[k] > way.timeSecs[k - 1]))
        return fail(fmt::format("The times of {} do not increase at {} s", what, way.timeSecs[k]), what, "Sort its poses by time");
    }
    if (!isSigma(way.positionSigmaM)) return badSigma(what, way.positionSigmaM);
    if (!isSigma(way.attitudeSigmaRad)) return badSigma(what, way.attitudeSigmaRad);
    if (!std::isfinite(way.clockOffsetSecs)) return notFinite(what);
    for (const int pose : way.poses)
      if (!inside(pose, n.poses)) return fail(fmt::format("{} names a pose that does not exist", what), what);
  }
  for (std::size_t i = 0; i < n.smoothness.size(); ++i) {
    const NetworkSmoothness& s = n.smoothness[i];
    const std::string what = fmt::format("smoothness {}", i + 1);
    if (!isSigma(s.metresPerSecond2)) return badSigma(what, s.metresPerSecond2);
    if (!isSigma(s.radiansPerSecond2)) return badSigma(what, s.radiansPerSecond2);
    for (std::size_t k = 0; k < s.poses.size(); ++k) {
      if (!inside(s.poses[k], n.poses)) return fail(fmt::format("{} names a pose that does not exist", what), what);
      if (k > 0 && !(n.poses[s.poses[k]].timeSecs > n.poses[s.poses[k - 1]].timeSecs))
        return fail(fmt::format("The times of {} do not increase", what), what, "Give its poses in time order");
    }
  }
  return {};
}

}  // namespace

Result<void> checkNetwork(const Network& network) {
  if (network.frames.empty()) return fail("The network holds no frame", {}, "Add pictures with observations");
  for (const auto check : {checkFrames, checkPoints, checkObservations, checkMotion})
    if (const auto good = check(network); !good) return good;
  return {};
}

std::string unknownName(const Network& network, const NetworkLayout& layout, int block, int column) {
  static constexpr const char* centre[] = {"E", "N", "H"};
  static constexpr const char* axis[] = {"x", "y", "z"};
  const auto of = [&](const std::vector<int>& blocks) {
    const auto at = std::find(blocks.begin(), blocks.end(), block);
    return at == blocks.end() ? -1 : static_cast<int>(at - blocks.begin());
  };
  if (const int i = of(layout.poseBlock); i >= 0) {
    const std::string pose = quoted("pose", network.poses[i].name, i);
    return column < 3 ? fmt::format("the centre's {} of {}", centre[column], pose)
                      : fmt::format("the rotation about {} of {}", axis[column - 3], pose);
  }
  if (const int i = of(layout.mountBlock); i >= 0) {
    const std::string mount = quoted("mount", network.mounts[i].name, i);
    return column < 3 ? fmt::format("the offset along {} of {}", axis[column], mount)
                      : fmt::format("the rotation about {} of {}", axis[column - 3], mount);
  }
  if (const int i = of(layout.cameraBlock); i >= 0) {
    const CameraModel model = network.cameras[i].intrinsics.model;
    const int beyond = column - VaryingCamera(network.cameras[i].intrinsics).focalCount();
    const std::string what = beyond < 0 ? "the focal length"
                             : beyond < 2 ? fmt::format("the principal point's {}", axis[beyond])
                                          : fmt::format("the distortion's {}", parameterNames(model)[column]);
    return fmt::format("{} of {}", what, quoted("camera", network.cameras[i].name, i));
  }
  return fmt::format("the clock offset of trajectory {}", of(layout.clockBlock) + 1);
}

}  // namespace alidade

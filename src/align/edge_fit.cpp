// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/edge_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include <opencv2/imgproc.hpp>

#include "align/pose_search.h"
#include "align/row_photo.h"
#include "base/parallel.h"

namespace alidade {

namespace {

constexpr int kCellPx = 6;
constexpr float kLeastEdge = 90, kLeastFound = 70;
constexpr double kTensorPx = 2;
/// Gradients across an edge to those along it, at least.
constexpr float kLeastCoherence = 0.6f;
/// The surface in front ends at most so far beside the edge.
constexpr int kNearPx = 3;
constexpr double kStepPx = 0.5;
constexpr double kNoisePx = 0.5;
constexpr std::array<double, 4> kReachPx = {6, 4, 3, 2};
constexpr int kDraws = 3;
/// Other poses that are tried at each draw: this many, off by this much at the sites, one standard deviation.
constexpr int kOthers = 3000;
constexpr std::array<double, kDraws> kOthersPx = {8, 4, 4};
constexpr double kRangeSigmas = 2.4;
/// Poses nearer to each other than this are one.
constexpr double kApartPx = 4;

/// A place on an edge of the drawn surfaces.
struct EdgeSite {
  glm::dvec2 pixel, across;
  glm::dvec3 world;
  glm::dvec2 offset{0};  ///< of a rolling shutter's photo, MiddleRowPhoto::offsetOf()
};

/// Of three samples a step apart, the middle one the largest: where between -1/2 and 1/2 the parabola through them peaks.
double peakOf(float before, float here, float after) {
  const float bend = before - 2 * here + after;
  return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
}

bool within(const Image<float>& image, const glm::dvec2& at) {
  return at.x >= 1 && at.y >= 1 && at.x < image.width() - 2 && at.y < image.height() - 2;
}

/// The edge belongs to the surface in front.
float nearestAcross(const DepthImage& depth, const glm::dvec2& pixel, const glm::dvec2& across) {
  float nearest = 0;
  for (int k = -kNearPx; k <= kNearPx; ++k) {
    const glm::ivec2 at(glm::round(pixel + static_cast<double>(k) * across));
    if (at.x < 0 || at.y < 0 || at.x >= depth.width() || at.y >= depth.height()) continue;
    const float z = depth.at(at.x, at.y);
    if (z > 0 && (nearest == 0 || z < nearest)) nearest = z;
  }
  return nearest;
}

/// The strongest place of each cell that lies on one straight edge.
std::vector<EdgeSite> sitesOf(const ScanView& view, const Camera& camera, const RigidTransform& cameraFromWorld) {
  const Image<float>& edges = view.luma;
  const cv::Mat strength(edges.height(), edges.width(), CV_32F, const_cast<float*>(edges.data()));
  cv::Mat dx, dy, xx, xy, yy;
  cv::Scharr(strength, dx, CV_32F, 1, 0, 1.0 / 32);
  cv::Scharr(strength, dy, CV_32F, 0, 1, 1.0 / 32);
  cv::GaussianBlur(dx.mul(dx), xx, {}, kTensorPx);
  cv::GaussianBlur(dx.mul(dy), xy, {}, kTensorPx);
  cv::GaussianBlur(dy.mul(dy), yy, {}, kTensorPx);
  const RigidTransform worldFromCamera = cameraFromWorld.inverse();
  std::vector<EdgeSite> sites;
  for (int top = kCellPx; top + 2 * kCellPx < edges.height(); top += kCellPx)
    for (int left = kCellPx; left + 2 * kCellPx < edges.width(); left += kCellPx) {
      glm::ivec2 best(left, top);
      for (int y = top; y < top + kCellPx; ++y)
        for (int x = left; x < left + kCellPx; ++x)
          if (view.covered.at(x, y) && edges.at(x, y) > edges.at(best.x, best.y)) best = {x, y};
      if (edges.at(best.x, best.y) < kLeastEdge || !view.covered.at(best.x, best.y)) continue;
      const float a = xx.at<float>(best.y, best.x), b = xy.at<float>(best.y, best.x), c = yy.at<float>(best.y, best.x);
      const float root = std::hypot(a - c, 2 * b);
      if (root < kLeastCoherence * (a + c)) continue;
      const double angle = 0.5 * std::atan2(2 * b, a - c);
      const glm::dvec2 across(std::cos(angle), std::sin(angle));
      const float before = sampled(edges, glm::dvec2(best) - across), here = edges.at(best.x, best.y), after = sampled(edges, glm::dvec2(best) + across);
      if (before > here || after > here) continue;
      const glm::dvec2 pixel = glm::dvec2(best) + peakOf(before, here, after) * across;
      const float depth = nearestAcross(view.depth, pixel, across);
      const auto direction = camera.unproject(pixel);
      if (depth > 0 && direction) sites.push_back({pixel, across, worldFromCamera * (*direction * static_cast<double>(depth))});
    }
  return sites;
}

/// Where along `across` the photo has its edge: the strongest peak, one nearby before one far off.
std::optional<double> edgeAlong(const Image<float>& photo, const glm::dvec2& from, const glm::dvec2& across, double reachPx) {
  const int steps = static_cast<int>(reachPx / kStepPx);
  if (!within(photo, from + (reachPx + kStepPx) * across) || !within(photo, from - (reachPx + kStepPx) * across)) return std::nullopt;
  const auto at = [&](int i) { return sampled(photo, from + i * kStepPx * across); };
  std::optional<double> best;
  double bestScore = 0;
  for (int i = -steps; i <= steps; ++i) {
    const float before = at(i - 1), here = at(i), after = at(i + 1);
    if (here < kLeastFound || before > here || after >= here) continue;
    const double along = (i + peakOf(before, here, after)) * kStepPx;
    const double score = here * (1 - 0.5 * std::abs(along) / reachPx);
    if (score > bestScore) bestScore = score, best = along;
  }
  return best;
}

/// Where the photo should show a site, if it does.
std::optional<glm::dvec2> placeOf(const EdgeSite& site, const PictureLevel& level, const glm::dvec3& pInCamera) {
  const auto pixel = pInCamera.z > 0 ? level.camera.project(pInCamera) : std::nullopt;
  if (!pixel || !within(level.luma, *pixel + site.offset)) return std::nullopt;
  return *pixel + site.offset;
}

/// Looks for the sites around where the pose puts them.
void find(const std::vector<EdgeSite>& sites, const PictureLevel& level, const MiddleRowPhoto& photo, const RigidTransform& pose,
          double reachPx, FineFit& fit) {
  fit.places.clear(), fit.anchorOf.clear(), fit.correlation.clear();
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const EdgeSite& site = sites[i];
    const glm::dvec3 p = pose * site.world;
    const auto pixel = placeOf(site, level, p);
    const auto along = pixel ? edgeAlong(photo.luma(), *pixel, site.across, reachPx) : std::nullopt;
    if (!along) continue;
    const glm::dvec2 seen = *pixel + *along * site.across;
    fit.anchorOf.push_back(static_cast<int>(i));
    fit.correlation.push_back(sampled(photo.luma(), seen) / 255);
    fit.places.push_back({site.world, photo.middlePixel(seen, p), glm::outerProduct(site.across, site.across) / (kNoisePx * kNoisePx), blockOf(site.pixel, level.luma)});
  }
}

/// Mean strength of the photo's edges where the pose puts the sites, 0..255.
double scoreOf(const std::vector<EdgeSite>& sites, const PictureLevel& level, const MiddleRowPhoto& photo, const RigidTransform& pose) {
  double sum = 0;
  for (const EdgeSite& site : sites)
    if (const auto pixel = placeOf(site, level, pose * site.world)) sum += sampled(photo.luma(), *pixel);
  return sites.empty() ? 0 : sum / static_cast<double>(sites.size());
}

struct Others {
  RigidTransform best;
  double score = 0;       ///< of the best
  double asideScore = 0;  ///< of the best that lies aside of the best
  double chance = 0;      ///< mean score
};

bool isWithin(const RigidTransform& pose, const PoseKnowledge& known) {
  return glm::distance(pose.centre(), known.cameraFromWorld.centre()) <= kRangeSigmas * known.positionSigmaM &&
         rotationAngleBetween(pose, known.cameraFromWorld) <= kRangeSigmas * known.rotationSigmaRad;
}

/// Many poses around one, not beyond the range, by how the photo's edges agree with the sites there. Fixed seed.
Others tryOthers(const std::vector<EdgeSite>& sites, const PictureLevel& level, const MiddleRowPhoto& photo, const RigidTransform& pose,
                 double deviationPx, const PoseKnowledge& known) {
  std::vector<glm::dvec3> world;
  std::vector<double> depths;
  for (std::size_t i = 0; i < sites.size(); i += std::max<std::size_t>(1, sites.size() / 200)) {
    world.push_back(sites[i].world);
    depths.push_back((pose * sites[i].world).z);
  }
  Others found{pose, scoreOf(sites, level, photo, pose), 0};
  if (depths.empty()) return found;
  std::nth_element(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2), depths.end());
  const double radians = deviationPx / level.camera.intrinsics().fx, metres = radians * depths[depths.size() / 2];
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  std::vector<RigidTransform> poses(kOthers);
  for (RigidTransform& other : poses) {
    const glm::dvec3 turn(radians * normal(random), radians * normal(random), radians * normal(random));
    other.rotation = glm::normalize(glm::dquat(1, 0.5 * turn) * pose.rotation);
    const glm::dvec3 shift(metres * normal(random), metres * normal(random), metres * normal(random));
    other.translation = -(other.rotation * (pose.centre() + shift));
    other = withLocked(other, known);
  }
  std::vector<double> scores(poses.size());
  parallelFor(poses.size(), 16, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) scores[i] = scoreOf(sites, level, photo, poses[i]);
  });
  found.chance = std::accumulate(scores.begin(), scores.end(), 0.0) / static_cast<double>(scores.size());
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (scores[i] > found.score && isWithin(poses[i], known)) found.best = poses[i], found.score = scores[i];
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (scores[i] > found.asideScore && distancePx(world, level.camera, poses[i], found.best) > kApartPx) found.asideScore = scores[i];
  return found;
}

}  // namespace

FineFit fitEdges(const AlignmentScene& scene, const PictureLevel& level, const RigidTransform& cameraFromWorld,
                 const PoseKnowledge& known) {
  FineFit fit;
  RigidTransform pose = cameraFromWorld;
  for (int draw = 0; draw < kDraws; ++draw) {
    fit.drawnAt = pose;
    fit.view = drawScanView(scene, level.camera, pose);
    std::vector<EdgeSite> sites = sitesOf(fit.view, level.camera, pose);
    const MiddleRowPhoto photo(level, fit.view);
    for (EdgeSite& site : sites) site.offset = photo.offsetOf(pose * site.world);
    fit.photo = photo.luma();
    std::vector<glm::dvec3> world;
    fit.anchors.clear();
    for (const EdgeSite& site : sites) {
      Anchor anchor;
      anchor.patch.at = glm::ivec2(glm::round(site.pixel));
      anchor.world = site.world;
      fit.anchors.push_back(std::move(anchor));
      world.push_back(site.world);
    }
    const Others others = tryOthers(sites, level, photo, pose, kOthersPx[draw], known);
    pose = others.best;
    for (const double reachPx : kReachPx) {
      if (draw > 0 && reachPx > kReachPx[2]) continue;
      find(sites, level, photo, pose, reachPx, fit);
      fit.estimate = estimatePose(level.camera, pose, fit.places, known);
      if (!fit.estimate) return fit;
      pose = fit.estimate->cameraFromWorld;
    }
    fit.score = scoreOf(sites, level, photo, pose) - others.chance;
    fit.asideScore = (others.asideScore - others.chance) / std::max(1e-9, fit.score);
    fit.movedPx = distancePx(world, level.camera, fit.drawnAt, pose);
  }
  return fit;
}

}  // namespace alidade

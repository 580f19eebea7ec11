// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/auto_align.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "align/edge_fit.h"
#include "align/edges.h"
#include "align/evidence.h"
#include "align/fine_fit.h"
#include "align/level_fit.h"
#include "align/row_photo.h"

namespace alidade {

namespace {

constexpr int kWidestPx = 1920;
constexpr int kCoarsestPx = 110;
constexpr double kFinestSpacingPx = 2.6;
constexpr double kLeastCoverage = 0.02;
constexpr double kDarkest = 12, kLeastContrast = 4;
constexpr int kSamples = 16384;
constexpr double kApartPx = 3;
/// Parallax over the whole range, in pixels of the coarsest level, that patches survive.
constexpr double kParallaxPx = 9;
constexpr int kFineRounds = 5;
constexpr int kHalf = 10;
constexpr double kStillPx = 0.05;
constexpr std::size_t kCandidates = 6;
constexpr double kRangeShare = 1.2;
constexpr std::size_t kEdgeChoiceLevel = 2;

double meanOf(const Image<float>& luma) {
  double sum = 0;
  for (std::size_t i = 0; i < luma.size(); ++i) sum += luma.data()[i];
  return sum / static_cast<double>(luma.size());
}

double deviationOf(const Image<float>& luma, double mean) {
  double sum = 0;
  for (std::size_t i = 0; i < luma.size(); ++i) sum += (luma.data()[i] - mean) * (luma.data()[i] - mean);
  return std::sqrt(sum / static_cast<double>(luma.size()));
}

/// The share's smallest depth in view; nothing where nothing is in view.
std::optional<double> depthAt(const ScanView& view, double share) {
  std::vector<float> depths;
  for (std::size_t i = 0; i < view.depth.size(); ++i)
    if (view.depth.data()[i] > 0) depths.push_back(view.depth.data()[i]);
  if (static_cast<double>(depths.size()) < kLeastCoverage * static_cast<double>(view.depth.size())) return std::nullopt;
  const auto at = depths.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(depths.size() - 1));
  std::nth_element(depths.begin(), at, depths.end());
  return *at;
}

RigidTransform shifted(const RigidTransform& pose, const glm::dvec3& inCamera) {
  RigidTransform to = pose;
  to.translation -= inCamera;
  return to;
}

struct Tried {
  RigidTransform pose;
  double score = 0;
};

class Aligner {
 public:
  Aligner(const AlignmentScene& scene, const ColourImage& photo, const Camera& camera, const RigidTransform& start,
          const AlignmentOptions& options, const Progress& progress)
      : m_scene(scene), m_photo(photo), m_camera(camera), m_start(start), m_options(options), m_progress(progress) {}

  Result<AlignmentSummary> run() {
    if (auto ready = prepare(); !ready) return fail(ready.error());
    std::vector<PoseCandidate> candidates;
    if (m_options.startIsNear) candidates.push_back({m_start, 1});
    else candidates = searchAll();
    if (m_progress.cancelled()) return fail(cancelledError());
    AlignmentSummary summary;
    summary.startCameraFromWorld = summary.cameraFromWorld = m_start;
    summary.levelScale = m_levels.back().scale;
    if (candidates.empty() && m_scene.hasColour()) {
      summary.reason = "no place of the scene could be found in the picture";
      return summary;
    }
    const std::vector<Tried> tried = tryCandidates(candidates);
    if (!m_scene.hasColour()) return fitByEdges(tried, std::move(summary));
    if (tried.empty()) {
      summary.reason = "no pose within the range brings the scene and the picture together";
      return summary;
    }
    RigidTransform pose = tried.front().pose;
    if (tried.size() > 1) summary.evidence.rivalScore = tried[1].score / std::max(1e-9, tried.front().score);
    for (std::size_t level = 1; level < m_levels.size(); ++level) {
      m_progress.report(0.3 + 0.4 * static_cast<double>(level) / static_cast<double>(m_levels.size()), "Fitting the picture");
      if (m_progress.cancelled()) return fail(cancelledError());
      const LevelFit fit = fitLevel(m_scene, m_levels[level], pose, optionsAt(level));
      if (fit.resection.converged) pose = fit.resection.cameraFromWorld;
    }
    auto fit = fitFinely(pose, kHalf);
    if (!fit) return fail(fit.error());
    // Large patches find what is blurred; small ones are the surer where they do.
    if (!fit->estimate || fit->estimate->changePx * m_levels.back().scale > 0.3 * m_options.acceptedPx) {
      auto wide = fitFinely(pose, 2 * kHalf);
      if (!wide) return fail(wide.error());
      if (wide->estimate && (!fit->estimate || wide->estimate->changePx < fit->estimate->changePx)) fit = std::move(wide);
    }
    m_progress.report(0.92, "Checking the pose");
    judge(*fit, m_levels.back(), m_options, summary);
    m_progress.report(1, "Aligned");
    return summary;
  }

 private:
  Result<void> prepare() {
    if (auto valid = m_options.validate(); !valid) return valid;
    if (m_photo.width() != m_camera.width() || m_photo.height() != m_camera.height())
      return fail(fmt::format("The picture has {}×{} pixels, its calibration is for {}×{}", m_photo.width(), m_photo.height(),
                              m_camera.width(), m_camera.height()),
                  {}, "Use the calibration of this picture size");
    if (m_scene.empty()) return fail("There is no scan and no design to align the picture with", {}, "Add a scan of what the picture shows, and make it visible");
    m_levels = picturePyramid(m_photo, m_camera, kWidestPx, kCoarsestPx);
    // The rows' poses are shares of the picture's height apart: the same at every size.
    for (PictureLevel& level : m_levels) level.shutter = m_options.shutter;
    const double mean = meanOf(m_levels.front().luma), deviation = deviationOf(m_levels.front().luma, mean);
    if (mean < kDarkest) return fail(fmt::format("The picture is too dark to align: mean brightness {:.0f} of 255", mean), {}, "Take a brighter picture, or pick points by hand");
    if (deviation < kLeastContrast) return fail("The picture shows no edges: its brightness hardly varies", {}, "Take a picture of something with structure, or pick points by hand");
    if (!m_scene.hasColour())
      for (PictureLevel& level : m_levels) level.luma = photoEdges(level.luma);
    m_firstView = drawScanView(m_scene, m_levels.front().camera, m_start);
    const auto near = depthAt(m_firstView, 0.1), middle = depthAt(m_firstView, 0.5);
    if (!near) return fail("Nothing of the scene is in view of this pose", {}, "Check the pose and the scan's coordinate system, or give a better start");
    m_nearM = *near;
    const double focal = m_camera.intrinsics().fx;
    const double spacingPx = m_scene.spacingM() * focal / *middle;
    // Sizes at which points would lie far apart tell nothing more.
    while (m_levels.size() > 2 && spacingPx / m_levels.back().scale > kFinestSpacingPx) m_levels.pop_back();
    return {};
  }

  ResectionOptions resectionOptions() const {
    ResectionOptions options;
    options.lockPosition = m_options.lockPosition;
    options.lockAttitude = m_options.lockAttitude;
    return options;
  }

  LevelFitOptions optionsAt(std::size_t level) const {
    LevelFitOptions options;
    options.resection = resectionOptions();
    options.half = 8;
    options.cellPx = std::max(10, m_levels[level].camera.width() / 32);
    options.radiusPx = 6;
    return options;
  }

  FineFitOptions fineOptions(int round, int half, double blurPx) const {
    FineFitOptions options;
    options.known = knowledgeOf(m_start, m_options);
    options.half = half, options.blurPx = blurPx;
    options.radiusPx = round == 0 ? 4 : 3;
    return options;
  }

  bool isWithinRange(const RigidTransform& pose) const {
    return glm::distance(pose.centre(), m_start.centre()) <= kRangeShare * m_options.range.positionM &&
           rotationAngleBetween(pose, m_start) <= kRangeShare * m_options.range.rotationRad;
  }

  /// From size to size by edges; at the smaller sizes all candidates and the start, of which the best goes on.
  Result<AlignmentSummary> fitByEdges(std::vector<Tried> tried, AlignmentSummary summary) const {
    const PoseKnowledge known = knowledgeOf(m_start, m_options);
    tried.push_back({m_start});
    const std::size_t choose = std::min(kEdgeChoiceLevel, m_levels.size() - 1);
    FineFit fit;
    for (std::size_t level = 1; level < m_levels.size(); ++level) {
      m_progress.report(0.3 + 0.6 * static_cast<double>(level) / static_cast<double>(m_levels.size()), "Fitting the edges");
      std::vector<glm::dvec3> world;
      for (Tried& candidate : tried) {
        if (m_progress.cancelled()) return fail(cancelledError());
        fit = fitEdges(m_scene, m_levels[level], candidate.pose, known);
        candidate.score = fit.estimate && isWithinRange(fit.estimate->cameraFromWorld) ? fit.score : 0;
        if (fit.estimate) candidate.pose = fit.estimate->cameraFromWorld;
        if (world.empty())
          for (const Anchor& anchor : fit.anchors) world.push_back(anchor.world);
      }
      if (level != choose) continue;
      keepApart(tried, world, m_levels[level].camera);
      if (tried.size() > 1) summary.evidence.rivalScore = tried[1].score / std::max(1e-9, tried.front().score);
      tried.resize(1);
    }
    m_progress.report(0.92, "Checking the pose");
    judge(fit, m_levels.back(), m_options, summary);
    m_progress.report(1, "Aligned");
    return summary;
  }

  /// Rounds at the finest level until the pose stands still.
  Result<FineFit> fitFinely(RigidTransform pose, int half) const {
    FineFit fit;
    for (int round = 0; round < kFineRounds; ++round) {
      m_progress.report(0.7 + 0.04 * round, "Fitting the picture");
      if (m_progress.cancelled()) return fail(cancelledError());
      fit = fineFit(m_scene, m_levels.back(), pose, fineOptions(round, half, round == 0 ? -1 : fit.blurPx));
      if (!fit.estimate) break;
      pose = fit.estimate->cameraFromWorld;
      if (fit.movedPx < kStillPx) break;
    }
    return fit;
  }

  std::vector<PoseCandidate> searchAll() {
    const PictureLevel& level = m_levels.front();
    const double focal = level.camera.intrinsics().fx;
    std::vector<glm::dvec3> centres = {{0, 0, 0}};
    if (focal * m_options.range.positionM / m_nearM > kParallaxPx && !m_options.lockPosition[0]) {
      const double off = 0.6 * m_options.range.positionM;
      for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-off, off}) {
          glm::dvec3 centre(0);
          centre[axis] = side;
          centres.push_back(centre);
        }
    }
    std::vector<PoseCandidate> all;
    for (const glm::dvec3& centre : centres) {
      m_progress.report(0.3 * static_cast<double>(all.size()) / (4.0 * static_cast<double>(centres.size())), "Searching the pose");
      if (m_progress.cancelled()) return {};
      const RigidTransform pose = shifted(m_start, centre);
      const ScanView view = drawScanView(m_scene, level.camera, pose);
      const std::vector<Anchor> anchors = anchorsOf(view, level.camera, pose, 7, 10);
      for (PoseCandidate& found : searchPoses(anchors, MiddleRowPhoto(level, view).luma(), level.camera, m_start, m_options.range,
                                              kSamples / static_cast<int>(centres.size() > 1 ? 2 : 1), 4, kApartPx))
        all.push_back(found);
    }
    return all;
  }

  /// Best first, none nearer to a better one than kApartPx.
  static void keepApart(std::vector<Tried>& tried, const std::vector<glm::dvec3>& world, const Camera& camera) {
    std::stable_sort(tried.begin(), tried.end(), [](const Tried& a, const Tried& b) { return a.score > b.score; });
    std::vector<Tried> kept;
    for (const Tried& one : tried)
      if (std::all_of(kept.begin(), kept.end(), [&](const Tried& better) { return distancePx(world, camera, one.pose, better.pose) > kApartPx; }))
        kept.push_back(one);
    tried = std::move(kept);
  }

  /// Fits the candidates at the coarsest level, drawn from where they stand; by how well the fits agree, best first.
  std::vector<Tried> tryCandidates(std::vector<PoseCandidate>& candidates) const {
    if (m_options.startIsNear) return {{m_start, 1}};
    std::sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
    if (candidates.size() > kCandidates) candidates.resize(kCandidates);
    std::vector<Tried> tried;
    std::vector<glm::dvec3> world;
    for (const PoseCandidate& candidate : candidates) {
      RigidTransform pose = withLocked(candidate.cameraFromWorld, knowledgeOf(m_start, m_options));
      LevelFit fit;
      for (int round = 0; round < 2; ++round) {
        LevelFitOptions options;
        options.resection = resectionOptions();
        options.cellPx = 8, options.half = 6, options.radiusPx = 4;
        fit = fitLevel(m_scene, m_levels.front(), pose, options);
        if (!fit.resection.converged) break;
        pose = fit.resection.cameraFromWorld;
      }
      if (!fit.resection.converged) continue;
      if (world.empty())
        for (const Anchor& anchor : fit.anchors) world.push_back(anchor.world);
      tried.push_back({pose, fit.score()});
    }
    keepApart(tried, world, m_levels.front().camera);
    return tried;
  }

  const AlignmentScene& m_scene;
  const ColourImage& m_photo;
  const Camera& m_camera;
  const RigidTransform& m_start;
  const AlignmentOptions& m_options;
  const Progress& m_progress;
  std::vector<PictureLevel> m_levels;
  ScanView m_firstView;
  double m_nearM = 1;
};

}  // namespace

Result<void> AlignmentOptions::validate() const {
  if (!(range.rotationRad > 0 && range.rotationRad < 0.3)) return fail("The range of attitudes must lie between 0 and 17 degrees");
  if (!(range.positionM > 0 && range.positionM < 5)) return fail("The range of positions must lie between 0 and 5 m");
  if (!(acceptedPx > 0)) return fail("The accepted error must be more than 0 px");
  return {};
}

Result<AlignmentSummary> alignPicture(const AlignmentScene& scene, const ColourImage& photo, const Camera& camera,
                                      const RigidTransform& startCameraFromWorld, const AlignmentOptions& options,
                                      const Progress& progress) {
  return Aligner(scene, photo, camera, startCameraFromWorld, options, progress).run();
}

}  // namespace alidade

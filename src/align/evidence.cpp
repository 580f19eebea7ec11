// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "align/row_photo.h"

namespace alidade {

namespace {

constexpr int kBins = 32;
/// Root mean square to 95 % of a distance in the plane: sqrt(5.99 / 2).
constexpr double k95 = 1.731;

// What is asked of a pose before it is believed.
constexpr int kLeastInliers = 25;
constexpr double kLeastAgreeing = 0.5;    // of what was found
constexpr double kLeastFound = 0.15;      // of the patches: the scene may have changed
constexpr double kLeastSpread = 0.5;
constexpr double kMostRival = 0.9;
constexpr double kMostAside = 0.79;  // of right poses up to 0.78, of wrong ones from 0.78
constexpr double kLeastAside = 0.15;  // of the margins of edges and information together: a wrong pose had 0.09, right ones of the same site 0.8

double entropy(const double* counts, int size, double total) {
  double sum = 0;
  for (int i = 0; i < size; ++i)
    if (counts[i] > 0) sum -= counts[i] / total * std::log(counts[i] / total);
  return sum;
}

/// Pixels of the raw picture a pixel of options.acceptedPx, which counts on at most 1920 across.
double countedScale(const PictureLevel& level, double rawWidth) {
  return level.scale / std::max(1.0, rawWidth / 1920.0);
}

bool counts(const FineFit& fit, std::size_t place) {
  return fit.estimate->weights[place] >= 0.5;
}

/// Share of the blocks with three anchors or more that hold places which agree.
double spreadOf(const FineFit& fit, const Image<float>& photo) {
  std::array<int, kBlockColumns * kBlockRows> offered{}, held{};
  for (const Anchor& anchor : fit.anchors)
    ++offered[static_cast<std::size_t>(blockOf(glm::dvec2(anchor.patch.at), photo))];
  for (std::size_t i = 0; i < fit.places.size(); ++i)
    if (counts(fit, i)) ++held[fit.places[i].block];
  int cells = 0, full = 0;
  for (std::size_t i = 0; i < offered.size(); ++i) cells += offered[i] >= 3, full += offered[i] >= 3 && held[i] >= 2;
  return cells == 0 ? 0 : static_cast<double>(full) / cells;
}

/// The poses from the white and from the black blocks of a chessboard, apart.
double halvesDistance(const FineFit& fit, const PictureLevel& level, const RigidTransform& start, const AlignmentOptions& options) {
  const PoseKnowledge known = knowledgeOf(start, options);
  std::array<RigidTransform, 2> poses;
  for (int colour = 0; colour < 2; ++colour) {
    std::vector<SeenPlace> half;
    for (std::size_t i = 0; i < fit.places.size(); ++i)
      if (counts(fit, i) && (fit.places[i].block % kBlockColumns + fit.places[i].block / kBlockColumns) % 2 == colour)
        half.push_back(fit.places[i]);
    const auto made = estimatePose(level.camera, fit.estimate->cameraFromWorld, half, known);
    if (!made) return 1e9;
    poses[colour] = made->cameraFromWorld;
  }
  std::vector<glm::dvec3> world;
  for (const Anchor& anchor : fit.anchors) world.push_back(anchor.world);
  return distancePx(world, level.camera, poses[0], poses[1]);
}

struct Check {
  double margin;  ///< 0 at the limit, 1 and more where it speaks clearly
  std::string says;
};

/// How far `value` lies beyond `least` on the way to `good`.
double margin(double value, double least, double good) {
  return (value - least) / (good - least);
}

}  // namespace

PoseKnowledge knowledgeOf(const RigidTransform& start, const AlignmentOptions& options) {
  PoseKnowledge known;
  known.cameraFromWorld = start;
  known.positionSigmaM = 0.5 * options.range.positionM, known.rotationSigmaRad = 0.5 * options.range.rotationRad;
  for (int i = 0; i < 3; ++i) known.locked[i] = options.lockPosition[i], known.locked[3 + i] = options.lockAttitude;
  return known;
}

double informationDistance(const ScanView& view, const Image<float>& photo, const glm::ivec2& shift) {
  std::vector<double> joint(kBins * kBins), a(kBins), b(kBins);
  double total = 0;
  for (int y = 0; y < photo.height(); ++y) {
    const int yy = y + shift.y;
    if (yy < 0 || yy >= photo.height()) continue;
    for (int x = 0; x < photo.width(); ++x) {
      const int xx = x + shift.x;
      if (xx < 0 || xx >= photo.width() || !view.covered.at(x, y)) continue;
      const auto bin = [](float light) { return std::clamp(static_cast<int>(light * (kBins / 256.0f)), 0, kBins - 1); };
      const int i = bin(view.luma.at(x, y)), j = bin(photo.at(xx, yy));
      ++joint[i * kBins + j], ++a[i], ++b[j], ++total;
    }
  }
  if (total == 0) return 1;
  const double together = entropy(joint.data(), kBins * kBins, total);
  const double each = entropy(a.data(), kBins, total) + entropy(b.data(), kBins, total);
  return together > 0 ? (2 * together - each) / together : 1;
}

void judge(const FineFit& fit, const PictureLevel& level, const AlignmentOptions& options, AlignmentSummary& summary) {
  AlignmentEvidence& e = summary.evidence;
  const double counted = countedScale(level, level.scale * level.camera.width());
  e.patches = static_cast<int>(fit.anchors.size());
  e.matched = static_cast<int>(fit.places.size());
  if (!fit.estimate) {
    summary.reason = fmt::format("of {} places of the scene only {} were found in the picture, too few for a pose", e.patches, e.matched);
    return;
  }
  summary.estimate = *fit.estimate;
  e.asideScore = fit.asideScore;
  const RigidTransform& pose = fit.estimate->cameraFromWorld;
  e.inliers = fit.estimate->counting();
  std::vector<double> correlations;
  for (std::size_t i = 0; i < fit.places.size(); ++i)
    if (counts(fit, i)) correlations.push_back(fit.correlation[i]);
  if (!correlations.empty()) {
    std::nth_element(correlations.begin(), correlations.begin() + static_cast<std::ptrdiff_t>(correlations.size() / 2), correlations.end());
    e.correlation = correlations[correlations.size() / 2];
  }
  e.spread = spreadOf(fit, level.luma);
  // By what parts of the scan disagree among themselves, all of it may be off; half of what edges do is how they are found.
  const double disagreePx = (fit.view.ofEdges ? 0.5 : 1) * fit.estimate->rmsPx;
  e.expectedPx = counted * k95 * std::hypot(fit.estimate->changePx, disagreePx);
  e.halvesPx = counted * halvesDistance(fit, level, summary.startCameraFromWorld, options);
  e.information = informationDistance(fit.view, fit.photo, {0, 0});
  e.informationAside = 1;
  const int aside = 3;
  for (const glm::ivec2 shift : {glm::ivec2(aside, 0), {-aside, 0}, {0, aside}, {0, -aside}, {2, 2}, {-2, 2}, {2, -2}, {-2, -2}})
    e.informationAside = std::min(e.informationAside, informationDistance(fit.view, fit.photo, shift));
  const glm::dvec3 moved = pose.centre() - summary.startCameraFromWorld.centre();
  const double turned = rotationAngleBetween(pose, summary.startCameraFromWorld);

  const double asideMargin = margin(-e.asideScore, -kMostAside, -0.6), informationMargin = margin(e.informationAside - e.information, 0, 0.01);
  const std::vector<Check> checks = {
      {margin(e.inliers, kLeastInliers, 100), fmt::format("only {} places of the scene agree with the picture", e.inliers)},
      {margin(static_cast<double>(e.inliers) / std::max(1, e.matched), kLeastAgreeing, 0.8),
       fmt::format("{} of {} places that were found contradict the pose", e.matched - e.inliers, e.matched)},
      {margin(static_cast<double>(e.inliers) / std::max(1, e.patches), kLeastFound, 0.4),
       fmt::format("of {} places of the scene only {} were found in the picture", e.patches, e.inliers)},
      {margin(e.spread, kLeastSpread, 0.8), "what agrees with the pose lies in one part of the picture"},
      {margin(-e.expectedPx, -options.acceptedPx, -0.3 * options.acceptedPx),
       fmt::format("the pose is known to {:.1f} px only, {:.1f} px are accepted", e.expectedPx, options.acceptedPx)},
      {margin(-e.halvesPx, -options.acceptedPx, -0.3 * options.acceptedPx),
       fmt::format("two halves of what was found give poses {:.1f} px apart", e.halvesPx)},
      {informationMargin, "the picture fits the scene no better than moved by a few pixels"},
      {margin(-e.rivalScore, -kMostRival, -0.6), "another pose fits nearly as well"},
      {asideMargin, "the edges fit nearly as well a few pixels aside"},
      {asideMargin + informationMargin - kLeastAside, "edges and picture both fit nearly as well a few pixels aside"},
      {margin(-glm::length(moved), -1.5 * options.range.positionM, -1.2 * options.range.positionM),
       fmt::format("it ended {:.2f} m from the start, beyond the range", glm::length(moved))},
      {margin(-turned, -1.5 * options.range.rotationRad, -1.2 * options.range.rotationRad), "it ended beyond the range of attitudes"}};
  const auto weakest = std::min_element(checks.begin(), checks.end(), [](const Check& x, const Check& y) { return x.margin < y.margin; });
  summary.confidence = std::clamp(weakest->margin, 0.0, 1.0);
  summary.converged = weakest->margin > 0;
  summary.reason = summary.converged ? "the scene and the picture agree" : weakest->says;
  if (!summary.converged) return;
  summary.cameraFromWorld = pose;
  for (std::size_t i = 0; i < fit.places.size(); ++i) {
    if (!counts(fit, i)) continue;
    SeenPlace seen = fit.places[i];
    if (level.shutter.isOn())
      seen.pixel = photoPixel(level.camera, level.shutter, seen.pixel, (pose * seen.world).z).value_or(seen.pixel);
    seen.pixel = level.scale * (seen.pixel + 0.5) - 0.5;
    seen.information /= level.scale * level.scale;
    summary.places.push_back(seen);
  }
}

std::string AlignmentSummary::report() const {
  const AlignmentEvidence& e = evidence;
  std::string text = converged ? fmt::format("Converged, confidence {:.0f} %\n", 100 * confidence) : fmt::format("Not converged: {}\n", reason);
  text += fmt::format("places of the scene   {} sought, {} found, {} agree\n", e.patches, e.matched, e.inliers);
  text += fmt::format("correlation           {:.2f} (median)\n", e.correlation);
  text += fmt::format("spread                {:.0f} % of the scene in view\n", 100 * e.spread);
  text += fmt::format("expected error        {:.2f} px (95 %)\n", e.expectedPx);
  text += fmt::format("two halves            {:.2f} px apart\n", e.halvesPx);
  text += fmt::format("information distance  {:.3f}, {:.3f} a few pixels aside\n", e.information, e.informationAside);
  if (converged) {
    const glm::dvec3 moved = cameraFromWorld.centre() - startCameraFromWorld.centre();
    text += fmt::format("moved                 {:.3f} {:.3f} {:.3f} m, turned {:.3f}°\n", moved.x, moved.y, moved.z,
                        rotationAngleBetween(cameraFromWorld, startCameraFromWorld) * 57.29577951308232);
  }
  return text;
}

}  // namespace alidade

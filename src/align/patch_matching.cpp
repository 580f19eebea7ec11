// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/patch_matching.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

namespace alidade {

namespace {

constexpr float kCoveredShare = 0.8f;
/// Root mean square of brightness below which a patch is plain.
constexpr float kLeastContrast = 2.0f;
/// A second place may come as near as this to the best one's correlation.
constexpr float kSecondBest = 0.97f;
constexpr int kIterations = 8;
/// Where nothing has two directions, a straight edge is better than a plain place.
constexpr float kEdgeShare = 0.02f;
constexpr double kSharedNoise = 2;
/// How firmly an edge's patch stays where it is along the edge.
constexpr double kHold = 0.02;
constexpr float kNearer = 0.02f;

std::optional<Patch> makePatch(const Image<float>& drawn, const Image<std::uint8_t>& covered, glm::ivec2 at, int half) {
  if (at.x < half || at.y < half || at.x + half >= drawn.width() || at.y + half >= drawn.height()) return std::nullopt;
  Patch patch;
  patch.at = at, patch.half = half;
  double sum = 0;
  for (int y = at.y - half; y <= at.y + half; ++y)
    for (int x = at.x - half; x <= at.x + half; ++x) {
      const float w = covered.at(x, y) ? 1.0f : 0.0f;
      patch.weight.push_back(w);
      patch.light.push_back(w * drawn.at(x, y));
      patch.weightSum += w, sum += w * drawn.at(x, y);
    }
  if (patch.weightSum < kCoveredShare * static_cast<float>(patch.weight.size())) return std::nullopt;
  const auto mean = static_cast<float>(sum / patch.weightSum);
  double squares = 0;
  for (std::size_t i = 0; i < patch.light.size(); ++i) {
    patch.light[i] = patch.weight[i] * (patch.light[i] - mean);
    squares += patch.light[i] * patch.light[i];
  }
  patch.norm = static_cast<float>(std::sqrt(squares));
  if (patch.norm < kLeastContrast * std::sqrt(patch.weightSum)) return std::nullopt;
  return patch;
}

float bilinear(const Image<float>& image, float x, float y) {
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float a = x - static_cast<float>(x0), b = y - static_cast<float>(y0);
  const float* top = image.row(y0) + x0;
  const float* low = image.row(y0 + 1) + x0;
  return (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * low[0] + a * low[1]);
}

/// photo(at + shift + o) = gain patch(o) + offset over the patch, by Gauss-Newton in shift, gain and offset.
///
/// Along a straight edge nothing holds the shift: `hold` times the trace of its normal matrix does.
std::optional<PatchPlace> refine(const Patch& patch, const Image<float>& photo, const glm::ivec2& start, double hold) {
  glm::dvec2 shift(start);
  const int side = 2 * patch.half + 1;
  const double reach = patch.half + 2;
  Eigen::Matrix4d normal;
  double squares = 0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const glm::dvec2 centre = glm::dvec2(patch.at) + shift;
    if (!(centre.x > reach && centre.y > reach && centre.x + reach + 1 < photo.width() && centre.y + reach + 1 < photo.height()))
      return std::nullopt;
    normal.setZero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    squares = 0;
    for (int i = 0; i < side * side; ++i) {
      if (patch.weight[i] == 0) continue;
      const auto x = static_cast<float>(centre.x + i % side - patch.half), y = static_cast<float>(centre.y + i / side - patch.half);
      const float light = bilinear(photo, x, y);
      const float gx = 0.5f * (bilinear(photo, x + 1, y) - bilinear(photo, x - 1, y));
      const float gy = 0.5f * (bilinear(photo, x, y + 1) - bilinear(photo, x, y - 1));
      const Eigen::Vector4d row(-gx, -gy, patch.light[i], 1);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
      right += light * row;
      squares += light * light;
    }
    Eigen::Matrix4d held = normal.selfadjointView<Eigen::Lower>();
    const double spring = hold * (normal(0, 0) + normal(1, 1)) + 1e-9;
    held(0, 0) += spring, held(1, 1) += spring;
    right[0] += spring * (start.x - shift.x), right[1] += spring * (start.y - shift.y);
    const Eigen::LDLT<Eigen::Matrix4d> factor(held);
    if (factor.info() != Eigen::Success || !factor.isPositive()) return std::nullopt;
    const Eigen::Vector4d step = factor.solve(right);
    if (!step.allFinite() || step[2] <= 0) return std::nullopt;
    shift += glm::dvec2(step[0], step[1]);
    if (glm::distance(shift, glm::dvec2(start)) > 1.5) return std::nullopt;
    squares = std::max(0.0, squares - right.dot(step));
    if (std::hypot(step[0], step[1]) > 0.01 && iteration + 1 < kIterations) continue;
    // A pixel of noise a grey value's rounding at least; neighbours share theirs.
    const double variance = std::max(1.0, kSharedNoise * squares / std::max(1.0f, patch.weightSum - 4));
    const Eigen::Matrix2d own = normal.topLeftCorner<2, 2>().selfadjointView<Eigen::Lower>();
    const Eigen::Matrix2d light = normal.bottomRightCorner<2, 2>().selfadjointView<Eigen::Lower>();
    const Eigen::Matrix2d mixed = normal.bottomLeftCorner<2, 2>().transpose();
    const Eigen::Matrix2d information = (own - mixed * light.inverse() * mixed.transpose()) / variance;
    const double mean = 0.5 * information.trace();
    const double weakest = mean - std::hypot(0.5 * (information(0, 0) - information(1, 1)), information(0, 1));
    const double explained = step[2] * step[2] * patch.norm * patch.norm;
    PatchPlace place;
    place.pixel = glm::dvec2(patch.at) + shift;
    place.correlation = std::sqrt(explained / (explained + squares + 1e-9));
    place.sigmaPx = 1 / std::sqrt(std::max(1e-9, weakest));
    place.information = glm::dmat2(information(0, 0), information(1, 0), information(0, 1), information(1, 1));
    return place;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Patch> choosePatches(const Image<float>& drawn, const Image<std::uint8_t>& covered, int half, int cellPx) {
  const cv::Mat light(drawn.height(), drawn.width(), CV_32F, const_cast<float*>(drawn.data()));
  cv::Mat eigen;
  cv::cornerEigenValsAndVecs(light, eigen, half | 1, 3);
  std::vector<Patch> patches;
  for (int cellY = 0; cellY < drawn.height(); cellY += cellPx)
    for (int cellX = 0; cellX < drawn.width(); cellX += cellPx) {
      // What is not covered holds no texture of the scene: the next best place is tried a few times.
      std::vector<std::pair<float, glm::ivec2>> places;
      for (int y = std::max(cellY, half); y < std::min(cellY + cellPx, drawn.height() - half); ++y)
        for (int x = std::max(cellX, half); x < std::min(cellX + cellPx, drawn.width() - half); ++x)
          if (covered.at(x, y)) {
            const auto& e = eigen.at<cv::Vec6f>(y, x);
            places.emplace_back(std::min(e[0], e[1]) + kEdgeShare * std::max(e[0], e[1]), glm::ivec2(x, y));
          }
      const std::size_t tries = std::min<std::size_t>(12, places.size());
      std::partial_sort(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(tries), places.end(),
                        [](const auto& a, const auto& b) { return a.first > b.first; });
      for (std::size_t i = 0; i < tries; ++i)
        if (auto patch = makePatch(drawn, covered, places[i].second, half)) {
          patches.push_back(std::move(*patch));
          break;
        }
    }
  return patches;
}

Image<float> correlate(const Patch& patch, const Image<float>& photo, int radius, const glm::ivec2& around) {
  const int side = 2 * radius + 1, width = 2 * patch.half + 1;
  Image<float> scores(side, side, -1.0f);
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      const int x0 = patch.at.x + around.x + dx - patch.half, y0 = patch.at.y + around.y + dy - patch.half;
      if (x0 < 0 || y0 < 0 || x0 + width > photo.width() || y0 + width > photo.height()) continue;
      float product = 0, sum = 0, squares = 0;
      for (int row = 0; row < width; ++row) {
        const float* p = photo.row(y0 + row) + x0;
        const float* light = patch.light.data() + static_cast<std::size_t>(row) * width;
        const float* weight = patch.weight.data() + static_cast<std::size_t>(row) * width;
        for (int i = 0; i < width; ++i) {
          const float b = weight[i] * p[i];
          product += light[i] * b, sum += b, squares += b * b;
        }
      }
      const float variance = squares - sum * sum / patch.weightSum;
      // A plain place of the photo matches nothing, whatever its noise resembles.
      if (variance < 1.0f * patch.weightSum) scores.at(dx + radius, dy + radius) = 0;
      else scores.at(dx + radius, dy + radius) = product / (patch.norm * std::sqrt(variance));
    }
  return scores;
}

std::optional<PatchPlace> findPatch(const Patch& patch, const Image<float>& photo, int radius, double least,
                                    const glm::ivec2& around) {
  const Image<float> scores = correlate(patch, photo, radius, around);
  const auto best = static_cast<std::size_t>(std::max_element(scores.data(), scores.data() + scores.size()) - scores.data());
  const int bx = static_cast<int>(best) % scores.width(), by = static_cast<int>(best) / scores.width();
  const float top = scores.data()[best];
  if (!(top >= least) || bx == 0 || by == 0 || bx + 1 == scores.width() || by + 1 == scores.height()) return std::nullopt;
  for (int y = 1; y + 1 < scores.height(); ++y)
    for (int x = 1; x + 1 < scores.width(); ++x)
      if (std::abs(x - bx) + std::abs(y - by) > 3 && scores.at(x, y) > kSecondBest * top) return std::nullopt;
  auto place = refine(patch, photo, around + glm::ivec2(bx - radius, by - radius), 0);
  if (!place || place->correlation < least) return std::nullopt;
  return place;
}

std::optional<PatchPlace> followPatch(const Patch& patch, const Image<float>& photo, int radius, double least,
                                      const glm::ivec2& around) {
  const Image<float> scores = correlate(patch, photo, radius, around);
  float top = -1;
  glm::ivec2 best(0);
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) {
      const float score = scores.at(x + radius, y + radius) - kNearer * static_cast<float>(x * x + y * y) / static_cast<float>(radius * radius);
      if (score > top) top = score, best = {x, y};
    }
  if (!(scores.at(best.x + radius, best.y + radius) >= least)) return std::nullopt;
  auto place = refine(patch, photo, around + best, kHold);
  if (!place || place->correlation < least) return std::nullopt;
  return place;
}

}  // namespace alidade

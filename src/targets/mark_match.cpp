// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "targets/mark_match.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "targets/patch.h"

namespace alidade {

namespace {

constexpr int kMaximumIterations = 30;
constexpr double kSettledPx = 1e-3;
/// A second place that correlates nearly as well makes a match a guess.
constexpr double kSecondBest = 0.92;

/// The reference patch as the other picture is expected to show it, one sample a pixel of that picture.
std::optional<cv::Mat1f> expectedLook(const Patch& reference, const glm::dvec2& at, const glm::dmat2& back, int radius) {
  cv::Mat1f look(2 * radius + 1, 2 * radius + 1);
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) {
      const glm::dvec2 from = at + back * glm::dvec2(x, y);
      if (!reference.holds(from)) return std::nullopt;
      look(y + radius, x + radius) = static_cast<float>(reference.sample(from));
    }
  return look;
}

/// What is searched: the pixels at most `reach` from the expected one that the picture has.
struct Area {
  cv::Mat1f grey;
  glm::dvec2 origin{0};

  Area(const ColourImage& picture, const glm::dvec2& about, int reach) {
    const auto clip = [](double v, int size) { return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(size))); };
    const int left = clip(std::round(about.x) - reach, picture.width()), right = clip(std::round(about.x) + reach + 1, picture.width());
    const int top = clip(std::round(about.y) - reach, picture.height()), bottom = clip(std::round(about.y) + reach + 1, picture.height());
    grey.create(bottom - top, right - left);
    origin = {left, top};
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) grey(y - top, x - left) = greyOf(picture.at(x, y));
  }
};

/// The pixel of the area where the middle of `look` fits best; nothing where two places compete.
std::optional<glm::dvec2> correlate(const cv::Mat1f& area, const cv::Mat1f& look, double& best) {
  cv::Mat1f scores;
  cv::matchTemplate(area, look, scores, cv::TM_CCOEFF_NORMED);
  cv::Point place;
  cv::minMaxLoc(scores, nullptr, &best, nullptr, &place);
  const int apart = look.cols / 2;
  double second = -1;
  for (int y = 0; y < scores.rows; ++y)
    for (int x = 0; x < scores.cols; ++x)
      if (std::abs(x - place.x) > apart || std::abs(y - place.y) > apart) second = std::max<double>(second, scores(y, x));
  if (second > kSecondBest * best) return std::nullopt;
  return glm::dvec2(place.x + apart, place.y + apart);
}

/// Least-squares matching: centre, 2×2 shape, contrast and brightness of the other picture's patch.
struct Matching {
  glm::dvec2 centre;
  glm::dmat2 shape;  ///< picture from reference
  double correlation = 0, sigmaPx = 0;

  bool run(const Patch& reference, const glm::dvec2& at, const Patch& picture, int radius);
};

bool Matching::run(const Patch& reference, const glm::dvec2& at, const Patch& picture, int radius) {
  using Vector8 = Eigen::Matrix<double, 8, 1>;
  using Matrix8 = Eigen::Matrix<double, 8, 8>;
  double gain = 1, shift = 0;
  for (int iteration = 0; iteration < kMaximumIterations; ++iteration) {
    Matrix8 normal = Matrix8::Zero();
    Vector8 right = Vector8::Zero();
    double squares = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
    int count = 0;
    for (int y = -radius; y <= radius; ++y)
      for (int x = -radius; x <= radius; ++x) {
        const glm::dvec2 offset(x, y), place = centre + shape * offset;
        if (!picture.holds(place, 1)) return false;
        const double a = reference.sample(at + offset), b = picture.sample(place);
        const double gx = 0.5 * (picture.sample(place + glm::dvec2(1, 0)) - picture.sample(place - glm::dvec2(1, 0)));
        const double gy = 0.5 * (picture.sample(place + glm::dvec2(0, 1)) - picture.sample(place - glm::dvec2(0, 1)));
        Vector8 row;
        row << gx, gy, gx * x, gx * y, gy * x, gy * y, -a, -1.0;
        const double miss = gain * a + shift - b;
        normal += row * row.transpose();
        right += row * miss;
        squares += miss * miss, ++count;
        sa += a, sb += b, saa += a * a, sbb += b * b, sab += a * b;
      }
    const double spread = (saa - sa * sa / count) * (sbb - sb * sb / count);
    correlation = spread > 0 ? (sab - sa * sb / count) / std::sqrt(spread) : 0;
    const Eigen::LDLT<Matrix8> solver(normal);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0)) return false;
    const Vector8 step = solver.solve(right);
    if (!step.allFinite()) return false;
    centre += glm::dvec2(step[0], step[1]);
    shape += glm::dmat2(step[2], step[4], step[3], step[5]);
    gain += step[6], shift += step[7];
    if (glm::length(glm::dvec2(step[0], step[1])) > kSettledPx) continue;
    const Matrix8 inverse = solver.solve(Matrix8::Identity());
    sigmaPx = std::sqrt(0.5 * (inverse(0, 0) + inverse(1, 1)) * squares / std::max(1, count - 8));
    return true;
  }
  return false;
}

}  // namespace

Result<void> MarkMatchOptions::validate() const {
  if (radiusPx < 3 || radiusPx > 100) return fail("The patch's radius must be 3 to 100 px", "radiusPx");
  if (searchPx < 1 || searchPx > 1000) return fail("The search must reach 1 to 1000 px", "searchPx");
  if (!(leastCorrelation > 0 && leastCorrelation < 1)) return fail("The least correlation must lie between 0 and 1", "leastCorrelation");
  return {};
}

Result<MarkMatch> matchMark(const ColourImage& reference, const glm::dvec2& at, const ColourImage& picture,
                            const glm::dvec2& expected, const glm::dmat2& shape, const MarkMatchOptions& options) {
  if (auto valid = options.validate(); !valid) return fail(valid.error());
  if (!std::isfinite(expected.x) || !std::isfinite(expected.y)) return fail("The place is expected nowhere in the other picture");
  const double scale = std::sqrt(std::abs(glm::determinant(shape)));
  constexpr double largestChange = 4;
  if (!(scale > 1 / largestChange && scale < largestChange))
    return fail(fmt::format("The other picture shows this {} times as large", scale), {}, "Match between pictures taken from nearer each other");
  const int radius = options.radiusPx;
  const auto whole = cutPatch(reference, at, static_cast<int>(std::ceil(radius * std::max(1.0, 1.5 / scale))) + 2);
  if (!whole) return fail(whole.error());
  const auto look = expectedLook(*whole, at, glm::inverse(shape), radius);
  if (!look) return fail("The two pictures show this place in too different ways", {}, "Pick it by hand");
  const Area area(picture, expected, options.searchPx + radius);
  if (area.grey.cols < look->cols || area.grey.rows < look->rows)
    return fail("The place is expected outside the other picture", {}, "Choose another picture");
  double score = 0;
  const auto place = correlate(area.grey, *look, score);
  if (!place) return fail("Several places look like this one", {}, "Pick it by hand");
  if (score < options.leastCorrelation)
    return fail(fmt::format("Nothing within {} px looks like it (correlation {:.2f})", options.searchPx, score), {}, "Pick it by hand");
  const glm::dvec2 coarse = area.origin + *place;
  const auto near = cutPatch(picture, coarse, static_cast<int>(std::ceil(radius * std::max(1.0, 1.5 * scale))) + 4);
  if (!near) return fail(near.error());
  Matching matching{coarse, shape};
  const bool settled = matching.run(*whole, at, *near, radius);
  constexpr double farthestPx = 3;
  if (!settled || matching.correlation < options.leastCorrelation || glm::length(matching.centre - coarse) > farthestPx)
    return fail("The place cannot be matched to a fraction of a pixel", {}, "Pick it by hand");
  return MarkMatch{matching.centre, matching.sigmaPx, matching.correlation};
}

}  // namespace alidade

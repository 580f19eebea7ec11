// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "targets/mark.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "targets/patch.h"

namespace alidade {

namespace {

constexpr int kMaximumIterations = 20;
constexpr double kSettledPx = 1e-3;
/// Isotropy 4 det / trace² of the structure tensor (Förstner's q): 0 for one straight edge, 1 for directions in balance.
constexpr double kLeastRoundness = 0.25;
/// Mean squared gradient, (grey values of 255 a pixel)², that noise of two grey values stays below.
constexpr double kLeastGradient = 4.0;

/// What the gradients of a window say of one of the two shapes.
struct Fit {
  glm::dvec2 point{0};
  double residual = 0;  ///< weighted sum of squares, (grey values)²
  glm::dmat2 normal{0};
};

/// Every gradient gives one line: along the edge through its pixel (corner), or across it (centre).
Fit fitLines(const Gradients& gradients, const glm::dvec2& about, double sigma, bool across) {
  Fit fit;
  glm::dvec2 right(0);
  const auto each = [&](auto&& use) {
    for (int y = 0; y < gradients.side; ++y)
      for (int x = 0; x < gradients.side; ++x) {
        const glm::dvec2 at = gradients.origin + glm::dvec2(x, y);
        const glm::dvec2 from = at - about;
        const double weight = std::exp(-0.5 * glm::dot(from, from) / (sigma * sigma));
        const glm::dvec2 g = gradients.at(x, y);
        use(across ? glm::dvec2(-g.y, g.x) : g, from, weight);
      }
  };
  each([&](const glm::dvec2& n, const glm::dvec2& from, double weight) {
    const glm::dmat2 outer = glm::outerProduct(n, n);
    fit.normal += weight * outer;
    right += weight * (outer * from);
  });
  const glm::dvec2 shift = glm::inverse(fit.normal) * right;
  fit.point = about + shift;
  each([&](const glm::dvec2& n, const glm::dvec2& from, double weight) {
    const double miss = glm::dot(n, from - shift);
    fit.residual += weight * miss * miss;
  });
  return fit;
}

double roundness(const glm::dmat2& tensor) {
  const double trace = tensor[0][0] + tensor[1][1];
  return trace > 0 ? 4 * glm::determinant(tensor) / (trace * trace) : 0;
}

constexpr const char* kAdvice = "Pick a corner or the middle of a target, or pick without snapping";

}  // namespace

Result<void> MarkOptions::validate() const {
  if (!(radiusPx >= 2 && radiusPx <= 100)) return fail("The window's radius must be 2 to 100 px", "radiusPx");
  if (!(farthestPx > 0 && farthestPx <= radiusPx)) return fail("A mark must lie inside the window", "farthestPx");
  return {};
}

Result<Mark> refineMark(const ColourImage& picture, const glm::dvec2& pick, const MarkOptions& options) {
  if (auto valid = options.validate(); !valid) return fail(valid.error());
  if (!std::isfinite(pick.x) || !std::isfinite(pick.y)) return fail("The pick is no place in the picture");
  const double sigma = options.radiusPx / 2;
  const int reach = static_cast<int>(std::ceil(options.radiusPx + options.farthestPx));
  const auto gradients = gradientsAround(picture, pick, reach);
  if (!gradients) return fail(gradients.error());

  glm::dvec2 at = pick;
  Fit corner, centre;
  for (int i = 0; i < kMaximumIterations; ++i) {
    corner = fitLines(*gradients, at, sigma, false);
    const double weights = 2 * std::numbers::pi * sigma * sigma;
    if ((corner.normal[0][0] + corner.normal[1][1]) / weights < kLeastGradient)
      return fail("The picture is even here: there is nothing to snap to", {}, kAdvice);
    if (roundness(corner.normal) < kLeastRoundness)
      return fail("The picture shows one edge here, and no place along it", {}, kAdvice);
    centre = fitLines(*gradients, at, sigma, true);
    const glm::dvec2 next = corner.residual <= centre.residual ? corner.point : centre.point;
    const double moved = glm::length(next - at);
    at = next;
    if (!(glm::length(at - pick) <= options.farthestPx))
      return fail(fmt::format("There is no corner or target centre within {} px", options.farthestPx), {}, kAdvice);
    if (moved < kSettledPx) break;
  }
  const bool isCorner = corner.residual <= centre.residual;
  const Fit& best = isCorner ? corner : centre;
  // Redundancy: the number of pixels under the weights, two unknowns.
  const double pixels = std::max(3.0, 2 * std::numbers::pi * sigma * sigma);
  const glm::dmat2 covariance = best.residual / (pixels - 2) * glm::inverse(best.normal);
  Mark mark;
  mark.pixel = at;
  mark.sigmaPx = std::sqrt(std::max(0.0, 0.5 * (covariance[0][0] + covariance[1][1])));
  mark.shape = isCorner ? MarkShape::Corner : MarkShape::Centre;
  return mark;
}

}  // namespace alidade

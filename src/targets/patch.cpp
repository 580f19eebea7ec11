// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "targets/patch.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace alidade {

namespace {

constexpr int kKernelReach = 3;  // three standard deviations of one pixel

/// Smoothing and derivative of a Gaussian of one pixel, each made exact on constants and ramps.
struct Kernels {
  std::array<double, 2 * kKernelReach + 1> smooth{}, derive{};
  Kernels() {
    double sum = 0, slope = 0;
    for (int i = -kKernelReach; i <= kKernelReach; ++i) {
      const double g = std::exp(-0.5 * i * i);
      smooth[static_cast<std::size_t>(i + kKernelReach)] = g;
      derive[static_cast<std::size_t>(i + kKernelReach)] = i * g;
      sum += g, slope += i * i * g;
    }
    for (double& v : smooth) v /= sum;
    for (double& v : derive) v /= slope;
  }
};

}  // namespace

bool Patch::holds(const glm::dvec2& pixel, double margin) const {
  const glm::dvec2 p = pixel - origin;
  return p.x >= margin && p.y >= margin && p.x <= side - 1 - margin && p.y <= side - 1 - margin;
}

double Patch::sample(const glm::dvec2& pixel) const {
  const glm::dvec2 p = pixel - origin;
  const int x = std::clamp(static_cast<int>(std::floor(p.x)), 0, side - 2), y = std::clamp(static_cast<int>(std::floor(p.y)), 0, side - 2);
  const double fx = p.x - x, fy = p.y - y;
  return (1 - fy) * ((1 - fx) * at(x, y) + fx * at(x + 1, y)) + fy * ((1 - fx) * at(x, y + 1) + fx * at(x + 1, y + 1));
}

Result<Patch> cutPatch(const ColourImage& picture, const glm::dvec2& about, int reach) {
  const double x = std::round(about.x), y = std::round(about.y);
  if (!(x - reach >= 0 && y - reach >= 0 && x + reach < picture.width() && y + reach < picture.height()))
    return fail("This is too near the picture's border", {}, "Choose a place farther inside");
  Patch patch;
  patch.side = 2 * reach + 1;
  patch.origin = {x - reach, y - reach};
  patch.grey.reserve(static_cast<std::size_t>(patch.side) * patch.side);
  for (int row = 0; row < patch.side; ++row) {
    const Rgba8* from = picture.row(static_cast<int>(patch.origin.y) + row) + static_cast<int>(patch.origin.x);
    for (int i = 0; i < patch.side; ++i)
      patch.grey.push_back(greyOf(from[i]));
  }
  return patch;
}

Result<Gradients> gradientsAround(const ColourImage& picture, const glm::dvec2& about, int reach) {
  static const Kernels kernels;
  const auto patch = cutPatch(picture, about, reach + kKernelReach);
  if (!patch) return fail(patch.error());
  const int side = 2 * reach + 1, wide = patch->side;
  // Rows first: smoothed and derived along x, then columns.
  std::vector<glm::dvec2> rows(static_cast<std::size_t>(wide) * side);
  for (int y = 0; y < wide; ++y)
    for (int x = 0; x < side; ++x) {
      glm::dvec2 sum(0);
      for (int i = 0; i <= 2 * kKernelReach; ++i)
        sum += static_cast<double>(patch->at(x + i, y)) * glm::dvec2(kernels.smooth[static_cast<std::size_t>(i)], kernels.derive[static_cast<std::size_t>(i)]);
      rows[static_cast<std::size_t>(y) * side + x] = sum;
    }
  Gradients made;
  made.side = side;
  made.origin = patch->origin + glm::dvec2(kKernelReach);
  made.values.reserve(static_cast<std::size_t>(side) * side);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      glm::dvec2 gradient(0);
      for (int i = 0; i <= 2 * kKernelReach; ++i) {
        const glm::dvec2& row = rows[static_cast<std::size_t>(y + i) * side + x];
        gradient += glm::dvec2(row.y * kernels.smooth[static_cast<std::size_t>(i)], row.x * kernels.derive[static_cast<std::size_t>(i)]);
      }
      made.values.push_back(gradient);
    }
  return made;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/picture_scaling.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace alidade {

namespace {

/// Source pixels [first, first + weights.size()) of one result pixel.
struct Box {
  int first = 0;
  std::vector<float> weights;  // sum 1
};

std::vector<Box> boxes(int from, int to) {
  std::vector<Box> result(to);
  const double step = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    const double begin = i * step, end = std::min((i + 1) * step, static_cast<double>(from));
    Box& box = result[i];
    box.first = std::min(static_cast<int>(begin), from - 1);
    for (int s = box.first; s < from && s < end; ++s) {
      const double share = std::min<double>(s + 1, end) - std::max<double>(s, begin);
      if (share > 1e-9) box.weights.push_back(static_cast<float>(share / (end - begin)));
    }
  }
  return result;
}

}  // namespace

ColourImage shrunk(const ColourImage& picture, int width, int height) {
  ColourImage result(width, height, Uncleared{});
  const std::vector<Box> columns = boxes(picture.width(), width), rows = boxes(picture.height(), height);
  parallelFor(static_cast<std::size_t>(height), 8, [&](std::size_t firstRow, std::size_t lastRow, int) {
    std::vector<float> sums(4 * static_cast<std::size_t>(picture.width()));
    for (std::size_t y = firstRow; y < lastRow; ++y) {
      std::fill(sums.begin(), sums.end(), 0.0f);
      for (std::size_t i = 0; i < rows[y].weights.size(); ++i) {
        const float weight = rows[y].weights[i];
        const auto* source =
            reinterpret_cast<const std::uint8_t*>(picture.row(rows[y].first + static_cast<int>(i)));
        for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += weight * source[k];
      }
      for (int x = 0; x < width; ++x) {
        float c[4] = {0.5f, 0.5f, 0.5f, 0.5f};
        for (std::size_t i = 0; i < columns[x].weights.size(); ++i)
          for (int k = 0; k < 4; ++k) c[k] += columns[x].weights[i] * sums[4 * (columns[x].first + i) + k];
        const auto byte = [](float v) { return static_cast<std::uint8_t>(std::min(v, 255.0f)); };
        result.at(x, static_cast<int>(y)) = {byte(c[0]), byte(c[1]), byte(c[2]), byte(c[3])};
      }
    }
  });
  return result;
}

}  // namespace alidade

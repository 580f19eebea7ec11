// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/edges.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/glm.hpp>
#include <opencv2/imgproc.hpp>

namespace alidade {

namespace {

constexpr int kReachPx = 2;
/// A bend that counts half: three centimetres behind an edge 3 m away, or a right angle at a focal length of 400 pixels.
constexpr float kHalfBend = 0.01f;
constexpr float kFarthest = 1e-6f;  ///< 1/m
constexpr double kBlurPx = 1;
/// A gradient that counts half, in mean gradients of the picture.
constexpr double kHalfGradient = 2;

cv::Mat matOf(const Image<float>& image) {
  return {image.height(), image.width(), CV_32F, const_cast<float*>(image.data())};
}

}  // namespace

Image<float> depthEdges(const DepthImage& depth, bool unknownIsFar, Image<std::uint8_t>& known) {
  Image<float> sharp(depth.width(), depth.height()), edges(depth.width(), depth.height());
  known = Image<std::uint8_t>(depth.width(), depth.height());
  const float none = unknownIsFar ? 0.0f : std::numeric_limits<float>::quiet_NaN();
  const auto inverse = [&](int x, int y) {
    const float z = depth.at(x, y);
    return z > 0 ? 1 / z : none;
  };
  for (int y = kReachPx; y + kReachPx < depth.height(); ++y)
    for (int x = kReachPx; x + kReachPx < depth.width(); ++x) {
      const float here = inverse(x, y);
      bool all = here >= 0;
      float most = 0;
      for (const glm::ivec2 d : {glm::ivec2(kReachPx, 0), {0, kReachPx}, {kReachPx, kReachPx}, {kReachPx, -kReachPx}}) {
        const float before = inverse(x - d.x, y - d.y), after = inverse(x + d.x, y + d.y);
        all = all && before >= 0 && after >= 0;
        const float nearest = std::max({before, here, after, kFarthest});
        const float bend = std::abs(before + after - 2 * here) / nearest;
        if (bend > most) most = bend;
      }
      if (!all) continue;
      known.at(x, y) = 1;
      sharp.at(x, y) = 255 * most / (most + kHalfBend);
    }
  cv::Mat to = matOf(edges);
  cv::GaussianBlur(matOf(sharp), to, {}, kBlurPx);
  return edges;
}

Image<float> photoEdges(const Image<float>& luma) {
  Image<float> edges(luma.width(), luma.height());
  cv::Mat smooth, dx, dy, to = matOf(edges);
  cv::GaussianBlur(matOf(luma), smooth, {}, kBlurPx);
  cv::Scharr(smooth, dx, CV_32F, 1, 0, 1.0 / 32);
  cv::Scharr(smooth, dy, CV_32F, 0, 1, 1.0 / 32);
  cv::magnitude(dx, dy, to);
  const double half = kHalfGradient * cv::mean(to)[0];
  for (std::size_t i = 0; i < edges.size(); ++i) {
    float& strength = edges.data()[i];
    strength = static_cast<float>(255 * strength / (strength + half));
  }
  return edges;
}

}  // namespace alidade

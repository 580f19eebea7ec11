// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/feature_tracks.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace alidade {

namespace {

constexpr int kPyramidLevels = 4;
constexpr int kWindow = 17;

cv::Mat grayOf(const ColourImage& image, double scale) {
  const cv::Mat pixels(image.height(), image.width(), CV_8UC4, const_cast<Rgba8*>(image.data()));
  cv::Mat gray, small;
  cv::cvtColor(pixels, gray, cv::COLOR_RGBA2GRAY);
  if (scale == 1) return gray;
  cv::resize(gray, small, cv::Size(), scale, scale, cv::INTER_AREA);
  return small;
}

std::vector<std::pair<glm::dvec2, glm::dvec2>> tracksOf(const cv::Mat& first, const cv::Mat& second, double scaleX, double scaleY,
                                                        const FeatureTrackOptions& options) {
  std::vector<cv::Point2f> from, to, back;
  const double apart = std::max(6.0, 0.5 * std::sqrt(static_cast<double>(first.total()) / std::max(1, options.atMost)));
  cv::goodFeaturesToTrack(first, from, options.atMost, 0.01, apart);
  std::vector<std::pair<glm::dvec2, glm::dvec2>> tracks;
  if (from.empty()) return tracks;
  std::vector<unsigned char> there, again;
  std::vector<float> error;
  const cv::Size window(kWindow, kWindow);
  cv::calcOpticalFlowPyrLK(first, second, from, to, there, error, window, kPyramidLevels);
  cv::calcOpticalFlowPyrLK(second, first, to, back, again, error, window, kPyramidLevels);
  // Half a pixel: the origin is the first pixel's centre at every scale.
  const auto full = [&](const cv::Point2f& p) { return glm::dvec2((p.x + 0.5) / scaleX - 0.5, (p.y + 0.5) / scaleY - 0.5); };
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!there[i] || !again[i] || std::hypot(back[i].x - from[i].x, back[i].y - from[i].y) > options.thereAndBackPx) continue;
    const bool inside = to[i].x > 2 && to[i].y > 2 && to[i].x < float(second.cols - 3) && to[i].y < float(second.rows - 3);
    if (inside) tracks.emplace_back(full(from[i]), full(to[i]));
  }
  return tracks;
}

}  // namespace

Result<std::vector<std::pair<glm::dvec2, glm::dvec2>>> trackFeatures(const ColourImage& first, const ColourImage& second,
                                                                     const FeatureTrackOptions& options) {
  if (first.width() != second.width() || first.height() != second.height() || first.empty())
    return fail("The two pictures differ in size", {}, "Use pictures of one camera");
  try {
    const double scale = std::min(1.0, options.widestPx / first.width());
    const cv::Mat a = grayOf(first, scale), b = grayOf(second, scale);
    return tracksOf(a, b, static_cast<double>(a.cols) / first.width(), static_cast<double>(a.rows) / first.height(), options);
  } catch (const std::exception& error) {
    return fail(std::string("The pictures cannot be compared: ") + error.what(), {}, "Use pictures with 8 bits a channel");
  }
}

}  // namespace alidade

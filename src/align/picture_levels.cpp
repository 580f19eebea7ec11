// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/picture_levels.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace alidade {

std::vector<PictureLevel> picturePyramid(const ColourImage& photo, const Camera& camera, int finestWidth, int coarsestWidth) {
  std::vector<PictureLevel> levels;
  const cv::Mat colours(photo.height(), photo.width(), CV_8UC4, const_cast<Rgba8*>(photo.data()));
  cv::Mat bytes, light;
  cv::cvtColor(colours, bytes, cv::COLOR_RGBA2GRAY);
  bytes.convertTo(light, CV_32F);
  for (double width = std::min(finestWidth, photo.width()); levels.empty() || width >= coarsestWidth; width *= 0.5) {
    const double scale = photo.width() / width;
    PictureLevel level;
    level.camera = scale == 1 ? camera
                              : camera.scaledTo(static_cast<int>(std::lround(width)), static_cast<int>(std::lround(photo.height() / scale)));
    level.scale = scale;
    level.luma = Image<float>(level.camera.width(), level.camera.height());
    cv::Mat to(level.luma.height(), level.luma.width(), CV_32F, level.luma.data());
    if (scale == 1) light.copyTo(to);
    else cv::resize(light, to, to.size(), 0, 0, cv::INTER_AREA);
    levels.push_back(std::move(level));
  }
  std::reverse(levels.begin(), levels.end());
  return levels;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <opencv2/calib3d.hpp>

#include "sites.h"

namespace alidade {

/// cv::solvePnPRefineLM on a site's picks, from the same start.
inline RigidTransform refinedByOpenCv(const Site& site) {
  const Intrinsics& in = site.camera.intrinsics();
  const cv::Mat matrix = (cv::Mat_<double>(3, 3) << in.fx, 0, in.cx, 0, in.fy, in.cy, 0, 0, 1);
  const std::vector<double> all = in.parameters(), coefficients(all.begin() + 4, all.end());
  std::vector<cv::Point3d> world;
  std::vector<cv::Point2d> pixels;
  for (const ResectionObservation& pick : site.picks) {
    world.emplace_back(pick.world.x, pick.world.y, pick.world.z);
    pixels.emplace_back(pick.pixel.x, pick.pixel.y);
  }
  const glm::dmat3 r = site.start.rotationMatrix();
  const cv::Mat rotation = (cv::Mat_<double>(3, 3) << r[0][0], r[1][0], r[2][0], r[0][1], r[1][1], r[2][1], r[0][2],
                            r[1][2], r[2][2]);
  cv::Mat rvec, tvec = (cv::Mat_<double>(3, 1) << site.start.translation.x, site.start.translation.y,
                        site.start.translation.z);
  cv::Rodrigues(rotation, rvec);
  cv::solvePnPRefineLM(world, pixels, matrix, coefficients, rvec, tvec,
                       cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 200, 1e-14));
  cv::Mat refined;
  cv::Rodrigues(rvec, refined);
  glm::dmat3 back;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) back[j][i] = refined.at<double>(i, j);
  return RigidTransform::fromMatrix(back, {tvec.at<double>(0), tvec.at<double>(1), tvec.at<double>(2)});
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Twelve photos, 11 384 tie points: the final cost of COLMAP 3.8's bundle adjuster on the same model, calibration held
// (colmap bundle_adjuster, refine_focal_length 0, refine_extra_params 0).

#include <cmath>
#include <filesystem>
#include <map>

#include <gtest/gtest.h>

#include "adjust/network.h"
#include "colmap/colmap_reader.h"

namespace alidade {
namespace {

TEST(LundDoor, ReachesColmapsCost) {
  const std::string folder = std::string(ALIDADE_SHARED_DATA_DIR) + "/lund_door/colmap_ground_truth";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data at " << folder;
  const auto set = ColmapReader().read(folder, {});
  ASSERT_TRUE(set) << set.error().text();
  Network n;
  n.cameras.push_back({"camera", set->cameras[0], false, false, false});
  for (std::size_t i = 0; i < set->pictures.size(); ++i) {
    n.poses.push_back({set->pictures[i].name, set->pictures[i].cameraFromWorld, {}, 0});
    n.frames.push_back({set->pictures[i].name, static_cast<int>(i), 0, -1, 0, 0});
  }
  // The model sees some points twice in a picture: a second frame of the same pose takes the second sighting.
  std::map<std::pair<int, int>, int> sightings;
  const int pictures = static_cast<int>(set->pictures.size());
  double residuals = 0;
  for (const TiePoint& tie : set->tiePoints) {
    const int point = static_cast<int>(n.points.size());
    n.points.push_back({{}, PointKind::Tie, tie.world, {}, {}});
    for (const auto& [picture, pixel] : tie.seenIn) {
      const int frame = picture + pictures * sightings[{picture, point}]++;
      while (frame >= static_cast<int>(n.frames.size())) {
        const int pose = static_cast<int>(n.frames.size()) % pictures;
        n.frames.push_back({set->pictures[pose].name, pose, 0, -1, 0, 0});
      }
      n.observations.push_back({frame, point, pixel, 1.0, false});
      residuals += 2;
    }
  }
  NetworkOptions options;
  options.huberSigmas = 0, options.covariance = false, options.freeNetwork = true;
  const auto summary = adjustNetwork(n, options);
  ASSERT_TRUE(summary) << summary.error().text();
  ASSERT_TRUE(summary->converged) << summary->reason;
  // COLMAP prints sqrt(cost / residuals).
  const double rms = std::sqrt(summary->finalCost / residuals);
  std::printf("lund_door: %zu observations, %.0f residuals, cost %.6f, sqrt(cost / residuals) %.6f px, %d iterations\n",
              n.observations.size(), residuals, summary->finalCost, rms, summary->iterations);
  constexpr double colmapCost = 10922.34;  // 0.272905 px over 146 654 residuals
  EXPECT_NEAR(summary->finalCost / colmapCost, 1, 1e-3);
}

}  // namespace
}  // namespace alidade

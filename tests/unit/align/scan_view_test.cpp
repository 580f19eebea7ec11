// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/scan_view.h"

#include <cmath>

#include <gtest/gtest.h>

#include "unit/align/room.h"

namespace alidade {

using test::Room;

TEST(ScanView, ShowsThePatternWhereItIsThroughTheLens) {
  const AlignmentScene scene = Room::scan();
  EXPECT_TRUE(scene.hasColour());
  EXPECT_GT(scene.spacingM(), 0.005);
  const Camera camera = Room::camera().scaledTo(320, 240);
  const RigidTransform pose = Room::pose();
  const ScanView view = drawScanView(scene, camera, pose);
  EXPECT_GT(view.coverage, 0.8);
  const glm::dmat3 toWorld = glm::transpose(pose.rotationMatrix());
  const glm::dvec3 from = pose.centre() - Room::world({0, 0, 0});
  // Products of the picture with the pattern moved by a pixel either way: even only where nothing is shifted.
  double sums[5] = {}, deepest = 0;
  const glm::dvec2 moves[5] = {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  for (int y = 4; y < 236; ++y)
    for (int x = 4; x < 316; ++x) {
      if (!view.covered.at(x, y)) continue;
      for (int i = 0; i < 5; ++i) {
        const glm::dvec3 along = toWorld * *camera.unproject(glm::dvec2(x, y) + moves[i]);
        const auto hit = Room::hit(from, along);
        if (!hit) continue;
        sums[i] += (view.luma.at(x, y) - 128) * (std::clamp(Room::at(from + hit->second * along, hit->first), 0.0, 255.0) - 128);
        if (i == 0) deepest = std::max(deepest, std::abs(view.depth.at(x, y) - hit->second) / hit->second);
      }
    }
  EXPECT_LT(deepest, 0.1);
  // A parabola through the three products has its top within a twentieth of a pixel.
  const double shiftX = 0.5 * (sums[1] - sums[2]) / (2 * sums[0] - sums[1] - sums[2]);
  const double shiftY = 0.5 * (sums[3] - sums[4]) / (2 * sums[0] - sums[3] - sums[4]);
  EXPECT_NEAR(shiftX, 0, 0.05);
  EXPECT_NEAR(shiftY, 0, 0.05);
}

TEST(ScanView, IsEmptyWhereNoPointIs) {
  const ScanView view = drawScanView(Room::scan(1000), Room::camera().scaledTo(64, 48),
                                     RigidTransform::cameraLookingAt(Room::world({0, -3, 2}), Room::world({0, -20, 2})));
  EXPECT_EQ(view.coverage, 0);
}

}  // namespace alidade

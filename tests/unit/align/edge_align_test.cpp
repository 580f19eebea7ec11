// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include "align/auto_align.h"
#include "align/edges.h"
#include "cloud/point_store.h"
#include "unit/align/boxes.h"
#include "unit/align/starts.h"

namespace alidade {

namespace {

using test::Boxes;

AlignmentScene designed() {
  AlignmentScene scene;
  scene.complete = true;
  scene.surfaces.push_back(std::make_shared<const OccluderMesh>(occluderMeshOf(Boxes::design())));
  return scene;
}

AlignmentScene scanned() {
  PointBatch batch;
  Boxes::scanFrom({-3, -4, 1.9}, batch);
  Boxes::scanFrom({2, -4, 2.2}, batch);
  PointStoreBuilder builder;
  builder.add(batch);
  AlignmentScene scene;
  scene.scans.push_back(*builder.build(Progress()));
  return scene;
}

double errorPx(const RigidTransform& found) {
  const Camera small = Boxes::camera().scaledTo(200, 150);
  return test::poseError(drawScanView(designed(), small, Boxes::pose()).depth, small, 4, Boxes::pose(), found).medianPx;
}

void findsThePose(const AlignmentScene& scene, double withinPx) {
  const ColourImage photo = Boxes::photo(Boxes::camera(), Boxes::pose());
  std::mt19937 random(11);
  for (int i = 0; i < 2; ++i) {
    const RigidTransform start = test::disturbed(Boxes::pose(), random);
    const auto summary = alignPicture(scene, photo, Boxes::camera(), start);
    ASSERT_TRUE(summary) << summary.error().text();
    EXPECT_TRUE(summary->converged) << "from " << errorPx(start) << " px off\n" << summary->report();
    EXPECT_LT(errorPx(summary->cameraFromWorld), withinPx) << "from " << errorPx(start) << " px off\n" << summary->report();
  }
}

}  // namespace

TEST(EdgeAlign, FindsThePoseFromTheDesignAlone) {
  findsThePose(designed(), 0.3);
}

TEST(EdgeAlign, TheRowsOfARollingShutterKeepTheirPlaces) {
  const RollingShutter shutter{0.03, {{0.2, -0.35, 0.15}, {-0.7, 0.2, -0.6}}};
  const ColourImage photo = Boxes::photo(Boxes::camera(), Boxes::pose(), shutter);
  std::mt19937 random(11);
  AlignmentOptions options;
  options.shutter = shutter;
  const auto summary = alignPicture(designed(), photo, Boxes::camera(), test::disturbed(Boxes::pose(), random), options);
  ASSERT_TRUE(summary) << summary.error().text();
  EXPECT_TRUE(summary->converged) << summary->report();
  EXPECT_LT(errorPx(summary->cameraFromWorld), 0.4) << summary->report();
}

TEST(EdgeAlign, FindsThePoseFromAScanWithoutColours) {
  const AlignmentScene scene = scanned();
  ASSERT_FALSE(scene.hasColour());
  findsThePose(scene, 0.8);
}

TEST(EdgeAlign, WhatIsLockedStays) {
  const ColourImage photo = Boxes::photo(Boxes::camera(), Boxes::pose());
  RigidTransform turned = Boxes::pose();
  turned.rotation = glm::angleAxis(0.03, glm::normalize(glm::dvec3(0.4, 1, 0.2))) * turned.rotation;
  turned.translation = -(turned.rotation * Boxes::pose().centre());
  AlignmentOptions options;
  options.lockPosition = {true, true, true};
  const auto summary = alignPicture(designed(), photo, Boxes::camera(), turned, options);
  ASSERT_TRUE(summary) << summary.error().text();
  EXPECT_TRUE(summary->converged) << summary->report();
  EXPECT_LT(errorPx(summary->cameraFromWorld), 0.3);
  EXPECT_LT(glm::distance(summary->cameraFromWorld.centre(), turned.centre()), 1e-6);
}

TEST(EdgeAlign, DoesNotBelieveAPictureOfSomethingElse) {
  const ColourImage photo = Boxes::photo(Boxes::camera(), Boxes::pose());
  ColourImage turned(photo.width(), photo.height());
  for (int y = 0; y < photo.height(); ++y)
    for (int x = 0; x < photo.width(); ++x) turned.at(x, y) = photo.at(photo.width() - 1 - x, y);
  const auto summary = alignPicture(designed(), turned, Boxes::camera(), Boxes::pose());
  ASSERT_TRUE(summary) << summary.error().text();
  EXPECT_FALSE(summary->converged) << summary->report();
  EXPECT_FALSE(summary->reason.empty());
}

TEST(DepthEdges, SeeStepsAndFoldsAndNothingOnAPlane) {
  // A floor seen at a slant (1/z linear in y), a wall rising from it at row 30 and a pole before both.
  DepthImage depth(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const float wall = 0.10f, floor = 0.10f + 0.004f * static_cast<float>(y - 30);
      depth.at(x, y) = 1 / std::max({wall, floor, x >= 40 && x < 44 ? 0.25f : 0.0f});
    }
  Image<std::uint8_t> known;
  const Image<float> edges = depthEdges(depth, false, known);
  EXPECT_LT(edges.at(20, 50), 1);
  EXPECT_LT(edges.at(20, 12), 1);
  EXPECT_GT(edges.at(20, 30), 60);   // the fold
  EXPECT_GT(edges.at(40, 15), 150);  // the pole's border
  for (int y = 5; y < 15; ++y)
    for (int x = 5; x < 15; ++x) depth.at(x, y) = std::numeric_limits<float>::quiet_NaN();
  depthEdges(depth, false, known);
  EXPECT_EQ(known.at(15, 10), 0);
  EXPECT_EQ(known.at(20, 10), 1);
  EXPECT_GT(depthEdges(depth, true, known).at(15, 10), 150);
  EXPECT_EQ(known.at(15, 10), 1);
}

}  // namespace alidade

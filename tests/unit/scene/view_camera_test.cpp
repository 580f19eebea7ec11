// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/view_camera.h"

#include <gtest/gtest.h>

using alidade::Bounds;
using alidade::ViewCamera;

namespace {

constexpr double kFar = 1e7;

ViewCamera cameraOnBox(const glm::dvec3& centre) {
  Bounds box;
  box.add(centre - glm::dvec3(20, 10, 3));
  box.add(centre + glm::dvec3(20, 10, 3));
  ViewCamera camera;
  camera.resize(800, 600);
  camera.fit(box);
  return camera;
}

}  // namespace

TEST(ViewCamera, FitShowsEveryCornerOfTheBoxLevelAndCentred) {
  for (const double shift : {0.0, kFar}) {
    const glm::dvec3 centre(shift, shift, 500);
    for (const glm::ivec2 size : {glm::ivec2(800, 600), glm::ivec2(300, 900)}) {
      ViewCamera camera;
      camera.resize(size.x, size.y);
      Bounds box;
      box.add(centre - glm::dvec3(20, 10, 3));
      box.add(centre + glm::dvec3(20, 10, 3));
      camera.fit(box);
      for (int corner = 0; corner < 8; ++corner) {
        const auto px = camera.project(box.corner(corner));
        ASSERT_TRUE(px.has_value());
        EXPECT_GE(px->x, 0);
        EXPECT_LE(px->x, size.x);
        EXPECT_GE(px->y, 0);
        EXPECT_LE(px->y, size.y);
      }
      EXPECT_NEAR(camera.right().z, 0.0, 1e-12);
      EXPECT_NEAR(camera.project(centre)->x, 0.5 * size.x, 1e-5);
      EXPECT_NEAR(camera.project(centre)->y, 0.5 * size.y, 1e-5);
    }
  }
}

TEST(ViewCamera, ARayAndTheProjectionOfItsPointsAgree) {
  const ViewCamera camera = cameraOnBox({kFar, kFar, 0});
  for (const glm::dvec2 px : {glm::dvec2(0, 0), glm::dvec2(400, 300), glm::dvec2(777, 12)}) {
    const auto ray = camera.rayThrough(px);
    const auto back = camera.project(ray.origin + 30.0 * ray.direction);
    EXPECT_NEAR(back->x, px.x, 1e-4);
    EXPECT_NEAR(back->y, px.y, 1e-4);
  }
}

TEST(ViewCamera, ZoomAndPanKeepWhatIsUnderTheCursorThere) {
  ViewCamera camera = cameraOnBox({kFar, kFar, 0});
  const glm::dvec3 target(kFar + 12, kFar - 4, 1);
  const glm::dvec3 before = *camera.project(target);
  camera.zoomTowards(target, 2.0);
  glm::dvec3 after = *camera.project(target);
  EXPECT_NEAR(after.x, before.x, 1e-4);
  EXPECT_NEAR(after.y, before.y, 1e-4);
  EXPECT_NEAR(after.z, 0.5 * before.z, 1e-6);
  camera.pan(target, {37, -21});
  after = *camera.project(target);
  EXPECT_NEAR(after.x, before.x + 37, 1e-4);
  EXPECT_NEAR(after.y, before.y - 21, 1e-4);
}

TEST(ViewCamera, OrbitKeepsThePivotAndItsDistanceAndNeverTipsOver) {
  ViewCamera camera = cameraOnBox({kFar, kFar, 0});
  const glm::dvec3 pivot(kFar + 5, kFar + 5, 2);
  const glm::dvec3 before = *camera.project(pivot);
  camera.orbit(pivot, {120, 45});
  const glm::dvec3 after = *camera.project(pivot);
  EXPECT_NEAR(after.x, before.x, 1e-4);
  EXPECT_NEAR(after.y, before.y, 1e-4);
  EXPECT_NEAR(after.z, before.z, 1e-6);
  EXPECT_NEAR(camera.right().z, 0.0, 1e-9);
  for (int i = 0; i < 100; ++i) camera.orbit(pivot, {3, 50});
  EXPECT_LT(camera.forward().z, -0.99);
  EXPECT_GT(camera.up().z, 0.0);
  for (int i = 0; i < 100; ++i) camera.orbit(pivot, {-7, -50});
  EXPECT_GT(camera.forward().z, 0.99);
  EXPECT_GT(camera.up().z, 0.0);
}

TEST(ViewCamera, DraggingDownRaisesTheEyeAndDraggingRightTurnsTheSiteRight) {
  ViewCamera camera = cameraOnBox({0, 0, 0});
  const double height = camera.position().z;
  const glm::dvec3 nearSide = camera.position() * 0.5;  // between eye and pivot
  const double x = camera.project(nearSide)->x;
  camera.orbit({0, 0, 0}, {0, 60});
  EXPECT_GT(camera.position().z, height);
  camera.orbit({0, 0, 0}, {30, 0});
  EXPECT_GT(camera.project(nearSide)->x, x);
}

TEST(ViewCamera, NothingBehindTheEyeHasAPixel) {
  const ViewCamera camera = cameraOnBox({0, 0, 0});
  EXPECT_FALSE(camera.project(camera.position() - camera.forward()).has_value());
}

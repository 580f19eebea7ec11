// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/auto_align.h"

#include <gtest/gtest.h>

#include "unit/align/room.h"
#include "unit/align/starts.h"

namespace alidade {

namespace {

using test::Room;

class AutoAlign : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    s_scene = new AlignmentScene(Room::scan());
    s_photo = new ColourImage(Room::photo(Room::camera(), Room::pose()));
  }
  static void TearDownTestSuite() {
    delete s_scene;
    delete s_photo;
  }
  static double errorPx(const RigidTransform& found) {
    const Camera small = Room::camera().scaledTo(160, 120);
    return test::poseError(drawScanView(*s_scene, small, Room::pose()).depth, small, 4, Room::pose(), found).medianPx;
  }
  static AlignmentScene* s_scene;
  static ColourImage* s_photo;
};
AlignmentScene* AutoAlign::s_scene = nullptr;
ColourImage* AutoAlign::s_photo = nullptr;

}  // namespace

TEST_F(AutoAlign, FindsThePoseFromThreeDegreesAndThirtyCentimetresOff) {
  std::mt19937 random(11);
  for (int i = 0; i < 2; ++i) {
    const RigidTransform start = test::disturbed(Room::pose(), random);
    const auto summary = alignPicture(*s_scene, *s_photo, Room::camera(), start);
    ASSERT_TRUE(summary) << summary.error().text();
    EXPECT_TRUE(summary->converged) << summary->report();
    EXPECT_LT(errorPx(summary->cameraFromWorld), 0.5) << "from " << errorPx(start) << " px off\n" << summary->report();
    EXPECT_GT(summary->confidence, 0);
  }
}

/// A camera that turns and walks at a metre a second while it reads its rows, with a wall a metre and others six away: up to
/// 10 px between the first and the last row, and more between near and far.
TEST_F(AutoAlign, TheRowsOfARollingShutterKeepTheirPlaces) {
  const RollingShutter shutter{0.03, {{0.2, -0.35, 0.15}, {-0.7, 0.2, -0.6}}};
  const ColourImage photo = Room::photo(Room::camera(), Room::pose(), shutter);
  std::mt19937 random(11);
  const RigidTransform start = test::disturbed(Room::pose(), random);
  AlignmentOptions options;
  const auto still = alignPicture(*s_scene, photo, Room::camera(), start, options);
  ASSERT_TRUE(still) << still.error().text();
  options.shutter = shutter;
  const auto moving = alignPicture(*s_scene, photo, Room::camera(), start, options);
  ASSERT_TRUE(moving) << moving.error().text();
  ASSERT_TRUE(moving->converged) << moving->report();
  EXPECT_LT(errorPx(moving->cameraFromWorld), 0.3) << moving->report();
  EXPECT_LT(moving->estimate.rmsPx, 0.5 * still->estimate.rmsPx) << still->report();
  // The places are those of the photo itself.
  double squares = 0;
  for (const SeenPlace& place : moving->places) {
    const auto pixel = project(Room::camera(), shutter, moving->cameraFromWorld * place.world);
    ASSERT_TRUE(pixel);
    squares += std::pow(std::min(2.0, glm::distance(*pixel, place.pixel)), 2);
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(moving->places.size())), 0.6);
}

TEST_F(AutoAlign, ALockedPositionStays) {
  RigidTransform turned = Room::pose();
  turned.rotation = glm::angleAxis(0.03, glm::normalize(glm::dvec3(0.4, 1, 0.2))) * turned.rotation;
  turned.translation = -(turned.rotation * Room::pose().centre());
  AlignmentOptions options;
  options.lockPosition = {true, true, true};
  const auto summary = alignPicture(*s_scene, *s_photo, Room::camera(), turned, options);
  ASSERT_TRUE(summary) << summary.error().text();
  EXPECT_TRUE(summary->converged) << summary->report();
  EXPECT_LT(glm::distance(summary->cameraFromWorld.centre(), turned.centre()), 1e-6);
}

TEST_F(AutoAlign, DoesNotBelieveAPictureOfSomethingElse) {
  // Upside down the room is another room with the same statistics.
  ColourImage turned(s_photo->width(), s_photo->height());
  for (int y = 0; y < turned.height(); ++y)
    for (int x = 0; x < turned.width(); ++x) turned.at(x, y) = s_photo->at(x, turned.height() - 1 - y);
  const auto summary = alignPicture(*s_scene, turned, Room::camera(), Room::pose());
  ASSERT_TRUE(summary) << summary.error().text();
  EXPECT_FALSE(summary->converged) << summary->report();
  EXPECT_EQ(summary->cameraFromWorld.translation, Room::pose().translation);
  EXPECT_FALSE(summary->reason.empty());
}

TEST_F(AutoAlign, DoesNotBelieveAPoseBeyondTheRange) {
  RigidTransform far = Room::pose();
  far.translation += glm::dvec3(1.2, 0, 0.4);
  const auto summary = alignPicture(*s_scene, *s_photo, Room::camera(), far);
  ASSERT_TRUE(summary) << summary.error().text();
  EXPECT_TRUE(!summary->converged || errorPx(summary->cameraFromWorld) < 1) << summary->report();
}

TEST_F(AutoAlign, SaysWhyAPictureCannotBeTried) {
  const auto dark = alignPicture(*s_scene, ColourImage(640, 480, Rgba8{3, 3, 3, 255}), Room::camera(), Room::pose());
  ASSERT_FALSE(dark);
  EXPECT_NE(dark.error().what.find("too dark"), std::string::npos);
  const auto plain = alignPicture(*s_scene, ColourImage(640, 480, Rgba8{120, 120, 120, 255}), Room::camera(), Room::pose());
  ASSERT_FALSE(plain);
  EXPECT_NE(plain.error().what.find("no edges"), std::string::npos);
  const auto size = alignPicture(*s_scene, ColourImage(320, 240), Room::camera(), Room::pose());
  ASSERT_FALSE(size);
  EXPECT_NE(size.error().what.find("320×240"), std::string::npos);
  const RigidTransform away = RigidTransform::cameraLookingAt(Room::world({0, -3, 2}), Room::world({0, -20, 2}));
  const auto nothing = alignPicture(*s_scene, *s_photo, Room::camera(), away);
  ASSERT_FALSE(nothing);
  EXPECT_NE(nothing.error().what.find("Nothing of the scene is in view"), std::string::npos);
  const auto none = alignPicture({}, *s_photo, Room::camera(), Room::pose());
  ASSERT_FALSE(none);
  EXPECT_FALSE(none.error().advice.empty());
}

TEST_F(AutoAlign, StopsWhenCancelled) {
  const Progress progress;
  progress.cancel();
  const auto summary = alignPicture(*s_scene, *s_photo, Room::camera(), Room::pose(), {}, progress);
  ASSERT_FALSE(summary);
  EXPECT_TRUE(isCancelled(summary.error()));
}

}  // namespace alidade

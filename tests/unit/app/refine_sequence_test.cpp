// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/refine_sequence.h"

#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "io/picture_file.h"
#include "unit/align/room.h"
#include "unit/align/starts.h"

namespace alidade {

namespace {

namespace fs = std::filesystem;
using test::Room;

class RefineSequence : public ::testing::Test {
 protected:
  void SetUp() override {
    m_folder = fs::temp_directory_path() / fmt::format("alidade_sequence_{}", getpid());
    fs::create_directories(m_folder);
    m_camera = Room::camera().scaledTo(480, 360);
    CameraRecord record;
    record.id = CameraId{1}, record.name = "camera", record.camera = m_camera;
    m_project.cameras.push_back(record);
  }
  void TearDown() override {
    std::error_code ignored;
    fs::remove_all(m_folder, ignored);
  }

  /// A frame taken at `truth` of which the project believes `said`.
  void add(const RigidTransform& truth, const RigidTransform& said) {
    const auto number = static_cast<unsigned>(m_project.frames.size() + 1);
    Frame frame;
    frame.id = FrameId{number}, frame.name = fmt::format("{}.png", number), frame.camera = CameraId{1};
    frame.timeSecs = 0.5 * number;
    frame.image.path = (m_folder / frame.name).string();
    frame.cameraFromWorld = said;
    ASSERT_TRUE(writePng(Room::photo(m_camera, truth), frame.image.path));
    m_project.frames.push_back(frame);
    m_truth.push_back(truth);
  }

  double errorPx(std::size_t frame) const {
    const Camera small = m_camera.scaledTo(160, 120);
    return test::poseError(drawScanView(s_scene, small, m_truth[frame]).depth, small, 3, m_truth[frame],
                           *m_project.frames[frame].cameraFromWorld).medianPx;
  }

  static RigidTransform along(int i) {
    return RigidTransform::cameraLookingAt(Room::world({-2.2 + 0.15 * i, -0.4 + 0.05 * i, 1.7}), Room::world({1.6, 4.5, 1.2}));
  }

  inline static const AlignmentScene s_scene = Room::scan();
  fs::path m_folder;
  Camera m_camera;
  Project m_project;
  std::vector<RigidTransform> m_truth;
  PictureCache m_pictures;
};

}  // namespace

TEST_F(RefineSequence, TakesADriftOutOfAWalk) {
  for (int i = 0; i < 4; ++i) {
    RigidTransform said = along(i);
    said.rotation = glm::normalize(glm::angleAxis(-0.012 * i, glm::dvec3(0.3, 0.9, 0.3)) * said.rotation);
    said.translation = -(said.rotation * (along(i).centre() + 0.03 * i * glm::dvec3(1, -0.5, 0.3)));
    add(along(i), said);
  }
  EXPECT_GT(errorPx(3), 5);
  const auto summary = refineSequence(m_project, s_scene, m_pictures, {}, false, Progress());
  ASSERT_TRUE(summary) << summary.error().text();
  ASSERT_TRUE(summary->converged) << summary->report(m_project);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(errorPx(i), 0.5) << summary->report(m_project);
    EXPECT_EQ(m_project.frames[i].poseSource, PoseSource::Refined);
    ASSERT_TRUE(m_project.frames[i].quality);
    EXPECT_GT(m_project.frames[i].quality->positionStdM.x, 0);
    EXPECT_LT(glm::length(m_project.frames[i].quality->positionStdM), 0.02);
  }
  EXPECT_TRUE(summary->alarms.empty());
  int held = 0, ties = 0, smooth = 0;
  for (const ResidualGroup& g : summary->adjustment.groups) {
    if (g.heldOut) {
      held += g.count;
      EXPECT_LT(g.rmsPx, 1);
    }
    if (g.kind == ResidualKind::Tie) ties += g.count;
    if (g.kind == ResidualKind::Smoothness) smooth += g.count;
  }
  EXPECT_GT(held, 10);
  EXPECT_GT(ties, 20);
  EXPECT_EQ(smooth, 2);
}

TEST_F(RefineSequence, TwoCamerasOnOneRigFindWhereTheySit) {
  m_project.cameras.push_back(m_project.cameras.front());
  m_project.cameras.back().id = CameraId{2}, m_project.cameras.back().name = "right";
  const RigidTransform mount{glm::normalize(glm::dquat(1, 0.01, -0.03, 0.02)), {-0.3, 0.02, 0.04}};
  RigidTransform believed = mount;  // 3 cm and 0.6° off
  believed.rotation = glm::normalize(glm::angleAxis(0.01, glm::dvec3(0.6, 0.8, 0)) * mount.rotation);
  believed.translation += glm::dvec3(0.02, -0.02, 0.01);
  for (int i = 0; i < 4; ++i)
    for (const unsigned camera : {1u, 2u}) {
      add(camera == 1 ? along(i) : mount * along(i), camera == 1 ? along(i) : believed * along(i));
      m_project.frames.back().camera = CameraId{camera};
      m_project.frames.back().timeSecs = 0.5 * i;
    }
  SequenceOptions options;
  options.ties.rig = options.ties.freeMounts = true;
  options.at = {Room::world({1, 4, 1}), Room::world({0, -50, 0})};
  const auto summary = refineSequence(m_project, s_scene, m_pictures, options, false, Progress());
  ASSERT_TRUE(summary) << summary.error().text();
  ASSERT_TRUE(summary->converged) << summary->report(m_project);
  EXPECT_EQ(summary->network.poses.size(), 4u) << "one body a moment";
  ASSERT_EQ(summary->adjustment.cameraFromBody.size(), 1u);
  EXPECT_LT(glm::distance(summary->adjustment.cameraFromBody[0].centre(), mount.centre()), 0.003);
  EXPECT_LT(rotationAngleBetween(summary->adjustment.cameraFromBody[0], mount), 5e-4);
  for (std::size_t i = 0; i < m_truth.size(); ++i) EXPECT_LT(errorPx(i), 0.5) << summary->report(m_project);
  for (std::size_t i = 0; i < m_truth.size(); ++i) {
    const auto expected = summary->expectedIn(i);
    ASSERT_EQ(expected.size(), 2u);
    EXPECT_GT(expected[0].millimetres, 0);
    EXPECT_LT(expected[0].millimetres, 10);
    EXPECT_TRUE(std::isnan(expected[1].millimetres)) << "behind it";
  }
  ASSERT_TRUE(m_project.cameras[1].mount);
  EXPECT_EQ(m_project.cameras[1].mount->body, "camera");
  EXPECT_EQ(m_project.cameras[1].mount->cameraFromBody.translation, summary->adjustment.cameraFromBody[0].translation);
  const RigidTransform between = *m_project.frames[1].cameraFromWorld * m_project.frames[0].cameraFromWorld->inverse();
  EXPECT_LT(glm::distance(between.translation, summary->adjustment.cameraFromBody[0].translation), 1e-8) << "rigid";
}

TEST_F(RefineSequence, RaisesAnAlarmWhereAFixedCameraWasPushed) {
  RigidTransform pushed = along(0);
  pushed.rotation = glm::normalize(glm::angleAxis(0.004, glm::dvec3(0, 1, 0)) * pushed.rotation);
  pushed.translation = -(pushed.rotation * along(0).centre());
  for (int i = 0; i < 4; ++i) add(i < 2 ? along(0) : pushed, along(0));
  const auto summary = refineSequence(m_project, s_scene, m_pictures, {}, true, Progress());
  ASSERT_TRUE(summary) << summary.error().text();
  ASSERT_EQ(summary->alarms.size(), 1u) << summary->report(m_project);
  EXPECT_EQ(summary->alarms[0].frame, m_project.frames[2].id);
  EXPECT_NEAR(summary->alarms[0].radians, 0.004, 0.001);
  EXPECT_EQ(m_project.frames[2].poseSource, PoseSource::None) << "a dry run changes nothing";
}

TEST_F(RefineSequence, LeavesTheProjectAsItWasWhereNothingFits) {
  for (int i = 0; i < 2; ++i) {
    add(along(i), along(i));
    ASSERT_TRUE(writePng(ColourImage(480, 360, Rgba8{2, 2, 2, 255}), m_project.frames[i].image.path));
  }
  const auto summary = refineSequence(m_project, s_scene, m_pictures, {}, false, Progress());
  ASSERT_TRUE(summary) << summary.error().text();
  EXPECT_FALSE(summary->converged);
  EXPECT_NE(summary->reason.find("too dark"), std::string::npos) << summary->reason;
  EXPECT_FALSE(m_project.frames[0].originalCameraFromWorld);
  m_project.frames.resize(1);
  const auto alone = refineSequence(m_project, s_scene, m_pictures, {}, false, Progress());
  ASSERT_FALSE(alone);
  EXPECT_FALSE(alone.error().advice.empty());
  m_project.frames[0].cameraFromWorld.reset();
  const auto without = autoAlignFrame(m_project, s_scene, m_pictures, m_project.frames[0].id, {}, false, Progress());
  ASSERT_FALSE(without);
  EXPECT_NE(without.error().what.find("no pose to start from"), std::string::npos);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "transforms/transforms_reader.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {

namespace fs = std::filesystem;
using testing::HasSubstr;

namespace {

const std::string kStill = "[[1,0,0,10],[0,1,0,20],[0,0,1,30],[0,0,0,1]]";
const std::string kLens = "\"fl_x\":500,\"fl_y\":510,\"cx\":320,\"cy\":240,\"w\":640,\"h\":480";

std::string frame(const std::string& name, const std::string& matrix = kStill, const std::string& more = "") {
  return fmt::format(R"({{"file_path":"{}","transform_matrix":{}{}{}}})", name, matrix, more.empty() ? "" : ",", more);
}

Result<CameraSet> parsed(const std::string& head, const std::string& frames) {
  return parseTransforms(fmt::format(R"({{{}{}"frames":[{}]}})", head, head.empty() ? "" : ",", frames), "t.json",
                         [](const std::string&) { return std::optional<glm::ivec2>(); });
}

}  // namespace

TEST(Transforms, TheCameraLooksAlongMinusZWithYUp) {
  const auto set = parsed(kLens, frame("a.png"));
  ASSERT_TRUE(set) << set.error().text();
  const RigidTransform pose = *set->pictures.at(0).cameraFromWorld;
  EXPECT_LT(glm::length(pose.centre() - glm::dvec3(10, 20, 30)), 1e-12);
  // Identity: what lies at smaller z is ahead, larger y is up in the picture.
  EXPECT_LT(glm::length(pose * glm::dvec3(11, 22, 25) - glm::dvec3(1, -2, 5)), 1e-12);
  EXPECT_EQ(set->cameras.at(0).cx, 319.5) << "from the corner of the top-left pixel";
  EXPECT_EQ(set->cameras[0].model, CameraModel::Pinhole);
}

TEST(Transforms, AFramesOwnIntrinsicsGoFirst) {
  const auto set = parsed(kLens + ",\"k1\":-0.1", frame("a") + "," + frame("b", kStill, "\"fl_x\":600,\"k1\":0,\"k3\":0.01") + "," +
                                                      frame("c", kStill, "\"camera_model\":\"OPENCV_FISHEYE\"") + "," + frame("d"));
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->cameras.size(), 3u) << "a and d share one";
  EXPECT_EQ(set->pictures[0].camera, set->pictures[3].camera);
  EXPECT_EQ(set->cameras[0].model, CameraModel::OpenCv4);
  EXPECT_EQ(set->cameras[1].model, CameraModel::OpenCv5);
  EXPECT_EQ(set->cameras[1].fx, 600);
  EXPECT_EQ(set->cameras[1].distortion.k[2], 0.01);
  EXPECT_EQ(set->cameras[2].model, CameraModel::OpenCvFisheye);
}

TEST(Transforms, AFieldOfViewAndAMeasuredPictureDoWithoutTheRest) {
  const auto set = parseTransforms("{\"camera_angle_x\":" + fmt::format("{}", 2 * std::atan(0.5)) + ",\"frames\":[" + frame("./train/r_0") + "]}",
                                   "t.json", [](const std::string& name) {
                                     EXPECT_EQ(name, "./train/r_0");
                                     return std::optional(glm::ivec2(800, 600));
                                   });
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_NEAR(set->cameras[0].fx, 800, 1e-9);
  EXPECT_EQ(set->cameras[0].cx, 399.5);
  EXPECT_EQ(set->cameras[0].height, 600);
}

TEST(Transforms, NerfstudiosOwnTransformIsUndone) {
  // Nerfstudio's usual one: y and z change places, one turns round. A survey point under the camera stays under it.
  const std::string applied = "\"applied_transform\":[[0,1,0,5],[1,0,0,0],[0,0,-1,0]],\"applied_scale\":0.5";
  const auto set = parsed(kLens + "," + applied, frame("a"));
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->warnings.size(), 1u);
  // pInFile = 0.5 (A p): the centre (10,20,30) in the file is (20,40,60) before the scale, and A maps (40,15,-60) there.
  EXPECT_LT(glm::length(set->pictures[0].cameraFromWorld->centre() - glm::dvec3(40, 15, -60)), 1e-12);
  const auto plain = parsed(kLens, frame("a"));
  const glm::dvec3 inWorld(41, 17, -55), appliedToIt(17 + 5, 41, 55);
  const glm::dvec3 seen = *set->pictures[0].cameraFromWorld * inWorld, seenInFile = *plain->pictures[0].cameraFromWorld * (0.5 * appliedToIt);
  EXPECT_LT(glm::length(seen - 2.0 * seenInFile), 1e-12) << "the same ray, in metres again";
}

TEST(Transforms, WhatIsNotReadIsNamed) {
  const std::tuple<std::string, std::string, const char*> cases[] = {
      {kLens + ",\"camera_model\":\"EQUIRECTANGULAR\"", frame("a"), "'EQUIRECTANGULAR'"},
      {kLens + ",\"camera_model\":3", frame("a"), "'camera_model' is no text"},
      {kLens + ",\"k4\":0.1", frame("a"), "k4"},
      {kLens + ",\"is_fisheye\":true,\"p1\":0.1", frame("a"), "fisheye with p1"},
      {"\"fl_x\":500", frame("a"), "no w and h"},
      {"\"w\":640,\"h\":480", frame("a"), "no fl_x"},
      {"\"fl_x\":500,\"w\":640.5,\"h\":480", frame("a"), "impossible"},
      {"\"fl_x\":\"wide\",\"w\":640,\"h\":480", frame("a"), "'fl_x' is no number"},
      {"\"fl_x\":0,\"w\":640,\"h\":480", frame("a"), "not positive"},
      {kLens, "", "is empty"},
      {kLens, "3", "no object"},
      {kLens, "{\"file_path\":\"a\"}", "no 'transform_matrix'"},
      {kLens, "{\"transform_matrix\":" + kStill + "}", "no 'file_path'"},
      {kLens, frame("a", "[[1,0,0,0],[0,1,0,0]]"), "3 or 4 rows"},
      {kLens, frame("a", "[[1,0,0,0],[0,1,0,0],[0,0,1]]"), "not four numbers"},
      {kLens, frame("a", "[[1,0,0,1e999],[0,1,0,0],[0,0,1,0]]"), ""},
      {kLens, frame("a", "[[2,0,0,0],[0,2,0,0],[0,0,2,0]]"), "no rotation"},
      {kLens, frame("a", "[[1,0,0,0],[0,1,0,0],[0,0,-1,0]]"), "no rotation"},
      {kLens, frame("a", "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,2]]"), "0 0 0 1"},
      {kLens + ",\"applied_scale\":0", frame("a"), "applied_scale"},
  };
  for (const auto& [head, frames, words] : cases) {
    const auto set = parsed(head, frames);
    ASSERT_FALSE(set) << head << frames;
    EXPECT_THAT(set.error().what, HasSubstr(words));
    EXPECT_THAT(set.error().where, HasSubstr("t.json"));
    EXPECT_FALSE(set.error().advice.empty());
  }
  const auto none = [](const std::string&) { return std::optional<glm::ivec2>(); };
  for (const std::string& text : {std::string(), std::string("{"), std::string("[]"), std::string("{\"frames\":{}}"),
                                  "{\"frames\":" + std::string(100000, '[')})
    EXPECT_FALSE(parseTransforms(text, "t.json", none));
}

TEST(Transforms, SurvivesRandomDamage) {
  std::ifstream file(std::string(ALIDADE_SOURCE_DIR) + "/tests/fuzz/corpus/transforms/small.json");
  std::stringstream whole;
  whole << file.rdbuf();
  const auto none = [](const std::string&) { return std::optional<glm::ivec2>(); };
  ASSERT_TRUE(parseTransforms(whole.str(), "t.json", none));
  std::mt19937 random(3);
  for (int i = 0; i < 4000; ++i) {
    std::string text = whole.str();
    for (int k = 0; k < 3; ++k) text[random() % text.size()] = "0123456789-.eE[]{},:\" \xff"[random() % 23];
    if (random() % 6 == 0) text.resize(random() % text.size());
    (void)parseTransforms(text, "t.json", none);
  }
}

// The door's ground truth written by hand in the other convention: the centres and axes are those of images.txt.
TEST(Transforms, TheDoorInOpenGlAxesIsTheDoorInColmaps) {
  const fs::path images = std::string(ALIDADE_SHARED_DATA_DIR) + "/lund_door/colmap_ground_truth/images.txt";
  if (!fs::exists(images)) GTEST_SKIP() << "needs " << images;
  std::vector<RigidTransform> truth;
  std::string frames;
  std::ifstream file(images);
  for (std::string line, points; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream in(line);
    double id, w, x, y, z;
    glm::dvec3 t;
    in >> id >> w >> x >> y >> z >> t.x >> t.y >> t.z;
    std::getline(file, points);
    const RigidTransform cameraFromWorld{glm::normalize(glm::dquat(w, x, y, z)), t};
    truth.push_back(cameraFromWorld);
    const glm::dmat3 r = glm::transpose(cameraFromWorld.rotationMatrix());  // world from camera
    const glm::dvec3 c = cameraFromWorld.centre();
    if (!frames.empty()) frames += ",";
    frames += frame(fmt::format("{}.jpg", id), fmt::format("[[{},{},{},{}],[{},{},{},{}],[{},{},{},{}],[0,0,0,1]]", r[0][0], -r[1][0], -r[2][0],
                                                           c.x, r[0][1], -r[1][1], -r[2][1], c.y, r[0][2], -r[1][2], -r[2][2], c.z));
  }
  ASSERT_EQ(truth.size(), 12u);
  const auto set = parsed(kLens, frames);
  ASSERT_TRUE(set) << set.error().text();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT(rotationAngleBetween(*set->pictures[i].cameraFromWorld, truth[i]), 1e-12);
    EXPECT_LT(glm::length(set->pictures[i].cameraFromWorld->centre() - truth[i].centre()), 1e-12);
  }
}

}  // namespace alidade

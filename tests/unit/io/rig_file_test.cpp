// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/rig_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/device_chain.h"

namespace alidade {

using testing::HasSubstr;

namespace {

const std::string kRig = R"({ "alidade_rig": 1, "trajectory": "poses/t.txt", "time_offset_s": 0.25, "cameras": [
  { "name": "left", "pictures": "left", "calibration": "left.yml", "rate_hz": 15, "start_s": 2,
    "sensor_from_camera": { "position_m": [0.1, 0.2, 0.3], "rotation_wxyz": [0.6, 0.8, 0, 0] } },
  { "name": "right", "pictures": "right.mp4", "calibration": "right.yml", "camera_axes": "opengl",
    "device": { "camera_in_device_m": [0.4, 0.5, 0.6], "device_from_camera_wxyz": [0.6, 0, 0.8, 0] } } ] })";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST(RigFile, SaysWhereEveryCameraSitsOnTheSensor) {
  const auto rig = parseRig(kRig, "/data/rig.json");
  ASSERT_TRUE(rig) << rig.error().text();
  EXPECT_EQ(rig->trajectory, "/data/poses/t.txt");
  EXPECT_EQ(rig->timeOffsetSecs, 0.25);
  ASSERT_EQ(rig->cameras.size(), 2u);
  EXPECT_EQ(rig->cameras[0].pictures, "/data/left");
  EXPECT_EQ(rig->cameras[0].rateHz, 15.0);
  EXPECT_EQ(rig->cameras[0].startSecs, 2.0);
  EXPECT_FALSE(rig->cameras[1].rateHz);
  EXPECT_EQ(rig->cameras[0].sensorFromCamera->translation, glm::dvec3(0.1, 0.2, 0.3));
  EXPECT_EQ(rig->cameras[0].sensorFromCamera->rotation, glm::dquat(0.6, 0.8, 0.0, 0.0));
  // The device's way: through its chain, and half a turn about the camera's x for OpenGL's axes.
  const RigidTransform chained = sensorFromCamera({{0.4, 0.5, 0.6}, glm::dquat(0.6, 0.0, 0.8, 0.0)});
  const glm::dvec3 ahead = rig->cameras[1].sensorFromCamera->rotation * glm::dvec3(0, 0, 1);
  EXPECT_LT(glm::length(ahead - chained.rotation * glm::dvec3(0, 0, -1)), 1e-14);
  EXPECT_EQ(rig->cameras[1].sensorFromCamera->translation, glm::dvec3(0.4, 0.5, 0.6));
}

TEST(RigFile, ACalibrationMayBeLeftToSayWhereItsCameraSits) {
  const auto rig = parseRig(R"({ "alidade_rig": 1, "trajectory": "t.csv", "cameras": [
    { "name": "cam0", "pictures": "cam0/data", "calibration": "cam0/sensor.yaml", "rate_hz": 20 } ] })", "/data/rig.json");
  ASSERT_TRUE(rig) << rig.error().text();
  EXPECT_FALSE(rig->cameras[0].sensorFromCamera);
}

TEST(RigFile, WhatIsWrongIsNamedWithItsCamera) {
  const std::tuple<const char*, const char*, const char*, const char*> cases[] = {
      {"\"alidade_rig\": 1", "\"alidade_rig\": 2", "alidade_rig", "rig.json"},
      {"\"trajectory\"", "\"trayectory\"", "'trayectory' is unknown", "rig.json"},
      {"\"poses/t.txt\"", "3", "'trajectory'", "rig.json"},
      {"0.25", "\"soon\"", "'time_offset_s' is no number", "rig.json"},
      {"\"name\": \"left\", ", "", "'name' is missing", "camera 1"},
      {"\"rate_hz\": 15", "\"rate_hz\": 0", "rate_hz", "camera 1"},
      {"\"rate_hz\": 15, ", "", "'start_s' stands without", "camera 1"},
      {"[0.1, 0.2, 0.3]", "[0.1, 0.2]", "'position_m' is not a list of 3", "camera 1"},
      {"[0.6, 0.8, 0, 0]", "[0.6, 0.9, 0, 0]", "no unit quaternion", "camera 1"},
      {"[0.6, 0.8, 0, 0]", "[0.6, null, 0, 0]", "'rotation_wxyz'", "camera 1"},
      {"\"device\"", "\"devise\"", "'devise' is unknown", "camera 2"},
      {"\"opengl\"", "\"blender\"", "camera_axes", "camera 2"},
      {"\"camera_axes\": \"opengl\",", "\"sensor_from_camera\": {},", "One of", "camera 2"},
  };
  for (const auto& [from, to, words, where] : cases) {
    const auto rig = parseRig(replaced(kRig, from, to), "rig.json");
    ASSERT_FALSE(rig) << to;
    EXPECT_THAT(rig.error().what, HasSubstr(words));
    EXPECT_THAT(rig.error().where, HasSubstr(where));
  }
  for (const std::string& text : {std::string(), std::string("[]"), std::string(100000, '['), kRig.substr(0, 200),
                                  std::string(R"({"alidade_rig": 1, "trajectory": "t", "cameras": []})"),
                                  std::string(R"({"alidade_rig": 1, "trajectory": "t", "cameras": [3]})")})
    EXPECT_FALSE(parseRig(text, "rig.json"));
}

}  // namespace alidade

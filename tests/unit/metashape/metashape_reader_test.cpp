// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "metashape/metashape_reader.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/attitude.h"

namespace alidade {

namespace fs = std::filesystem;
using testing::HasSubstr;

namespace {

struct Xml {
  std::string sensorType = "frame";
  std::string lens = "<f>500</f><cx>3</cx><cy>-2</cy>";
  std::string components;
  std::string cameras = camera("a");
  std::string transform = "<transform><rotation>1 0 0 0 1 0 0 0 1</rotation><translation>0 0 0</translation><scale>1</scale></transform>";
  std::string reference = "LOCAL_CS[\"Local\"]";

  /// Looks straight down, the picture's top to the north: rows of chunk-from-camera.
  static std::string camera(const std::string& label, const std::string& attributes = "",
                            const std::string& transform = "1 0 0 1 0 -1 0 2 0 0 -1 3 0 0 0 1") {
    return "<camera id=\"" + label + "\" sensor_id=\"0\" label=\"" + label + "\" " + attributes + ">" +
           (transform.empty() ? "" : "<transform>" + transform + "</transform>") + "</camera>";
  }

  std::string text() const {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"1.5.0\"><chunk label=\"C\" enabled=\"true\"><sensors>"
           "<sensor id=\"0\" label=\"S\" type=\"" + sensorType + "\"><resolution width=\"640\" height=\"480\"/><calibration type=\"" +
           sensorType + "\" class=\"adjusted\"><resolution width=\"640\" height=\"480\"/>" + lens + "</calibration></sensor></sensors>" +
           components + "<cameras>" + cameras + "</cameras>" + transform + "<reference>" + reference + "</reference></chunk></document>";
  }
};

Result<CameraSet> parsed(const Xml& xml) { return parseMetashape(xml.text(), "cams.xml", Progress()); }

bool warns(const CameraSet& set, const std::string& words) {
  for (const auto& warning : set.warnings)
    if (warning.what.find(words) != std::string::npos) return true;
  return false;
}

/// Metashape's manual, "Frame cameras", word by word; OpenCV's pixel origin.
glm::dvec2 byTheManual(double x, double y, double f, double cx, double cy, double b1, double b2, double k1, double k2, double k3,
                       double k4, double p1, double p2) {
  const double r2 = x * x + y * y, radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * std::pow(r2, 3) + k4 * std::pow(r2, 4);
  const double xd = x * radial + p1 * (r2 + 2 * x * x) + 2 * p2 * x * y;
  const double yd = y * radial + p2 * (r2 + 2 * y * y) + 2 * p1 * x * y;
  return {640 * 0.5 + cx + xd * f + xd * b1 + yd * b2 - 0.5, 480 * 0.5 + cy + yd * f - 0.5};
}

std::string sharedFile(const std::string& name) { return std::string(ALIDADE_SHARED_DATA_DIR) + "/" + name; }

}  // namespace

TEST(Metashape, ProjectsAsTheManualSays) {
  Xml xml;
  xml.lens = "<f>500</f><cx>3</cx><cy>-2</cy><b1>1.5</b1><b2>0.75</b2><k1>-0.1</k1><k2>0.02</k2><k3>0.003</k3><k4>-0.001</k4>"
             "<p1>0.004</p1><p2>-0.002</p2>";
  const auto set = parsed(xml);
  ASSERT_TRUE(set) << set.error().text();
  const Camera camera(set->cameras.at(0));
  xml.lens = "<f>500</f><cx>3</cx><cy>-2</cy><k1>-0.1</k1><k2>0.02</k2><k3>0.003</k3><p1>0.004</p1><p2>-0.002</p2>";
  const auto plain = parsed(xml);
  ASSERT_TRUE(plain) << plain.error().text();
  EXPECT_EQ(plain->cameras[0].model, CameraModel::OpenCv5) << "no more than it needs";
  const Camera plainCamera(plain->cameras[0]);
  for (double x = -0.6; x <= 0.6; x += 0.15)
    for (double y = -0.45; y <= 0.45; y += 0.15) {
      const auto pixel = camera.project({2 * x, 2 * y, 2}), plainPixel = plainCamera.project({2 * x, 2 * y, 2});
      ASSERT_TRUE(pixel && plainPixel);
      EXPECT_LT(glm::length(*pixel - byTheManual(x, y, 500, 3, -2, 1.5, 0.75, -0.1, 0.02, 0.003, -0.001, 0.004, -0.002)), 1e-10);
      EXPECT_LT(glm::length(*plainPixel - byTheManual(x, y, 500, 3, -2, 0, 0, -0.1, 0.02, 0.003, 0, 0.004, -0.002)), 1e-10);
    }
}

TEST(Metashape, AFisheyeIsOpenCvsUnlessItIsDecentred) {
  Xml xml;
  xml.sensorType = "fisheye";
  xml.lens = "<f>300</f><cx>1</cx><cy>2</cy><k1>0.05</k1><k2>-0.01</k2>";
  const auto set = parsed(xml);
  ASSERT_TRUE(set) << set.error().text();
  const double theta = std::atan(0.5), bent = theta * (1 + 0.05 * theta * theta - 0.01 * std::pow(theta, 4));
  EXPECT_NEAR(Camera(set->cameras.at(0)).project({0.5, 0, 1})->x, 320 + 1 - 0.5 + 300 * bent, 1e-10);
  xml.lens += "<p1>0.001</p1>";
  const auto decentred = parsed(xml);
  ASSERT_FALSE(decentred);
  EXPECT_THAT(decentred.error().what, HasSubstr("fisheye with p1"));
}

TEST(Metashape, ScaleRotationAndTranslationLeadToTheWorld) {
  Xml xml;  // a quarter turn to the left, twice as large, then moved
  xml.transform = "<transform><rotation>0 -1 0 1 0 0 0 0 1</rotation><translation>100 200 5</translation><scale>2</scale></transform>";
  const auto set = parsed(xml);
  ASSERT_TRUE(set) << set.error().text();
  const RigidTransform pose = *set->pictures.at(0).cameraFromWorld;
  EXPECT_LT(glm::length(pose.centre() - glm::dvec3(100 - 2 * 2, 200 + 2 * 1, 5 + 2 * 3)), 1e-12);
  // The top of the picture was north of the chunk: now it is west.
  const glm::dvec3 up = pose.inverse().rotation * glm::dvec3(0, -1, 0);
  EXPECT_LT(glm::length(up - glm::dvec3(-1, 0, 0)), 1e-12);
  // What lies under the camera is ahead of it by its true distance, not by the chunk's.
  EXPECT_LT(glm::length(pose * (pose.centre() + glm::dvec3(0, 0, -7)) - glm::dvec3(0, 0, 7)), 1e-12);
}

TEST(Metashape, EveryComponentHasItsOwnTransform) {
  Xml xml;
  const auto component = [](const std::string& id, const std::string& east) {
    return "<component id=\"" + id + "\"><transform><rotation>1 0 0 0 1 0 0 0 1</rotation><translation>" + east +
           " 0 0</translation><scale>1</scale></transform></component>";
  };
  xml.components = "<components active_id=\"1\">" + component("0", "1000") + "<component id=\"1\"/>" + "<component id=\"2\"/></components>";
  xml.cameras = Xml::camera("a", "component_id=\"0\"") + Xml::camera("b", "component_id=\"1\"") + Xml::camera("c", "component_id=\"2\"") +
                Xml::camera("d");
  xml.transform = "<transform><rotation>1 0 0 0 1 0 0 0 1</rotation><translation>50 0 0</translation><scale>1</scale></transform>";
  const auto set = parsed(xml);
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->pictures.size(), 3u);
  EXPECT_NEAR(set->pictures[0].cameraFromWorld->centre().x, 1001, 1e-9);
  EXPECT_NEAR(set->pictures[1].cameraFromWorld->centre().x, 51, 1e-9) << "the active component has the chunk's";
  EXPECT_EQ(set->pictures[2].name, "d");
  EXPECT_TRUE(warns(*set, "1 cameras are in a component that is not placed"));
}

TEST(Metashape, WhatIsLeftOutIsNamed) {
  std::ifstream file(std::string(ALIDADE_SOURCE_DIR) + "/tests/fuzz/corpus/metashape/small.xml");
  std::stringstream text;
  text << file.rdbuf();
  const auto set = parseMetashape(text.str(), "small.xml", Progress());
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->pictures.size(), 1u) << "a, in a group";
  for (const char* words : {"have no transform", "are disabled", "not placed in the world", "sensor '1' were left out"})
    EXPECT_TRUE(warns(*set, words)) << words;
}

TEST(Metashape, AChunkWithoutTransformHasNoMetres) {
  Xml xml;
  xml.transform.clear();
  const auto set = parsed(xml);
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_TRUE(warns(*set, "arbitrary units"));
  EXPECT_LT(glm::length(set->pictures.at(0).cameraFromWorld->centre() - glm::dvec3(1, 2, 3)), 1e-12);
}

TEST(Metashape, AGeoreferencedChunkIsRefusedByItsReference) {
  Xml xml;
  xml.reference = "GEOGCS[\"WGS 84\",AUTHORITY[\"EPSG\",\"4326\"]]";
  xml.transform = "<transform><rotation>1 0 0 0 1 0 0 0 1</rotation><translation>4033468 335902 4911967</translation><scale>1</scale></transform>";
  const auto set = parsed(xml);
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error().what, HasSubstr("WGS 84"));
  EXPECT_THAT(set.error().what, HasSubstr("earth-centred"));
  EXPECT_THAT(set.error().advice, HasSubstr("local coordinates"));
  xml.transform = Xml().transform;
  const auto local = parsed(xml);
  ASSERT_TRUE(local) << local.error().text();
  EXPECT_TRUE(warns(*local, "taken as they stand"));
}

TEST(Metashape, BrokenFilesAreRefused) {
  const Xml good;
  ASSERT_TRUE(parsed(good));
  const auto refused = [](const Xml& xml, const std::string& words) {
    const auto set = parsed(xml);
    ASSERT_FALSE(set) << words;
    EXPECT_THAT(set.error().text(), HasSubstr(words));
    EXPECT_THAT(set.error().where, HasSubstr("cams.xml"));
    EXPECT_FALSE(set.error().advice.empty());
  };
  Xml xml = good;
  xml.lens = "<f>nan</f>";
  refused(xml, "not finite");
  xml.lens = "<f>wide</f>";
  refused(xml, "wide");
  xml.lens = "<f>-500</f>";
  refused(xml, "not positive");
  xml.lens = "";
  refused(xml, "not positive");
  xml.lens = "<fx>500</fx><fy>500</fy>";
  refused(xml, "PhotoScan");
  xml = good;
  xml.cameras = Xml::camera("a", "", "1 0 0 1 0 -1 0 2 0 0 -1 3 0 0 0");
  refused(xml, "not 16");
  xml.cameras = Xml::camera("a", "", "1 0 0 1 0 1 0 2 0 0 -1 3 0 0 0 1");
  refused(xml, "no rotation");
  xml.cameras = Xml::camera("a", "", "1 0 0 1e400 0 -1 0 2 0 0 -1 3 0 0 0 1");
  refused(xml, "not finite");
  xml.cameras = Xml::camera("");
  refused(xml, "no label");
  xml = good;
  xml.transform = "<transform><rotation>1 0 0 0 1 0 0 0 1</rotation><translation>0 0 0</translation><scale>0</scale></transform>";
  refused(xml, "scale 0");
  xml.transform = "<transform><rotation>1 0 0 0 1 0 0 0 2</rotation><translation>0 0 0</translation><scale>1</scale></transform>";
  refused(xml, "no rotation");
  xml = good;
  xml.sensorType = "spherical";
  refused(xml, "spherical");
  std::string nested;
  for (int i = 0; i < 20; ++i) nested += "<group>";
  xml = good;
  xml.cameras = nested + Xml::camera("a");
  for (int i = 0; i < 20; ++i) xml.cameras += "</group>";
  refused(xml, "nested too deep");
  for (const std::string& text : {std::string(), std::string("<document version=\"1\">"), std::string("<html/>"),
                                  "<document version=\"1\"><chunk>" + std::string(100000, '<'), good.text().substr(0, 300)})
    EXPECT_FALSE(parseMetashape(text, "cams.xml", Progress()));
}

TEST(Metashape, SurvivesRandomDamage) {
  const std::string whole = Xml().text();
  std::mt19937 random(8);
  for (int i = 0; i < 4000; ++i) {
    std::string text = whole;
    for (int k = 0; k < 4; ++k) text[random() % text.size()] = char(random() % 256);
    if (random() % 5 == 0) text.resize(random() % text.size());
    (void)parseMetashape(text, "cams.xml", Progress());
  }
}

/// The poses of sparse/images.txt as they stand there: name -> numbers.
std::map<std::string, std::vector<double>> colmapPoses(const fs::path& path) {
  std::map<std::string, std::vector<double>> poses;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream in(line);
    double id, camera;
    std::vector<double> v(7);
    std::string name;
    if (in >> id >> v[0] >> v[1] >> v[2] >> v[3] >> v[4] >> v[5] >> v[6] >> camera >> name) poses[fs::path(name).stem()] = v;
  }
  return poses;
}

TEST(Metashape, TheRoadsXmlSaysWhatItsColmapModelAndItsOpenCvCalibrationSay) {
  if (!fs::exists(sharedFile("road/road.xml"))) GTEST_SKIP() << "needs " << sharedFile("road/road.xml");
  const auto set = MetashapeReader().read(sharedFile("road/road.xml"), Progress());
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_TRUE(set->warnings.empty());
  const auto poses = colmapPoses(sharedFile("road/sparse/images.txt"));
  ASSERT_EQ(set->pictures.size(), 78u);
  ASSERT_EQ(poses.size(), 78u);
  for (const PosedPicture& picture : set->pictures) {
    const auto& v = poses.at(picture.name);
    const RigidTransform colmap{glm::normalize(glm::dquat(v[0], v[1], v[2], v[3])), {v[4], v[5], v[6]}};
    EXPECT_LT(rotationAngleBetween(*picture.cameraFromWorld, colmap), 1e-10) << picture.name;
    // images.txt has twelve decimals of a rotation, 2e5 m from its origin, and six of a translation.
    EXPECT_LT(glm::length(picture.cameraFromWorld->centre() - colmap.centre()), 5e-6) << picture.name;
    EXPECT_EQ(picture.camera, 1) << "the calibrated sensor";
  }
  const Intrinsics& lens = set->cameras.at(1);  // opencv_calib.yml
  EXPECT_DOUBLE_EQ(lens.fx, 3693.1569475809993);
  EXPECT_DOUBLE_EQ(lens.cx, 2731.4405032761174);
  EXPECT_DOUBLE_EQ(lens.cy, 1846.493249050933);
  EXPECT_EQ(lens.distortion.p1, -0.000503346062832222);
  EXPECT_EQ(lens.distortion.p2, -0.0005062622264917514);
  EXPECT_EQ(lens.distortion.k[2], -0.030410562029402437);
}

// The drone's own measured angles stand beside the adjusted poses: they agree to the few degrees that such a
// compass is good for, on level flight and on pictures taken at 45 degrees. A wrong axis or sign is off by tens.
TEST(Metashape, TheRoadsMeasuredAnglesAgreeWithItsPosesInTheFloorCamerasSense) {
  const std::string path = sharedFile("road/road.xml");
  if (!fs::exists(path)) GTEST_SKIP() << "needs " << path;
  const auto set = MetashapeReader().read(path, Progress());
  ASSERT_TRUE(set) << set.error().text();
  std::ifstream file(path);
  std::size_t at = 0, oblique = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.find("<reference x=") == std::string::npos) continue;
    const auto number = [&](const std::string& name) { return std::stod(line.substr(line.find(name + "=\"") + name.size() + 2)); };
    const double pitch = number("pitch");
    const glm::dquat measured = worldFromFloorCamera(
        {radiansFromDegrees(number("yaw")), radiansFromDegrees(pitch), radiansFromDegrees(number("roll"))});
    const RigidTransform worldFromCamera = set->pictures.at(at++).cameraFromWorld->inverse();
    EXPECT_LT(degreesFromRadians(rotationAngleBetween({measured, {}}, worldFromCamera)), 6.0) << set->pictures[at - 1].name;
    EXPECT_LT(glm::length(worldFromCamera.translation - glm::dvec3(number("x"), number(" y"), number(" z"))), 1.0);
    oblique += pitch > 40;
  }
  EXPECT_EQ(at, 78u);
  EXPECT_GE(oblique, 4u);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "realitycapture/xmp_reader.h"

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {

namespace fs = std::filesystem;
using testing::HasSubstr;

namespace {

std::string small() {
  std::ifstream file(std::string(ALIDADE_SOURCE_DIR) + "/tests/fuzz/corpus/realitycapture/small.xmp");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

Result<XmpCamera> parsed(const std::string& text) { return parseXmp(text, "a.xmp", glm::ivec2(4000, 3000)); }

std::string changed(const std::string& from, const std::string& to) { return replaced(small(), from, to); }

/// A BMP of 1 bit a pixel.
void writeBmp(const fs::path& path, int width, int height) {
  std::string bmp("BM\0\0\0\0\0\0\0\0\x3e\0\0\0\x28\0\0\0\0\0\0\0\0\0\0\0\1\0\1\0", 30);
  const auto put = [&](std::size_t at, int value) {
    for (std::size_t i = 0; i < 4; ++i) bmp[at + i] = static_cast<char>(value >> (8 * i));
  };
  put(18, width);
  put(22, height);
  bmp.resize(62 + std::size_t((width + 31) / 32 * 4) * std::size_t(height), '\0');
  std::ofstream(path, std::ios::binary).write(bmp.data(), std::streamsize(bmp.size()));
}

}  // namespace

TEST(RealityCapture, RotationIsCameraFromWorldByRowsAndPositionTheCentre) {
  const auto camera = parsed(changed("1 0 0 0 -1 0 0 0 -1", "0 1 0 1 0 0 0 0 -1"));
  ASSERT_TRUE(camera) << camera.error().text();
  EXPECT_LT(glm::length(camera->cameraFromWorld->centre() - glm::dvec3(100, 200, 30)), 1e-12);
  // x = R (X - Position): north of the camera is right, east is down, below is ahead.
  EXPECT_LT(glm::length(*camera->cameraFromWorld * glm::dvec3(102, 201, 25) - glm::dvec3(1, 2, 5)), 1e-12);
  // Read by columns the matrix would be another one.
  const auto turned = parsed(changed("1 0 0 0 -1 0 0 0 -1", "0 1 0 0 0 1 1 0 0"));
  ASSERT_TRUE(turned);
  EXPECT_LT(glm::length(turned->cameraFromWorld->rotation * glm::dvec3(1, 2, 3) - glm::dvec3(2, 3, 1)), 1e-12);
}

TEST(RealityCapture, LensesAreInUnitsOfTheLongerSideFromThePicturesMiddle) {
  const auto camera = parsed(small());
  ASSERT_TRUE(camera && camera->intrinsics) << camera->noIntrinsics;
  const Intrinsics& in = *camera->intrinsics;
  EXPECT_DOUBLE_EQ(in.fx, 27.0 / 36 * 4000);
  EXPECT_DOUBLE_EQ(in.fy, 27.0 / 36 * 4000 * 1.01);
  EXPECT_DOUBLE_EQ(in.cx, 2000 - 40 - 0.5);
  EXPECT_DOUBLE_EQ(in.cy, 1500 + 80 - 0.5);
  const double x = 0.4, y = -0.3, r2 = 0.25, radial = 1 - 0.1 * r2 + 0.02 * r2 * r2 - 0.003 * r2 * r2 * r2 + 0.0004 * r2 * r2 * r2 * r2;
  const auto pixel = Camera(in).project({x, y, 1});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x, 1959.5 + 3000 * x * radial, 1e-9);
  EXPECT_NEAR(pixel->y, 1579.5 + 3030 * y * radial, 1e-9);
  const auto upright = parseXmp(small(), "a.xmp", glm::ivec2(3000, 4000));
  EXPECT_DOUBLE_EQ(upright->intrinsics->fx, 3000) << "upright pictures too";
  EXPECT_DOUBLE_EQ(upright->intrinsics->cx, 1500 - 40 - 0.5);
}

TEST(RealityCapture, ALensThatCannotBeSaidExactlyIsLeftOutWithItsReason) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"0.0004 0 0", "0.0004 0.001 0", "tangential"},
      {"brown4", "division", "'division'"},
      {"Skew=\"0\"", "Skew=\"0.1\"", "skew"},
      {"FocalLength35mm=\"27\"", "FocalLength35mm=\"\"", "no focal length"},
  };
  for (const auto& [from, to, words] : cases) {
    const auto camera = parsed(changed(from, to));
    ASSERT_TRUE(camera) << to;
    EXPECT_TRUE(camera->cameraFromWorld);
    EXPECT_FALSE(camera->intrinsics);
    EXPECT_THAT(camera->noIntrinsics, HasSubstr(words));
  }
  EXPECT_THAT(parseXmp(small(), "a.xmp", std::nullopt)->noIntrinsics, HasSubstr("no picture"));
  const auto straight = parsed(replaced(changed("brown4", "division"), "-0.1 0.02 -0.003 0.0004 0 0", "0 0 0 0 0 0"));
  EXPECT_TRUE(straight->intrinsics) << "without distortion every model is the same";
}

TEST(RealityCapture, GeographicAndEarthCentredCoordinatesAreRefused) {
  const auto earth = parsed(changed("100 200 30", "4033468 335902 4911967"));
  ASSERT_FALSE(earth);
  EXPECT_THAT(earth.error().what, HasSubstr("earth-centred"));
  EXPECT_TRUE(parsed(changed("100 200 30", "334567 6251234 30"))) << "a grid's northing is as large on the southern half";
  auto text = replaced(changed("<xcr:Position>100 200 30</xcr:Position>", ""), "<xcr:Rotation>1 0 0 0 -1 0 0 0 -1</xcr:Rotation>", "");
  const auto poseless = parsed(text);
  ASSERT_TRUE(poseless);
  EXPECT_FALSE(poseless->cameraFromWorld);
  const auto geographic = parsed(replaced(text, "xcr:Version=\"3\"", "xcr:Version=\"3\" xcr:latitude=\"50.1N\""));
  ASSERT_FALSE(geographic);
  EXPECT_THAT(geographic.error().what, HasSubstr("latitude"));
}

TEST(RealityCapture, BrokenFilesAreRefused) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"1 0 0 0 -1 0 0 0 -1", "1 0 0 0 -1 0 0 0", "8 and 3"},   {"1 0 0 0 -1 0 0 0 -1", "1 0 0 0 1 0 0 0 -1", "no rotation"},
      {"1 0 0 0 -1", "1 0 0 0 nan", "not finite"},              {"100 200 30", "100 200 high", "'100 200 high'"},
      {"100 200 30", "1e999 200 30", "not finite"},             {"Length35mm=\"27\"", "Length35mm=\"-27\"", "not positive"},
      {"Length35mm=\"27\"", "Length35mm=\"2 7\"", "not one number"}, {"</rdf:RDF>", "", "damaged"},
  };
  for (const auto& [from, to, words] : cases) {
    const auto camera = parsed(changed(from, to));
    ASSERT_FALSE(camera) << to;
    EXPECT_THAT(camera.error().text(), HasSubstr(words));
    EXPECT_THAT(camera.error().where, HasSubstr("a.xmp"));
  }
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += "<a>";
  for (const std::string& text : {std::string(), std::string("<a/>"), deep}) EXPECT_FALSE(parsed(text));
}

TEST(RealityCapture, SurvivesRandomDamage) {
  std::mt19937 random(9);
  for (int i = 0; i < 4000; ++i) {
    std::string text = small();
    for (int k = 0; k < 3; ++k) text[random() % text.size()] = char(random() % 256);
    (void)parsed(text);
  }
}

TEST(RealityCapture, AFolderOfPicturesAndSidecarsIsOneSetOfCameras) {
  std::string pattern = (fs::temp_directory_path() / "alidade-xmp-XXXXXX").string();
  const fs::path folder = mkdtemp(pattern.data());
  for (const char* name : {"a", "b"}) {
    writeBmp(folder / (std::string(name) + ".bmp"), 400, 300);
    std::ofstream(folder / (std::string(name) + ".xmp")) << small();
  }
  std::ofstream(folder / "c.XMP") << small();  // no picture beside it
  std::ofstream(folder / "d.xmp") << "<x:xmpmeta/>";
  FileProbe probe;
  probe.path = folder.string();
  probe.isFolder = true;
  const int score = XmpReader().sniff(probe);
  const auto set = XmpReader().read(folder.string(), Progress());
  const auto one = XmpReader().read((folder / "b.xmp").string(), Progress());
  std::ofstream(folder / "a.xmp") << changed("100 200 30", "x");
  const auto broken = XmpReader().read(folder.string(), Progress());
  fs::remove_all(folder);
  EXPECT_GT(score, 0);
  EXPECT_LT(score, 50) << "a folder of pictures is one of pictures first";
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->pictures.size(), 3u);
  EXPECT_EQ(set->pictures[0].name, "a.bmp");
  EXPECT_EQ(set->pictures[1].camera, 0);
  EXPECT_EQ(set->pictures[2].camera, -1);
  EXPECT_EQ(set->cameras.size(), 1u) << "the same lens once";
  EXPECT_EQ(set->cameras[0].width, 400);
  ASSERT_EQ(set->warnings.size(), 1u);
  ASSERT_TRUE(one);
  EXPECT_EQ(one->pictures.at(0).name, "b.bmp");
  EXPECT_FALSE(broken);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/e57_image_readers.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

#include "unit/e57/e57_builder.h"
#include "unit/ply/scan_reading.h"

namespace fs = std::filesystem;
using namespace alidade;
using alidade::testing::E57Builder;
using alidade::testing::TemporaryFile;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

const fs::path kData = fs::path(ALIDADE_SHARED_DATA_DIR) / "e57";

/// A PNG of 2 × 1 pixels, red and blue, 8 bits RGB, stored without compression; made by hand.
std::string tinyPng() {
  const auto number = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255);
    return bytes;
  };
  const auto chunk = [&](const std::string& body) {
    std::uint32_t sum = 0xFFFFFFFF;  // PNG's own CRC-32
    for (const char c : body) {
      sum ^= static_cast<unsigned char>(c);
      for (int bit = 0; bit < 8; ++bit) sum = sum & 1 ? sum >> 1 ^ 0xEDB88320 : sum >> 1;
    }
    return number(static_cast<std::uint32_t>(body.size() - 4)) + body + number(~sum);
  };
  const std::string row("\0\xff\0\0\0\0\xff", 7);
  std::uint32_t a = 1, b = 0;  // Adler-32
  for (const char c : row) a = (a + static_cast<unsigned char>(c)) % 65521, b = (b + a) % 65521;
  const std::string zlib = std::string("\x78\x01\x01\x07\x00\xf8\xff", 7) + row + number(b << 16 | a);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR" + number(2) + number(1) + std::string("\x08\x02\0\0\0", 5)) + chunk("IDAT" + zlib) + chunk("IEND");
}

std::string blob(const std::string& bytes) {
  std::string section(16, '\0');
  alidade::testing::putLittleEndian(section, 8, std::uint64_t(16 + bytes.size()));
  return section + bytes;
}

std::string number(const std::string& name, double value) {
  std::ostringstream text;
  text.precision(17);
  text << "<" << name << " type=\"Float\">" << value << "</" << name << ">";
  return text.str();
}

std::string pinholeXml(const std::string& name, std::uint64_t at, std::size_t length, const std::string& pose, double focal = 0.008) {
  return "<vectorChild type=\"Structure\"><name type=\"String\">" + name + "</name>" + pose +
         "<pinholeRepresentation type=\"Structure\"><pngImage type=\"Blob\" fileOffset=\"" + std::to_string(at) + "\" length=\"" +
         std::to_string(length) + "\"/><imageWidth type=\"Integer\">640</imageWidth><imageHeight type=\"Integer\">480</imageHeight>" +
         number("focalLength", focal) + number("pixelWidth", 1e-5) + number("pixelHeight", 2e-5) + number("principalPointX", 319.5) +
         number("principalPointY", 200) + "</pinholeRepresentation></vectorChild>";
}

std::string images(const std::string& all) { return "<images2D type=\"Vector\">" + all + "</images2D>"; }

}  // namespace

TEST(E57Images, APinholeCameraSeesWhatTheStandardsFormulaSays) {
  // 30 degrees about z, standing in survey coordinates.
  const double c = std::cos(M_PI / 12), s = std::sin(M_PI / 12);
  const std::string pose = "<pose type=\"Structure\"><rotation type=\"Structure\">" + number("w", c) + number("x", 0) + number("y", 0) +
                           number("z", s) + "</rotation><translation type=\"Structure\">" + number("x", 5e5) + number("y", 6e6) +
                           number("z", 50) + "</translation></pose>";
  E57Builder builder;
  const std::string png = tinyPng();
  const auto at = builder.add(blob(png));
  const TemporaryFile file("camera.e57", builder.finish(images(pinholeXml("left", at, png.size(), pose) + pinholeXml("left", at, png.size(), ""))));
  const auto set = E57CameraReader().read(file.path(), Progress());
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->cameras.size(), 1u);  // both pictures are of one camera
  ASSERT_EQ(set->pictures.size(), 2u);
  EXPECT_EQ(set->pictures[0].name, "left");
  EXPECT_EQ(set->pictures[1].name, "left (2)");
  EXPECT_FALSE(set->pictures[1].cameraFromWorld);
  ASSERT_TRUE(set->pictures[0].cameraFromWorld);
  // E2807: the camera looks along -z, x to the right, y up: a point (1, 0.5, -4) of the camera's frame.
  const glm::dvec3 local(1, 0.5, -4);
  const double turn = M_PI / 6;
  const glm::dvec3 world(5e5 + std::cos(turn) * local.x - std::sin(turn) * local.y, 6e6 + std::sin(turn) * local.x + std::cos(turn) * local.y, 50 + local.z);
  const auto pixel = Camera(set->cameras[0]).project(*set->pictures[0].cameraFromWorld * world);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x, 319.5 + 800 * 0.25, 1e-5);
  EXPECT_NEAR(pixel->y, 200 - 400 * 0.125, 1e-5);

  const auto info = E57PictureReader().inspect(file.path());
  ASSERT_TRUE(info);
  EXPECT_EQ(info->pictures.size(), 2u);
  const auto source = E57PictureReader().open(file.path());
  ASSERT_TRUE(source);
  const auto picture = (*source)->picture(1);
  ASSERT_TRUE(picture) << picture.error().text();
  ASSERT_EQ(picture->width(), 2);
  EXPECT_EQ(picture->row(0)[0].r, 255);
  EXPECT_EQ(picture->row(0)[0].b, 0);
  EXPECT_EQ(picture->row(0)[1].b, 255);
  EXPECT_FALSE((*source)->picture(2));
}

TEST(E57Images, PanoramasAndUselessLensesAreNamed) {
  const std::string panorama = "<vectorChild type=\"Structure\"><name type=\"String\">dome</name><sphericalRepresentation type=\"Structure\">"
                               "<imageWidth type=\"Integer\">100</imageWidth><imageHeight type=\"Integer\">50</imageHeight></sphericalRepresentation></vectorChild>";
  const TemporaryFile file("dome.e57", E57Builder().finish(images(panorama + pinholeXml("blind", 48, 10, "", 0))));
  const auto set = E57CameraReader().read(file.path(), Progress());
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_TRUE(set->cameras.empty());
  std::string warnings;
  for (const auto& warning : set->warnings) warnings += warning.what + "; ";
  EXPECT_THAT(warnings, HasSubstr("'dome' is a spherical panorama"));
  EXPECT_THAT(warnings, HasSubstr("'blind' has no usable focal length"));
  const TemporaryFile alone("alone.e57", E57Builder().finish(images(panorama)));
  EXPECT_THAT(E57PictureReader().inspect(alone.path()).error().text(), HasSubstr("none of a pinhole camera"));
}

TEST(E57Images, BrokenPicturesAreRefusedWithTheirReason) {
  const std::string png = tinyPng();
  const auto errorOf = [&](const std::string& bytes, std::size_t length, std::uint64_t shift = 0) {
    E57Builder builder;
    const auto at = builder.add(bytes);
    const TemporaryFile file("broken.e57", builder.finish(images(pinholeXml("p", at + shift, length, ""))));
    const auto source = E57PictureReader().open(file.path());
    if (!source) return source.error().text();
    const auto picture = (*source)->picture(0);
    return picture ? std::string("no error") : picture.error().text();
  };
  EXPECT_EQ(errorOf(blob(png), png.size()), "no error");
  EXPECT_THAT(errorOf(blob(png), 1u << 30), HasSubstr("no picture of 1073741824 bytes"));
  EXPECT_THAT(errorOf(blob(png), png.size(), 4), HasSubstr("no picture"));
  EXPECT_THAT(errorOf(blob(png), png.size(), 1u << 30), HasSubstr("beyond the end"));
  EXPECT_THAT(errorOf(blob("not a picture"), 13), HasSubstr("no picture that can be read"));
  EXPECT_THAT(errorOf(blob(png.substr(0, 40)), 40), ::testing::Not("no error"));
}

TEST(E57Images, TheSharedFileOfLibE57FormatGivesItsLensAndPictures) {
  const fs::path path = kData / "self/PinholeImageWithDistortionParameters.e57";
  if (!fs::exists(path)) GTEST_SKIP() << "SKIPPED: no real data at " << path;
  const auto set = E57CameraReader().read(path.string(), Progress());
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->pictures.size(), 3u);
  ASSERT_EQ(set->cameras.size(), 1u);  // the others state no focal length
  const std::vector<double> stated = {31.31, 32.32, 21.21, 22.22, 1.01, 2.02, 11.11, 12.12, 3.03, 4.04, 5.05, 6.06};
  const auto parameters = set->cameras[0].parameters();
  ASSERT_EQ(parameters.size(), stated.size());
  for (std::size_t i = 0; i < stated.size(); ++i) EXPECT_NEAR(parameters[i], stated[i], 1e-5) << i;
  EXPECT_EQ(set->pictures[0].camera, 0);
  EXPECT_EQ(set->pictures[2].camera, -1);
  const auto source = E57PictureReader().open(path.string());
  ASSERT_TRUE(source);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto picture = (*source)->picture(i);
    ASSERT_TRUE(picture) << picture.error().text();
    EXPECT_EQ(picture->width(), 1);
    EXPECT_EQ(picture->height(), 1);
  }
}

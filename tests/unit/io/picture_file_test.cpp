// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/picture_file.h"

#include <csignal>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <sys/resource.h>

#include "unit/io/test_folder.h"

namespace alidade {

namespace {

ColourImage noise(int width, int height) {
  ColourImage image(width, height);
  std::mt19937 random(5);
  for (std::size_t i = 0; i < image.size(); ++i)
    image.data()[i] = {std::uint8_t(random()), std::uint8_t(random()), std::uint8_t(random()), std::uint8_t(random())};
  return image;
}

}  // namespace

TEST(PictureFile, APngComesBackPixelByPixel) {
  const TestFolder folder;
  const ColourImage image = noise(37, 23);
  ASSERT_TRUE(writePng(image, folder / "a.png"));
  const auto back = readPicture(folder / "a.png");
  ASSERT_TRUE(back) << back.error().text();
  ASSERT_EQ(back->size(), image.size());
  EXPECT_TRUE(std::equal(image.data(), image.data() + image.size(), back->data()));
  // OpenCV is the outside witness for the channel order.
  const cv::Mat seen = cv::imread(folder / "a.png", cv::IMREAD_UNCHANGED);
  EXPECT_EQ(seen.at<cv::Vec4b>(3, 5)[0], image.at(5, 3).b);
  EXPECT_EQ(seen.at<cv::Vec4b>(3, 5)[2], image.at(5, 3).r);
}

TEST(PictureFile, TextChunksComeBack) {
  const TestFolder folder;
  const std::map<std::string, std::string> text = {
      {"Frame", "101_0367_0007.JPG"}, {"Project", "Straße – Nord"}, {"Empty", ""}, {"Long", std::string(100000, 'x')}};
  ASSERT_TRUE(writePng(noise(4, 4), folder / "t.png", text));
  const auto back = readPngText(folder / "t.png");
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_EQ(*back, text);
}

TEST(PictureFile, RefusesTextThatPngCannotKeep) {
  const TestFolder folder;
  EXPECT_FALSE(writePng(noise(2, 2), folder / "a.png", {{"", "x"}}));
  EXPECT_FALSE(writePng(noise(2, 2), folder / "a.png", {{std::string(80, 'k'), "x"}}));
  EXPECT_FALSE(writePng(noise(2, 2), folder / "a.png", {{"k", std::string("a\0b", 3)}}));
  EXPECT_EQ(folder.count(), 0u);
}

TEST(PictureFile, AFullDiskIsAnErrorAndLeavesNoHalfFile) {
  const TestFolder folder;
  ASSERT_TRUE(writePng(noise(2, 2), folder / "old.png"));
  const std::string before = TestFolder::read(folder / "old.png");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit tight{10000, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &tight);
  const auto written = writePng(noise(300, 300), folder / "old.png");
  setrlimit(RLIMIT_FSIZE, &old);
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().what, testing::HasSubstr("no room"));
  EXPECT_EQ(TestFolder::read(folder / "old.png"), before);
  EXPECT_EQ(folder.count(), 1u);
}

TEST(PictureFile, ADeviceWithoutRoomIsAnError) {
  if (!std::filesystem::is_character_file("/dev/full")) GTEST_SKIP() << "no /dev/full on this machine";
  const auto written = writePng(noise(300, 300), "/dev/full");
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().what, testing::HasSubstr("no room"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full")) << "the device itself is not replaced";
}

TEST(PictureFile, GrayAndSixteenBitsBecomeEightBitColour) {
  const TestFolder folder;
  cv::Mat gray(2, 3, CV_16UC1);
  for (int i = 0; i < 6; ++i) gray.at<std::uint16_t>(i / 3, i % 3) = std::uint16_t(i * 13107);
  cv::imwrite(folder / "g.png", gray);
  const auto image = readPicture(folder / "g.png");
  ASSERT_TRUE(image) << image.error().text();
  for (int i = 0; i < 6; ++i) {
    const auto v = static_cast<std::uint8_t>(i * 51);
    EXPECT_EQ(image->at(i % 3, i / 3), (Rgba8{v, v, v, 255}));
  }
}

TEST(PictureFile, ExifOrientationIsNotApplied) {
  const TestFolder folder;
  cv::imwrite(folder / "a.jpg", cv::Mat(20, 40, CV_8UC3, cv::Scalar(10, 20, 30)));
  std::string jpeg = TestFolder::read(folder / "a.jpg");
  // APP1 with one tag: orientation 6, a quarter turn (Exif 2.3, 4.6.4).
  const std::string exif("\xff\xe1\0\x22"
                         "Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0", 36);
  jpeg.insert(2, exif);
  folder.write("turned.jpg", jpeg);
  ASSERT_EQ(cv::imread(folder / "turned.jpg").cols, 20) << "the tag itself works";
  const auto image = readPicture(folder / "turned.jpg");
  ASSERT_TRUE(image) << image.error().text();
  EXPECT_EQ(image->width(), 40);
}

TEST(PictureFile, RefusesBrokenPictures) {
  const TestFolder folder;
  EXPECT_EQ(readPicture(folder / "none.png").error().where, folder / "none.png");
  EXPECT_EQ(readPicture(folder.write("e.png", "")).error().what, "The picture file is empty");
  EXPECT_THAT(readPicture(folder.write("t.png", "no picture at all")).error().what, testing::HasSubstr("no picture"));
  EXPECT_FALSE(readPicture(folder.path().string()));
  for (const std::string ending : {".png", ".jpg", ".tif", ".webp", ".bmp"}) {
    cv::Mat picture(64, 48, CV_8UC3);
    cv::randu(picture, 0, 255);
    cv::imwrite(folder / ("whole" + ending), picture);
    ASSERT_TRUE(readPicture(folder / ("whole" + ending))) << ending;
    const std::string whole = TestFolder::read(folder / ("whole" + ending));
    for (int part = 1; part < 10; ++part)
      EXPECT_FALSE(readPicture(folder.write("cut" + ending, whole.substr(0, whole.size() * std::size_t(part) / 10)))) << ending << part;
  }
}

TEST(PictureFile, RefusesAHeaderThatPromisesMoreThanTheFileCanHold) {
  const TestFolder folder;
  ASSERT_TRUE(writePng(noise(4, 4), folder / "a.png"));
  std::string png = TestFolder::read(folder / "a.png");
  png.replace(16, 8, std::string("\0\0\x50\0\0\0\x50\0", 8));  // 20480 × 20480
  EXPECT_THAT(readPicture(folder.write("b.png", png)).error().what, testing::HasSubstr("20480 × 20480"));
  png.replace(16, 8, "\x7f\xff\xff\xff\x7f\xff\xff\xff");
  EXPECT_FALSE(readPicture(folder.write("c.png", png)));
}

TEST(PictureFile, RefusesDamagedText) {
  const TestFolder folder;
  ASSERT_TRUE(writePng(noise(4, 4), folder / "a.png", {{"Key", "value"}}));
  std::string png = TestFolder::read(folder / "a.png");
  png[png.find("value")] = 'V';
  EXPECT_THAT(readPngText(folder.write("b.png", png)).error().what, testing::HasSubstr("checksum"));
  EXPECT_FALSE(readPngText(folder.write("c.png", png.substr(0, 60))));
  EXPECT_FALSE(readPngText(folder.write("d.png", "text")));
}

TEST(PictureFile, ReadsTheRealPhotographs) {
  const std::string photo = std::string(ALIDADE_SHARED_DATA_DIR) + "/road/101_0367_0007.JPG";
  if (!std::filesystem::exists(photo)) GTEST_SKIP() << "needs " << photo;
  const auto image = readPicture(photo);
  ASSERT_TRUE(image) << image.error().text();
  EXPECT_EQ(image->width(), 5472);
  EXPECT_EQ(image->height(), 3648);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plugin_api/picture_header.h"

#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace alidade {

namespace fs = std::filesystem;

class PictureHeaderTest : public testing::Test {
 protected:
  PictureHeaderTest() {
    std::string pattern = (fs::temp_directory_path() / "alidade-header-XXXXXX").string();
    m_folder = mkdtemp(pattern.data());
  }
  ~PictureHeaderTest() override { fs::remove_all(m_folder); }

  std::string write(const std::string& bytes) const {
    const std::string path = (m_folder / "p.bin").string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  fs::path m_folder;
};

TEST_F(PictureHeaderTest, AgreesWithOpenCvOnEveryFormat) {
  for (const std::string ending : {"png", "jpg", "tif", "bmp", "webp"}) {
    const std::string path = (m_folder / ("a." + ending)).string();
    ASSERT_TRUE(cv::imwrite(path, cv::Mat(123, 457, CV_8UC3, cv::Scalar(1, 2, 3))));
    const auto header = readPictureHeader(path);
    ASSERT_TRUE(header) << header.error().text();
    EXPECT_EQ(header->width, 457) << ending;
    EXPECT_EQ(header->height, 123) << ending;
    EXPECT_TRUE(checkPictureComplete(path, *header)) << ending;
  }
}

TEST_F(PictureHeaderTest, AProgressiveJpegIsComplete) {
  cv::Mat picture(200, 300, CV_8UC3);
  cv::randu(picture, 0, 255);
  const std::string path = (m_folder / "p.jpg").string();
  cv::imwrite(path, picture, {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 3});
  EXPECT_TRUE(checkPictureComplete(path, *readPictureHeader(path)));
  fs::resize_file(path, fs::file_size(path) - 2);
  EXPECT_FALSE(checkPictureComplete(path, *readPictureHeader(path)));
}

TEST_F(PictureHeaderTest, SurvivesRandomBytesBehindEverySignature) {
  std::mt19937 random(1);
  const std::string starts[] = {"\x89PNG\r\n\x1a\n", "\xff\xd8\xff", std::string("II*\0", 4), std::string("MM\0+", 4), "BM", "RIFF1234WEBPVP8X"};
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = starts[random() % std::size(starts)];
    for (std::size_t k = random() % 200; k > 0; --k) bytes += static_cast<char>(random() % 4 ? random() : 0);
    const std::string path = write(bytes);
    if (const auto header = readPictureHeader(path)) {
      EXPECT_GT(header->width, 0);
      EXPECT_LE(std::int64_t(header->width) * header->height, std::int64_t(1) << 29);
      (void)checkPictureComplete(path, *header);
    }
  }
}

TEST(PicturePixels, NarrowsSixteenBitsByRounding) {
  const std::uint16_t gray[] = {0, 128, 129, 257, 65535};
  const ColourImage image = colourImageFrom({reinterpret_cast<const unsigned char*>(gray), sizeof gray, 5, 1, 1, 2});
  const std::uint8_t expected[] = {0, 0, 1, 1, 255};
  for (int x = 0; x < 5; ++x) EXPECT_EQ(image.at(x, 0).g, expected[x]);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pictures/video_reader.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "pictures/video_decoder.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

constexpr int kWidth = 192, kHeight = 96, kFrames = 200;

/// The frame's number as eight black or white squares, which any codec keeps; a moving bar besides.
cv::Mat numbered(int number) {
  cv::Mat frame(kHeight, kWidth, CV_8UC3, cv::Scalar(90, 110, 130));
  for (int bit = 0; bit < 8; ++bit)
    cv::rectangle(frame, cv::Rect(bit * 24, 0, 24, 48), cv::Scalar::all(number >> bit & 1 ? 255 : 0), cv::FILLED);
  cv::rectangle(frame, cv::Rect(number % (kWidth - 20), 60, 20, 20), cv::Scalar(40, 200, 30), cv::FILLED);
  return frame;
}

int numberOf(const ColourImage& image) {
  int number = 0;
  for (int bit = 0; bit < 8; ++bit) number |= (image.at(bit * 24 + 12, 24).g > 127) << bit;
  return number;
}

}  // namespace

class VideoTest : public testing::Test {
 protected:
  VideoTest() {
    std::string pattern = (fs::temp_directory_path() / "alidade-video-XXXXXX").string();
    m_folder = mkdtemp(pattern.data());
  }
  ~VideoTest() override { fs::remove_all(m_folder); }

  /// Empty where this machine's FFmpeg cannot write the coding.
  std::string video(const std::string& name, const char* fourcc, int frames = kFrames, double rate = 15) const {
    const std::string path = (m_folder / name).string();
    cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc(fourcc[0], fourcc[1], fourcc[2], fourcc[3]), rate,
                           cv::Size(kWidth, kHeight));
    if (!writer.isOpened()) return {};
    for (int i = 0; i < frames; ++i) writer.write(numbered(i));
    return path;
  }

  fs::path m_folder;
  VideoReader m_reader;
};

TEST_F(VideoTest, TellsSizeRateAndCount) {
  const std::string path = video("v.mp4", "mp4v");
  ASSERT_FALSE(path.empty());
  const auto info = m_reader.inspect(path);
  ASSERT_TRUE(info) << info.error().text();
  EXPECT_TRUE(info->isVideo);
  EXPECT_EQ(info->width, kWidth);
  EXPECT_EQ(info->height, kHeight);
  EXPECT_NEAR(info->framesPerSecond, 15, 1e-6);
  ASSERT_EQ(info->pictures.size(), std::size_t(kFrames));
  EXPECT_EQ(info->pictures[12].name, "frame 12");
  EXPECT_NEAR(info->pictures[30].timeSecs, 2.0, 1e-9);
}

TEST_F(VideoTest, TheSameNumberIsTheSameFrameInAnyOrder) {
  const std::pair<const char*, const char*> kinds[] = {{"a.mp4", "mp4v"}, {"b.avi", "MJPG"}, {"c.avi", "XVID"}, {"d.mkv", "mp4v"}, {"e.mp4", "avc1"}, {"f.webm", "VP80"}};
  int tested = 0;
  for (const auto& [name, fourcc] : kinds) {
    const std::string path = video(name, fourcc);
    if (path.empty()) continue;
    ++tested;
    auto source = m_reader.open(path);
    ASSERT_TRUE(source) << source.error().text();
    for (const int index : {0, 1, 2, 150, 151, 10, 199, 0, 77, 76, 140, 3, 198, 60, 199}) {
      const auto image = (*source)->picture(std::size_t(index));
      ASSERT_TRUE(image) << name << " " << image.error().text();
      EXPECT_EQ(numberOf(*image), index) << name;
    }
    EXPECT_FALSE((*source)->picture(kFrames));
    EXPECT_TRUE((*source)->picture(5)) << "the source lives on";
  }
  EXPECT_GE(tested, 3);
}

TEST_F(VideoTest, SeeksWhereItIsExact) {
  const std::string path = video("v.avi", "MJPG");
  ASSERT_FALSE(path.empty());
  auto decoder = VideoDecoder::open(path);
  ASSERT_TRUE(decoder);
  EXPECT_TRUE((*decoder)->seekIsExact());
}

TEST_F(VideoTest, RefusesBrokenVideos) {
  EXPECT_FALSE(m_reader.inspect((m_folder / "none.mp4").string()));
  const auto write = [&](const std::string& name, const std::string& bytes) {
    std::ofstream(m_folder / name, std::ios::binary) << bytes;
    return (m_folder / name).string();
  };
  EXPECT_THAT(m_reader.inspect(write("e.mp4", "")).error().what, testing::HasSubstr("empty"));
  EXPECT_THAT(m_reader.inspect(write("t.mp4", "words")).error().what, testing::HasSubstr("no video"));
  EXPECT_THAT(m_reader.inspect(write("list.mp4", "#EXTM3U\nfile:///etc/passwd\n")).error().what, testing::HasSubstr("no video"));
  EXPECT_FALSE(m_reader.inspect(write("h.mp4", std::string("\0\0\0\x18" "ftypisom\0\0\2\0", 16))));
  EXPECT_FALSE(m_reader.open(m_folder.string()));
}

TEST_F(VideoTest, ATruncatedVideoEndsWithAnError) {
  const std::string path = video("v.avi", "MJPG");
  ASSERT_FALSE(path.empty());
  fs::resize_file(path, fs::file_size(path) * 2 / 3);
  auto source = m_reader.open(path);
  if (!source) return;  // refusing it outright is as good
  const auto first = (*source)->picture(0);
  ASSERT_TRUE(first) << first.error().text();
  EXPECT_EQ(numberOf(*first), 0);
  const auto last = (*source)->picture(kFrames - 1);
  ASSERT_FALSE(last);
  EXPECT_FALSE(last.error().advice.empty());
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pictures/video_reader.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "base/input_file.h"
#include "pictures/mp4_times.h"
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

namespace {

std::string bytesOf(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool holds(const fs::path& path, const std::string& box) { return bytesOf(path).rfind(box) != std::string::npos; }

/// Of an MP4: the entries of its table of frames that need no other (stss).
std::size_t keyFrames(const fs::path& path) {
  const std::string bytes = bytesOf(path);
  const std::size_t at = bytes.rfind("stss") + 8;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 4; ++i) count = count << 8 | static_cast<unsigned char>(bytes[at + i]);
  return count;
}

}  // namespace

/// Long groups with B frames, as x264 makes them when left alone: what comes out after a seek must be the very bytes
/// that decoding from the start gives, and must not have cost decoding from the start.
TEST_F(VideoTest, AFrameSoughtIsTheFrameDecodedFromTheStart) {
  constexpr int kCount = 520, kGroup = 250;
  const std::string path = video("long.mp4", "avc1", kCount);
  if (path.empty()) GTEST_SKIP() << "this FFmpeg cannot write H.264";
  ASSERT_TRUE(holds(path, "ctts")) << "pictures out of order: B frames";
  ASSERT_LE(keyFrames(path), std::size_t(kCount / kGroup + 1));
  auto sequential = VideoDecoder::open(path), jumping = VideoDecoder::open(path);
  ASSERT_TRUE(sequential && jumping) << (sequential ? jumping : sequential).error().text();
  ASSERT_EQ((*sequential)->frameCount(), kCount);
  EXPECT_TRUE((*jumping)->timesRise());
  std::vector<ColourImage> frames;
  for (int i = 0; i < kCount; ++i) {
    auto frame = (*sequential)->frame(i);
    ASSERT_TRUE(frame) << frame.error().text();
    frames.push_back(std::move(*frame));
  }
  std::mt19937 random(1);
  std::vector<int> order;
  for (int i = 0; i < 60; ++i) order.push_back(static_cast<int>(random() % kCount));
  for (const int edge : {kGroup - 3, kGroup - 1, kGroup, kGroup + 1, 2 * kGroup - 2, 2 * kGroup, kCount - 1, 2 * kGroup - 1})
    order.push_back(edge);
  for (const int index : order) {
    const std::int64_t before = (*jumping)->walkedFrames();
    const auto frame = (*jumping)->frame(index);
    ASSERT_TRUE(frame) << frame.error().text();
    const ColourImage& truth = frames[static_cast<std::size_t>(index)];
    ASSERT_EQ(0, std::memcmp(frame->data(), truth.data(), truth.size() * sizeof(Rgba8))) << index;
    EXPECT_LE((*jumping)->walkedFrames() - before, 68) << index << ": a walk from the start is no seek";
  }
}

namespace {

std::string number32(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8), static_cast<char>(value)};
}

/// Gives an MP4 whose index stands at the end other frame durations: replaces stts, and mends the sizes of the boxes
/// around it. Durations in the track's units.
void setDurations(const fs::path& path, const std::vector<std::uint32_t>& durations) {
  std::string bytes = bytesOf(path);
  const std::size_t at = bytes.rfind("stts") - 4;
  const auto sizeAt = [&](std::size_t box) {
    std::uint32_t size = 0;
    for (int i = 0; i < 4; ++i) size = size << 8 | static_cast<unsigned char>(bytes[box + static_cast<std::size_t>(i)]);
    return size;
  };
  std::string table = number32(static_cast<std::uint32_t>(16 + 8 * durations.size())) + "stts" + number32(0) +
                      number32(static_cast<std::uint32_t>(durations.size()));
  for (const std::uint32_t duration : durations) table += number32(1) + number32(duration);
  const std::uint32_t old = sizeAt(at), grown = static_cast<std::uint32_t>(table.size()) - old;
  for (const char* box : {"moov", "trak", "mdia", "minf", "stbl"}) {
    const std::size_t start = bytes.rfind(box, at) - 4;
    bytes.replace(start, 4, number32(sizeAt(start) + grown));
  }
  bytes.replace(at, old, table);
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace

/// A phone's video: steps from 20 to 80 ms. The truth is the table that the test wrote.
TEST_F(VideoTest, AVaryingRateKeepsItsTimesAndItsFrames) {
  const std::string path = video("v.mp4", "mp4v", kFrames, 20);
  ASSERT_FALSE(path.empty());
  ASSERT_FALSE(holds(path, "ctts")) << "durations are in the order shown only without B frames";
  const auto plain = m_reader.inspect(path);
  ASSERT_TRUE(plain) << plain.error().text();
  const double unit = plain->pictures[1].timeSecs / 512;  // FFmpeg's muxer makes a frame of 20 Hz 512 units
  std::mt19937 random(2);
  std::vector<std::uint32_t> durations;
  std::vector<double> expected{0};
  for (int i = 0; i < kFrames; ++i) {
    durations.push_back(200 + random() % 620);
    expected.push_back(expected.back() + durations.back() * unit);
  }
  setDurations(path, durations);
  const auto info = m_reader.inspect(path);
  ASSERT_TRUE(info) << info.error().text();
  ASSERT_EQ(info->pictures.size(), std::size_t(kFrames));
  for (std::size_t i = 0; i < info->pictures.size(); ++i) EXPECT_NEAR(info->pictures[i].timeSecs, expected[i], 1e-6) << i;
  auto decoder = VideoDecoder::open(path);
  ASSERT_TRUE(decoder);
  std::int64_t cost = 0;
  for (const int index : {150, 40, 199, 75, 130, 42, 180, 60, 198}) {
    const auto image = (*decoder)->frame(index);
    ASSERT_TRUE(image) << image.error().text();
    EXPECT_EQ(numberOf(*image), index);
    cost += index;
  }
  EXPECT_LT((*decoder)->walkedFrames(), 2 * cost / 3) << "decoding from the start each time is no seeking";
}

TEST_F(VideoTest, AMatroskasTimesAreReadOffItsFrames) {
  const std::string path = video("v.mkv", "mp4v", 60, 25);
  ASSERT_FALSE(path.empty());
  const auto info = m_reader.inspect(path);
  ASSERT_TRUE(info) << info.error().text();
  ASSERT_EQ(info->pictures.size(), 60u);
  for (std::size_t i = 0; i < 60; ++i) EXPECT_NEAR(info->pictures[i].timeSecs, static_cast<double>(i) / 25, 1e-3);
}

/// Every byte of the index in turn: an error or a video, never a crash or a hang; and counts that cannot be.
TEST_F(VideoTest, ADamagedIndexIsRefusedOrRead) {
  const fs::path path = video("v.mp4", "mp4v", 20);
  ASSERT_FALSE(path.empty());
  const std::string whole = bytesOf(path);
  const std::size_t moov = whole.rfind("moov");
  ASSERT_NE(moov, std::string::npos);
  const std::string broken = (m_folder / "b.mp4").string();
  for (std::size_t i = moov; i < whole.size(); ++i) {
    std::string bytes = whole;
    bytes[i] = static_cast<char>(i % 3 == 0 ? 0xff : i % 3 == 1 ? 0 : bytes[i] ^ 0x55);
    std::ofstream(broken, std::ios::binary) << bytes;
    const auto file = InputFile::open(broken);
    const auto times = mp4FrameTimes(*file);
    if (!times) { EXPECT_FALSE(times.error().advice.empty()); }
    else if (*times) { EXPECT_LE((*times)->size(), whole.size()); }
  }
  std::string many = whole;
  many.replace(many.rfind("stts") + 8, 8, std::string("\0\0\0\1\xff\xff\xff\xff", 8)).resize(whole.size());
  std::ofstream(broken, std::ios::binary) << many;
  EXPECT_THAT(m_reader.inspect(broken).error().text(), testing::HasSubstr("more frames than the file can hold"));
  std::string none = whole;
  none.replace(none.rfind("stsz") + 12, 4, std::string("\0\0\0\0", 4));
  std::ofstream(broken, std::ios::binary) << none;
  EXPECT_FALSE(m_reader.inspect(broken));
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

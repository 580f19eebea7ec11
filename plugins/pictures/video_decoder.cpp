// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pictures/video_decoder.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "plugin_api/picture_header.h"

namespace alidade {

namespace {

constexpr std::int64_t kWalkFrames = 48;       // a jump no longer than this is decoded through
constexpr std::int64_t kComparedFrames = 40;   // first frames that seeks are compared on
constexpr std::int64_t kMaxFrames = std::int64_t(1) << 31;
constexpr std::int64_t kMaxFramePixels = std::int64_t(1) << 27;

/// FNV-1a over 64-bit words; enough to tell neighbouring frames apart.
std::uint64_t checksum(const cv::Mat& frame) {
  std::uint64_t hash = 14695981039346656037ull;
  for (int y = 0; y < frame.rows; ++y) {
    const unsigned char* row = frame.ptr(y);
    const std::size_t bytes = static_cast<std::size_t>(frame.cols) * frame.elemSize();
    for (std::size_t i = 0; i + 8 <= bytes; i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, row + i, 8);
      hash = (hash ^ word) * 1099511628211ull;
    }
  }
  return hash;
}

}  // namespace

VideoDecoder::VideoDecoder(std::string path) : m_path(std::move(path)) {}
VideoDecoder::~VideoDecoder() = default;

Error VideoDecoder::decodeError(std::int64_t index, const std::string& why) const {
  return {why, m_path + ", frame " + std::to_string(index), "The video is cut off or damaged: copy it again"};
}

bool VideoDecoder::reopen() {
  auto capture = std::make_unique<cv::VideoCapture>();
  // Never another backend: they would take the name for a pattern, a camera or an address.
  const std::string absolute = std::filesystem::absolute(m_path).string();
  if (!capture->open(absolute, cv::CAP_FFMPEG)) return false;
  capture->set(cv::CAP_PROP_ORIENTATION_AUTO, 0);  // calibrations refer to the sensor's own rows
  m_capture = std::move(capture);
  m_next = 0;
  return true;
}

Result<std::unique_ptr<VideoDecoder>> VideoDecoder::open(const std::string& path) {
  try {
    std::unique_ptr<VideoDecoder> video(new VideoDecoder(path));
    const std::string advice = "Copy the file again, or convert it to MP4 with H.264";
    if (!video->reopen()) return fail("The video cannot be opened: it is cut off, damaged or of an unknown coding", path, advice);
    video->m_width = static_cast<int>(video->m_capture->get(cv::CAP_PROP_FRAME_WIDTH));
    video->m_height = static_cast<int>(video->m_capture->get(cv::CAP_PROP_FRAME_HEIGHT));
    if (video->m_width < 1 || video->m_height < 1 || std::int64_t(video->m_width) * video->m_height > kMaxFramePixels)
      return fail("The video says that its frames are " + std::to_string(video->m_width) + " × " +
                      std::to_string(video->m_height) + " pixels", path, advice);
    const double rate = video->m_capture->get(cv::CAP_PROP_FPS);
    video->m_framesPerSecond = std::isfinite(rate) && rate > 0 && rate <= 10000 ? rate : 0;
    const double count = video->m_capture->get(cv::CAP_PROP_FRAME_COUNT);
    const bool sensible = std::isfinite(count) && count >= 1 && count < double(kMaxFrames);
    // No coding keeps a frame in less than a byte.
    const auto bytes = std::filesystem::file_size(path);
    if (sensible && count <= double(bytes)) video->m_frameCount = static_cast<std::int64_t>(count);
    else if (!video->countFrames()) return fail("The video holds no frame that can be decoded", path, advice);
    return video;
  } catch (const std::exception& error) {
    return fail(std::string("The video cannot be opened: ") + error.what(), path, "Convert it to MP4 with H.264");
  }
}

bool VideoDecoder::countFrames() {
  while (m_frameCount < kMaxFrames && m_capture->grab()) ++m_frameCount;
  return m_frameCount > 0 && reopen();
}

bool VideoDecoder::grabUpTo(std::int64_t index) {
  if (m_next > index && !reopen()) return false;
  while (m_next <= index) {
    if (!m_capture->grab()) return false;
    ++m_next;
  }
  return true;
}

bool VideoDecoder::seekTo(std::int64_t index) {
  if (!m_capture->set(cv::CAP_PROP_POS_FRAMES, static_cast<double>(index))) return false;
  if (std::llround(m_capture->get(cv::CAP_PROP_POS_FRAMES)) != index || !m_capture->grab()) return false;
  m_next = index + 1;
  return true;
}

std::uint64_t VideoDecoder::checksumOfGrabbed() {
  cv::Mat frame;
  return m_capture->retrieve(frame) ? checksum(frame) : 0;
}

bool VideoDecoder::compareSeeks() {
  const std::int64_t count = std::min(kComparedFrames, m_frameCount);
  if (!reopen()) return false;
  std::vector<std::uint64_t> decoded;
  std::vector<double> times;
  while (static_cast<std::int64_t>(decoded.size()) < count && m_capture->grab()) {
    decoded.push_back(checksumOfGrabbed());
    times.push_back(m_capture->get(cv::CAP_PROP_POS_MSEC));
  }
  // Backwards, so that every one of them is a real seek.
  const auto last = static_cast<std::int64_t>(decoded.size()) - 1;
  for (std::int64_t index = last; index >= 0; index -= std::max<std::int64_t>(1, last / 5)) {
    const auto at = static_cast<std::size_t>(index);
    if (!seekTo(index) || checksumOfGrabbed() != decoded[at]) return false;
    if (std::abs(m_capture->get(cv::CAP_PROP_POS_MSEC) - times[at]) > 0.5) return false;
  }
  // A changing frame rate breaks FFmpeg's count later on: the far end must lie on the same raster.
  if (m_frameCount > count && last > 0 && m_framesPerSecond > 0) {
    if (!seekTo(m_frameCount - 1 - m_frameCount / 50)) return false;
    const double expected = times.front() + 1000.0 * double(m_next - 1) / m_framesPerSecond;
    if (std::abs(m_capture->get(cv::CAP_PROP_POS_MSEC) - expected) > 500.0 / m_framesPerSecond) return false;
    for (std::size_t i = 1; i < times.size(); ++i)
      if (std::abs(times[i] - times.front() - 1000.0 * double(i) / m_framesPerSecond) > 500.0 / m_framesPerSecond) return false;
  }
  return last >= 0;
}

bool VideoDecoder::seekIsExact() {
  if (!m_seekIsExact) {
    try {
      m_seekIsExact = compareSeeks();
      if (!reopen()) m_seekIsExact = false;
    } catch (const std::exception&) {
      m_seekIsExact = false;
    }
  }
  return *m_seekIsExact;
}

Result<ColourImage> VideoDecoder::retrieveFrame(std::int64_t index) {
  cv::Mat frame;
  if (!m_capture->retrieve(frame) || frame.empty()) return fail(decodeError(index, "The frame cannot be decoded"));
  if (frame.depth() != CV_8U || frame.cols != m_width || frame.rows != m_height)
    return fail(decodeError(index, "The frame differs in size or kind from the first one"));
  return colourImageFrom({frame.data, frame.step[0], frame.cols, frame.rows, frame.channels(), 1});
}

Result<ColourImage> VideoDecoder::frame(std::int64_t index) {
  if (index < 0 || index >= m_frameCount)
    return fail("The video has no frame " + std::to_string(index), m_path,
                "It has frames 0 to " + std::to_string(m_frameCount - 1));
  try {
    const bool near = index >= m_next && index - m_next <= kWalkFrames;
    const bool nearStart = index < m_next && index <= kWalkFrames;
    bool there = false;
    if (!near && !nearStart && seekIsExact()) there = seekTo(index);
    if (!there) {
      // A failed seek leaves the stream anywhere.
      if (!near && !reopen()) return fail(decodeError(index, "The video cannot be opened again"));
      there = grabUpTo(index);
    }
    if (!there) {
      const std::int64_t reached = m_next;
      reopen();
      return fail(decodeError(index, "The video ends after " + std::to_string(reached) + " frames, its header promises " +
                                         std::to_string(m_frameCount)));
    }
    return retrieveFrame(index);
  } catch (const std::exception& error) {
    return fail(decodeError(index, std::string("The frame cannot be decoded: ") + error.what()));
  }
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pictures/video_decoder.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "base/input_file.h"
#include "pictures/mp4_times.h"
#include "plugin_api/picture_header.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr std::int64_t kWalkFrames = 24;  // a jump no longer than this is decoded through
/// At the end of the file the decoder hands over what it still holds, and the stamps that the capture gives to those
/// frames are not theirs: so many are known by counting alone.
constexpr std::int64_t kTailFrames = 40;
constexpr std::int64_t kMaxFrames = std::int64_t(1) << 26;
constexpr std::int64_t kMaxFramePixels = std::int64_t(1) << 27;

/// Times read off by decoding a whole video, kept for the next time that it is opened: by path, size and date.
class MeasuredTimes {
 public:
  static MeasuredTimes& instance() {
    static MeasuredTimes all;
    return all;
  }
  std::optional<std::vector<double>> find(const std::string& path) {
    const std::lock_guard lock(m_mutex);
    const auto it = m_times.find(keyOf(path));
    return it == m_times.end() ? std::nullopt : std::optional(it->second);
  }
  void keep(const std::string& path, const std::vector<double>& times) {
    const std::lock_guard lock(m_mutex);
    if (m_times.size() >= 16) m_times.clear();
    m_times[keyOf(path)] = times;
  }

 private:
  using Key = std::tuple<std::string, std::uintmax_t, std::filesystem::file_time_type>;
  static Key keyOf(const std::string& path) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    return {path, size, std::filesystem::last_write_time(path, error)};
  }
  std::mutex m_mutex;
  std::map<Key, std::vector<double>> m_times;
};

bool isMp4(const std::string& path) {
  const std::string extension = lowerCase(std::filesystem::path(path).extension().string());
  return extension == ".mp4" || extension == ".m4v" || extension == ".mov";
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

bool VideoDecoder::grab() {
  if (!m_capture->grab()) return false;
  ++m_walked;
  return true;
}

double VideoDecoder::stampSecs() const { return m_capture->get(cv::CAP_PROP_POS_MSEC) / 1000.0; }

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
    if (!video->grab()) return fail("The video holds no frame that can be decoded", path, advice);
    video->m_next = 1;
    video->m_firstStamp = video->stampSecs();
    if (auto found = video->findTimes(); !found) return fail(found.error());
    return video;
  } catch (const std::exception& error) {
    return fail(std::string("The video cannot be opened: ") + error.what(), path, "Convert it to MP4 with H.264");
  }
}

/// The container's index where it tells, the constant rate of AVI, else all frames are decoded once.
Result<void> VideoDecoder::findTimes() {
  if (isMp4(m_path)) {
    const auto file = InputFile::open(m_path);
    if (!file) return fail(file.error());
    auto times = mp4FrameTimes(*file);
    if (!times) return fail(times.error());
    if (*times && !(*times)->empty()) {
      setTimes(std::move(**times));
      return {};
    }
  } else if (lowerCase(std::filesystem::path(m_path).extension().string()) == ".avi" && m_framesPerSecond > 0) {
    const double count = m_capture->get(cv::CAP_PROP_FRAME_COUNT);
    // No coding keeps a frame in less than a byte.
    const double bytes = static_cast<double>(std::filesystem::file_size(m_path));
    if (std::isfinite(count) && count >= 1 && count < double(kMaxFrames) && count <= bytes) {
      std::vector<double> times(static_cast<std::size_t>(count));
      for (std::size_t i = 0; i < times.size(); ++i) times[i] = static_cast<double>(i) / m_framesPerSecond;
      setTimes(std::move(times));
      return {};
    }
  }
  return scanTimes();
}

Result<void> VideoDecoder::scanTimes() {
  m_timesMeasured = true;
  if (auto known = MeasuredTimes::instance().find(m_path)) {
    setTimes(std::move(*known));
    return {};
  }
  if (!reopen()) return fail(decodeError(0, "The video cannot be opened again"));
  std::vector<double> times;
  while (static_cast<std::int64_t>(times.size()) < kMaxFrames && grab()) times.push_back(stampSecs() - m_firstStamp);
  if (times.empty()) return fail(decodeError(0, "The video holds no frame that can be decoded"));
  const double step = m_framesPerSecond > 0 ? 1 / m_framesPerSecond : 1e-3;
  for (auto i = std::max<std::int64_t>(1, static_cast<std::int64_t>(times.size()) - kTailFrames); i < static_cast<std::int64_t>(times.size()); ++i)
    if (auto& time = times[static_cast<std::size_t>(i)]; !(time > times[static_cast<std::size_t>(i - 1)]))
      time = times[static_cast<std::size_t>(i - 1)] + step;
  MeasuredTimes::instance().keep(m_path, times);
  setTimes(std::move(times));
  if (!reopen()) return fail(decodeError(0, "The video cannot be opened again"));
  return {};
}

void VideoDecoder::setTimes(std::vector<double> times) {
  m_times = std::move(times);
  m_timesRise = true;
  for (std::size_t i = 1; i < m_times.size(); ++i)
    if (!(m_times[i] > m_times[i - 1] + 1e-6)) m_timesRise = false;
  if (m_framesPerSecond == 0 && m_times.size() > 1 && m_times.back() > 0)
    m_framesPerSecond = static_cast<double>(m_times.size() - 1) / m_times.back();
}

/// The frame of that time; -1 where no frame has it.
std::int64_t VideoDecoder::indexOfStamp(double secs) const {
  const auto after = std::lower_bound(m_times.begin(), m_times.end(), secs);
  std::int64_t nearest = -1;
  double distance = 2e-3;  // stamps are rounded to a container's unit, a millisecond at worst
  for (auto it = after == m_times.begin() ? after : after - 1; it != m_times.end() && it <= after; ++it)
    if (std::abs(*it - secs) < distance) distance = std::abs(*it - secs), nearest = it - m_times.begin();
  return nearest;
}

bool VideoDecoder::walkTo(std::int64_t index) {
  if (m_next > index && !reopen()) return false;
  while (m_next <= index) {
    if (!grab()) return false;
    ++m_next;
  }
  return true;
}

/// Leaves the stream at a frame no later than `index`, known by its stamp; false where no seek gets there.
bool VideoDecoder::seekBefore(std::int64_t index) {
  if (!m_timesRise || m_framesPerSecond <= 0) return false;
  // A capture that came to the end of the file stays there.
  if (m_next >= frameCount() && !reopen()) return false;
  // The capture counts frames at the mean rate, which only leads near the place where the rate varies.
  const std::int64_t known = std::min(index, frameCount() - kTailFrames);
  if (known < 1) return false;
  const double counted = m_times[static_cast<std::size_t>(known)] * m_framesPerSecond;
  for (double back = 2; back < counted; back *= 4) {
    if (!m_capture->set(cv::CAP_PROP_POS_FRAMES, std::floor(counted - back)) || !grab()) return false;
    const std::int64_t there = indexOfStamp(stampSecs() - m_firstStamp);
    if (there < 0) return false;
    if (there > known) continue;
    m_next = there + 1;
    return true;
  }
  return false;
}

Result<ColourImage> VideoDecoder::retrieveFrame(std::int64_t index) {
  cv::Mat frame;
  if (!m_capture->retrieve(frame) || frame.empty()) return fail(decodeError(index, "The frame cannot be decoded"));
  if (frame.depth() != CV_8U || frame.cols != m_width || frame.rows != m_height)
    return fail(decodeError(index, "The frame differs in size or kind from the first one"));
  if (frame.channels() != 3)
    return colourImageFrom({frame.data, frame.step[0], frame.cols, frame.rows, frame.channels(), 1});
  ColourImage image(m_width, m_height, Uncleared{});
  cv::Mat into(m_height, m_width, CV_8UC4, image.data());
  cv::cvtColor(frame, into, cv::COLOR_BGR2RGBA);
  return image;
}

Result<ColourImage> VideoDecoder::frame(std::int64_t index) {
  if (index < 0 || index >= frameCount())
    return fail("The video has no frame " + std::to_string(index), m_path,
                "It has frames 0 to " + std::to_string(frameCount() - 1));
  try {
    // One back is the frame that was grabbed last.
    const bool near = index >= m_next - 1 && index - m_next <= kWalkFrames;
    if (!near && !(index > kWalkFrames && seekBefore(index)) && !reopen())
      return fail(decodeError(index, "The video cannot be opened again"));
    if (m_next != index + 1 && !walkTo(index)) {
      const std::int64_t reached = m_next;
      reopen();
      return fail(decodeError(index, "The video ends after " + std::to_string(reached) + " frames, its header promises " +
                                         std::to_string(frameCount())));
    }
    if (m_timesRise && index < frameCount() - kTailFrames && indexOfStamp(stampSecs() - m_firstStamp) != index) {
      // The container's index was not what the decoder shows: measured once, it is.
      if (m_timesMeasured) return fail(decodeError(index, "The video's time stamps change from one reading to the next"));
      if (auto scanned = scanTimes(); !scanned) return fail(scanned.error());
      return this->frame(index);
    }
    return retrieveFrame(index);
  } catch (const std::exception& error) {
    return fail(decodeError(index, std::string("The frame cannot be decoded: ") + error.what()));
  }
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/image.h"

namespace cv {
class VideoCapture;
}

namespace alidade {

/// Frames of one video by number, in the order in which they are shown. What a decoder hands over is known by its
/// time stamp, which is looked up among those of all frames: so a seek, which a container may answer with any frame,
/// is walked on from to the very one. Videos whose stamps do not tell frames apart (double or falling ones) are decoded
/// from the start at every jump back.
///
/// Not thread-safe. No exception of OpenCV leaves it.
class VideoDecoder {
 public:
  static Result<std::unique_ptr<VideoDecoder>> open(const std::string& path);
  ~VideoDecoder();

  int width() const { return m_width; }
  int height() const { return m_height; }
  /// As the container says, else from the time stamps; 0 where neither tells.
  double framesPerSecond() const { return m_framesPerSecond; }
  std::int64_t frameCount() const { return static_cast<std::int64_t>(m_times.size()); }
  /// Seconds from the first frame: from the container's index, or read off the decoded frames.
  const std::vector<double>& times() const { return m_times; }
  /// True where the stamps rise from frame to frame, so that jumps may seek.
  bool timesRise() const { return m_timesRise; }

  Result<ColourImage> frame(std::int64_t index);

  /// Frames walked over so far one by one, shown or not; a seek within the capture counts as none.
  std::int64_t walkedFrames() const { return m_walked; }

 private:
  explicit VideoDecoder(std::string path);

  bool reopen();
  bool grab();
  double stampSecs() const;
  Result<void> findTimes();
  Result<void> scanTimes();
  void setTimes(std::vector<double> times);
  bool walkTo(std::int64_t index);
  bool seekBefore(std::int64_t index);
  std::int64_t indexOfStamp(double secs) const;
  Result<ColourImage> retrieveFrame(std::int64_t index);
  Error decodeError(std::int64_t index, const std::string& why) const;

  std::string m_path;
  std::unique_ptr<cv::VideoCapture> m_capture;
  int m_width = 0, m_height = 0;
  double m_framesPerSecond = 0, m_firstStamp = 0;
  std::vector<double> m_times;
  bool m_timesRise = false, m_timesMeasured = false;
  std::int64_t m_next = 0;  // the frame that the next grab gives
  std::int64_t m_walked = 0;
};

}  // namespace alidade

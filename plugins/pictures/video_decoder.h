// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/error.h"
#include "base/image.h"

namespace cv {
class VideoCapture;
}

namespace alidade {

/// Frames of one video by number. Going on by a few frames decodes them; a jump seeks where the
/// container's seek proved exact, else starts again from the first frame.
///
/// Not thread-safe. No exception of OpenCV leaves it.
class VideoDecoder {
 public:
  static Result<std::unique_ptr<VideoDecoder>> open(const std::string& path);
  ~VideoDecoder();

  int width() const { return m_width; }
  int height() const { return m_height; }
  double framesPerSecond() const { return m_framesPerSecond; }
  /// As the container says; counted by decoding where it says nothing sensible.
  std::int64_t frameCount() const { return m_frameCount; }

  Result<ColourImage> frame(std::int64_t index);

  /// Whether jumps may seek: compares seeks into the first frames with decoding up to there. Done by
  /// itself at the first jump.
  bool seekIsExact();

 private:
  explicit VideoDecoder(std::string path);

  bool reopen();
  bool countFrames();
  bool grabUpTo(std::int64_t index);
  bool seekTo(std::int64_t index);
  std::uint64_t checksumOfGrabbed();
  bool compareSeeks();
  Result<ColourImage> retrieveFrame(std::int64_t index);
  Error decodeError(std::int64_t index, const std::string& why) const;

  std::string m_path;
  std::unique_ptr<cv::VideoCapture> m_capture;
  int m_width = 0, m_height = 0;
  double m_framesPerSecond = 0;
  std::int64_t m_frameCount = 0;
  std::int64_t m_next = 0;  // the frame that the next grab gives
  std::optional<bool> m_seekIsExact;
};

}  // namespace alidade

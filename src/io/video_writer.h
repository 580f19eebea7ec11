// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <string>

#include "base/error.h"
#include "base/image.h"

namespace alidade {

/// Writes an MP4 with H.264, or MPEG-4 where this machine's FFmpeg has no encoder for it. Not atomic: a file that was not
/// finished is removed.
class VideoWriter {
 public:
  /// `framesPerSecond` in (0, 1000]; even width and height, as the coding wants them.
  static Result<VideoWriter> create(const std::string& path, int width, int height, double framesPerSecond);
  VideoWriter(VideoWriter&& other) noexcept;
  ~VideoWriter();

  /// Of the size given to create().
  Result<void> write(const ColourImage& frame);
  /// Closes the file. Without it the file is removed.
  Result<void> finish();

 private:
  struct Impl;
  explicit VideoWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> m_impl;
};

}  // namespace alidade

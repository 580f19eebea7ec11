// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// A video file (MP4, MOV, AVI, Matroska, WebM, MPEG) through OpenCV's FFmpeg. Frames are numbered
/// from 0 in the order they are shown; the same number always gives the same frame, whatever was read
/// before; see video_decoder.h. Times are the container's time stamps, from the first frame.
class VideoReader : public PictureReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<PictureSetInfo> inspect(const std::string& path) const override;
  Result<std::unique_ptr<PictureSource>> open(const std::string& path) const override;
};

}  // namespace alidade

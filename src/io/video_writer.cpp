// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/video_writer.h"

#include <exception>
#include <filesystem>

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

namespace alidade {

struct VideoWriter::Impl {
  std::string path;
  int width = 0, height = 0;
  cv::VideoWriter writer;
  std::int64_t frames = 0;
  bool finished = false;

  ~Impl() {
    if (finished) return;
    writer.release();
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

VideoWriter::VideoWriter(std::unique_ptr<Impl> impl) : m_impl(std::move(impl)) {}
VideoWriter::VideoWriter(VideoWriter&& other) noexcept = default;
VideoWriter::~VideoWriter() = default;

Result<VideoWriter> VideoWriter::create(const std::string& path, int width, int height, double framesPerSecond) {
  if (width < 2 || height < 2 || width % 2 != 0 || height % 2 != 0 || width > 16384 || height > 16384)
    return fail("A video cannot have frames of " + std::to_string(width) + " × " + std::to_string(height) + " pixels", path,
                "Give an even width and height of up to 16384");
  if (!(framesPerSecond > 0 && framesPerSecond <= 1000)) return fail("A video needs a frame rate", path, "Give up to 1000 frames a second");
  auto impl = std::make_unique<Impl>();
  impl->path = std::filesystem::absolute(path).string();
  impl->width = width;
  impl->height = height;
  try {
    for (const char* coding : {"avc1", "mp4v"})
      if (impl->writer.open(impl->path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc(coding[0], coding[1], coding[2], coding[3]), framesPerSecond,
                            cv::Size(width, height)))
        return VideoWriter(std::move(impl));
  } catch (const std::exception& error) {
    return fail(std::string("The video cannot be written: ") + error.what(), path, "Choose another folder");
  }
  return fail("The video cannot be written", path, "Give a name that ends in .mp4, in a folder that can be written to");
}

Result<void> VideoWriter::write(const ColourImage& frame) {
  if (frame.width() != m_impl->width || frame.height() != m_impl->height)
    return fail("The frame is not of the video's size", m_impl->path, "Draw all frames of one size");
  try {
    const cv::Mat pixels(frame.height(), frame.width(), CV_8UC4, const_cast<Rgba8*>(frame.data()));
    cv::Mat blueFirst;
    cv::cvtColor(pixels, blueFirst, cv::COLOR_RGBA2BGR);
    m_impl->writer.write(blueFirst);
    ++m_impl->frames;
  } catch (const std::exception& error) {
    return fail(std::string("The frame cannot be written: ") + error.what(), m_impl->path, "Check the free space");
  }
  return {};
}

Result<void> VideoWriter::finish() {
  m_impl->writer.release();
  std::error_code error;
  if (m_impl->frames == 0) return fail("A video without frames is none", m_impl->path, "Choose frames that can be drawn");
  const auto size = std::filesystem::file_size(m_impl->path, error);
  if (error || size == 0) return fail("The video was not written", m_impl->path, "Check the free space");
  m_impl->finished = true;
  return {};
}

}  // namespace alidade

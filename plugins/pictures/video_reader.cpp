// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pictures/video_reader.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include "pictures/video_decoder.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace {

/// Container by its first bytes; 0 where it is none. FFmpeg would also open play lists, which lead
/// to other files: nothing without a signature is offered to it.
int containerScore(std::string_view head, std::string_view extension) {
  const auto at = [&](std::size_t offset, std::string_view text) {
    return head.size() >= offset + text.size() && head.substr(offset, text.size()) == text;
  };
  if (at(4, "ftyp") || at(0, "\x1a\x45\xdf\xa3") || (at(0, "RIFF") && at(8, "AVI "))) return 80;
  if (at(4, "moov") || at(4, "mdat") || at(4, "wide")) return 60;  // QuickTime before ftyp
  if (at(0, std::string_view("\0\0\x01\xba", 4))) return 60;       // MPEG programme stream
  const bool transport = extension == "ts" || extension == "mts" || extension == "m2ts";
  return transport && (at(0, "G") || at(4, "G")) ? 50 : 0;
}

Result<void> checkContainer(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return fail("The video does not exist or is no ordinary file", path, "Check the path");
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) return fail("The video cannot be opened", path, "Check its permissions");
  std::array<char, 64> head{};
  const std::size_t count = std::fread(head.data(), 1, head.size(), file);
  std::fclose(file);
  if (count == 0) return fail("The video file is empty", path, "Copy it again");
  std::string extension = lowerCase(std::filesystem::path(path).extension().string());
  if (extension.starts_with('.')) extension.erase(0, 1);
  if (containerScore({head.data(), count}, extension) == 0)
    return fail("The file is no video that can be read", path, "Convert it to MP4 with H.264");
  return {};
}

class VideoFrames : public PictureSource {
 public:
  explicit VideoFrames(std::unique_ptr<VideoDecoder> decoder) : m_decoder(std::move(decoder)) {}
  Result<ColourImage> picture(std::size_t index) override { return m_decoder->frame(static_cast<std::int64_t>(index)); }

 private:
  std::unique_ptr<VideoDecoder> m_decoder;
};

Result<std::unique_ptr<VideoDecoder>> openChecked(const std::string& path) {
  if (auto checked = checkContainer(path); !checked) return fail(checked.error());
  return VideoDecoder::open(path);
}

}  // namespace

ReaderDescription VideoReader::description() const {
  return {"video", "Video", {"mp4", "m4v", "mov", "avi", "mkv", "webm", "mpg", "mpeg", "ts", "mts", "m2ts"}};
}

int VideoReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  return containerScore({reinterpret_cast<const char*>(probe.head.data()), probe.head.size()}, probe.extension);
}

Result<PictureSetInfo> VideoReader::inspect(const std::string& path) const {
  const auto decoder = openChecked(path);
  if (!decoder) return fail(decoder.error());
  PictureSetInfo info;
  info.isVideo = true;
  info.width = (*decoder)->width();
  info.height = (*decoder)->height();
  info.framesPerSecond = (*decoder)->framesPerSecond();
  const std::int64_t count = (*decoder)->frameCount();
  info.pictures.reserve(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i)
    info.pictures.push_back({"frame " + std::to_string(i), path, (*decoder)->times()[static_cast<std::size_t>(i)]});
  char rate[32];
  std::snprintf(rate, sizeof rate, "%.4g", info.framesPerSecond);
  const std::string stamps = (*decoder)->timesRise() ? "" : "; its time stamps do not rise from frame to frame";
  info.details = "Video, " + std::to_string(info.width) + " × " + std::to_string(info.height) + ", " +
                 std::to_string(count) + " frames" + (info.framesPerSecond > 0 ? ", " + std::string(rate) + " a second" : "") + stamps;
  return info;
}

Result<std::unique_ptr<PictureSource>> VideoReader::open(const std::string& path) const {
  auto decoder = openChecked(path);
  if (!decoder) return fail(decoder.error());
  return std::make_unique<VideoFrames>(std::move(*decoder));
}

}  // namespace alidade

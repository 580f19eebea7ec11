// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pictures/picture_folder_reader.h"

#include <algorithm>
#include <exception>
#include <filesystem>

#include <opencv2/imgcodecs.hpp>

#include "plugin_api/picture_header.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

bool isDigit(char c) { return c >= '0' && c <= '9'; }

std::string extensionOf(const fs::path& path) {
  std::string extension = lowerCase(path.extension().string());
  if (extension.starts_with('.')) extension.erase(0, 1);
  return extension;
}

bool isPictureName(const fs::path& path) {
  return isPictureExtension(extensionOf(path)) && !path.filename().string().starts_with('.');
}

Result<std::vector<PictureInfo>> picturesOf(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return fail("The folder or picture does not exist", path, "Check the path");
  if (!fs::is_directory(path, error)) return std::vector<PictureInfo>{{fs::path(path).filename().string(), path, 0}};
  std::vector<PictureInfo> pictures;
  fs::directory_iterator it(path, error);
  for (; !error && it != fs::directory_iterator(); it.increment(error)) {
    std::error_code unknown;
    if (isPictureName(it->path()) && it->is_regular_file(unknown))
      pictures.push_back({it->path().filename().string(), it->path().string(), 0});
  }
  if (error) return fail("The folder cannot be read: " + error.message(), path, "Check its permissions");
  if (pictures.empty())
    return fail("The folder holds no pictures", path, "Choose the folder with the PNG, JPEG, TIFF, BMP or WebP files themselves");
  std::sort(pictures.begin(), pictures.end(),
            [](const PictureInfo& a, const PictureInfo& b) { return naturallyLess(a.name, b.name); });
  return pictures;
}

class PictureFiles : public PictureSource {
 public:
  explicit PictureFiles(std::vector<PictureInfo> pictures) : m_pictures(std::move(pictures)) {}

  Result<ColourImage> picture(std::size_t index) override {
    if (index >= m_pictures.size())
      return fail("There is no picture " + std::to_string(index), {},
                  "The set has pictures 0 to " + std::to_string(m_pictures.size() - 1));
    const std::string& path = m_pictures[index].path;
    const auto header = readPictureHeader(path);
    if (!header) return fail(header.error());
    if (auto complete = checkPictureComplete(path, *header); !complete) return fail(complete.error());
    try {
      // UNCHANGED keeps 16 bits and leaves the EXIF orientation alone.
      const cv::Mat decoded = cv::imread(path, cv::IMREAD_UNCHANGED);
      if (decoded.empty() || (decoded.depth() != CV_8U && decoded.depth() != CV_16U))
        return fail("The picture cannot be decoded: it is cut off, damaged or of an unknown kind", path,
                    "Copy the file again or save it anew with 8 or 16 bits a channel");
      return colourImageFrom({decoded.data, decoded.step[0], decoded.cols, decoded.rows, decoded.channels(),
                              decoded.depth() == CV_16U ? 2 : 1});
    } catch (const std::exception& error) {
      return fail(std::string("The picture cannot be decoded: ") + error.what(), path, "Copy the file again");
    }
  }

 private:
  std::vector<PictureInfo> m_pictures;
};

}  // namespace

bool naturallyLess(std::string_view a, std::string_view b) {
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    if (isDigit(a[i]) && isDigit(b[k])) {
      const auto endOfRun = [](std::string_view text, std::size_t at) {
        while (at < text.size() && isDigit(text[at])) ++at;
        return at;
      };
      const std::size_t endA = endOfRun(a, i), endB = endOfRun(b, k);
      while (i < endA && a[i] == '0') ++i;
      while (k < endB && b[k] == '0') ++k;
      if (endA - i != endB - k) return endA - i < endB - k;
      if (const int order = a.substr(i, endA - i).compare(b.substr(k, endB - k)); order != 0) return order < 0;
      i = endA;
      k = endB;
      continue;
    }
    const std::string left = lowerCase(a.substr(i, 1)), right = lowerCase(b.substr(k, 1));
    if (left != right) return left < right;
    ++i;
    ++k;
  }
  if ((i < a.size()) != (k < b.size())) return k < b.size();
  return a < b;
}

ReaderDescription PictureFolderReader::description() const {
  return {"pictures", "Pictures", {"png", "jpg", "jpeg", "tif", "tiff", "bmp", "webp"}};
}

int PictureFolderReader::sniff(const FileProbe& probe) const {
  if (!probe.isFolder) {
    const PictureFormat format = pictureFormatOf(probe.head);
    // Two letters are a weak signature.
    if (format == PictureFormat::Bmp) return probe.extension == "bmp" ? 60 : 10;
    return format != PictureFormat::None ? 80 : isPictureExtension(probe.extension) ? 20 : 0;
  }
  std::error_code error;
  for (fs::directory_iterator it(probe.path, error); !error && it != fs::directory_iterator(); it.increment(error))
    if (isPictureName(it->path())) return 50;
  return 0;
}

Result<PictureSetInfo> PictureFolderReader::inspect(const std::string& path) const {
  auto pictures = picturesOf(path);
  if (!pictures) return fail(pictures.error());
  const auto header = readPictureHeader(pictures->front().path);
  if (!header) return fail(header.error());
  PictureSetInfo info;
  info.width = header->width;
  info.height = header->height;
  info.pictures = std::move(*pictures);
  info.details = std::to_string(info.pictures.size()) + (info.pictures.size() == 1 ? " picture, " : " pictures, the first ") +
                 std::string(pictureFormatName(header->format)) + ", " + std::to_string(info.width) + " × " +
                 std::to_string(info.height);
  return info;
}

Result<std::unique_ptr<PictureSource>> PictureFolderReader::open(const std::string& path) const {
  auto pictures = picturesOf(path);
  if (!pictures) return fail(pictures.error());
  return std::make_unique<PictureFiles>(std::move(*pictures));
}

}  // namespace alidade

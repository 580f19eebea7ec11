// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/e57_image_readers.h"

#include <algorithm>
#include <cstring>
#include <exception>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "e57/e57_document.h"
#include "plugin_api/picture_header.h"

namespace alidade {

namespace {

constexpr std::size_t kBlobHeader = 16;

struct E57Pictures {
  PagedFile file;
  std::vector<E57Image> pinholes;  ///< in file order
  std::vector<ImportWarning> warnings;
  std::size_t others = 0;
};

Result<E57Pictures> openPictures(const std::string& path) {
  auto file = PagedFile::open(path);
  if (!file) return fail(file.error());
  auto document = readE57Document(*file);
  if (!document) return fail(document.error());
  E57Pictures pictures{std::move(*file), {}, {}, 0};
  for (E57Image& image : document->images) {
    if (image.projection == E57Image::Projection::Pinhole) {
      pictures.pinholes.push_back(std::move(image));
      continue;
    }
    ++pictures.others;
    const char* kind = image.projection == E57Image::Projection::Spherical     ? "a spherical panorama, which no camera model covers yet"
                       : image.projection == E57Image::Projection::Cylindrical ? "a cylindrical panorama, which no camera model covers yet"
                                                                               : "a picture for reference, without a camera";
    pictures.warnings.push_back({fmt::format("'{}' is {}", image.name, kind), path});
  }
  return pictures;
}

double distortionOf(const E57Image& image, std::string_view name) {
  for (const auto& [key, value] : image.distortion)
    if (key == name) return value;
  return 0;
}

/// From the lens extension where it states a focal length, else from the standard's own numbers.
Result<Intrinsics> intrinsicsOf(const E57Image& image) {
  const auto d = [&](std::string_view name) { return distortionOf(image, name); };
  if (d("CV_FX") > 0 && d("CV_FY") > 0) {
    const std::vector<double> parameters = {d("CV_FX"), d("CV_FY"), d("CV_CX"), d("CV_CY"), d("CV_K1"), d("CV_K2"),
                                            d("CV_P1"), d("CV_P2"), d("CV_K3"), d("CV_K4"), d("CV_K5"), d("CV_K6")};
    return Intrinsics::fromParameters(CameraModel::OpenCv8, image.width, image.height, parameters);
  }
  if (!(image.focalLength > 0 && image.pixelWidth > 0 && image.pixelHeight > 0))
    return fail(fmt::format("'{}' has no usable focal length and pixel size", image.name));
  return Intrinsics::fromParameters(CameraModel::Pinhole, image.width, image.height,
                                    {image.focalLength / image.pixelWidth, image.focalLength / image.pixelHeight, image.principalX, image.principalY});
}

bool sameCamera(const Intrinsics& a, const Intrinsics& b) {
  return a.model == b.model && a.width == b.width && a.height == b.height && a.parameters() == b.parameters();
}

/// The bytes of a picture: a blob's section (ASTM E2807-11, 9.2).
Result<std::vector<std::byte>> blobOf(const PagedFile& file, const E57Image& image) {
  const std::string where = fmt::format("{}, picture '{}'", file.path(), image.name);
  if (image.coding == E57Image::Coding::None) return fail("The picture is neither JPEG nor PNG", where, "Export the file again");
  const auto begin = file.logicalFromPhysical(image.fileOffset, "the picture");
  if (!begin) return fail(begin.error());
  PageReader pages(file, 64);
  const auto header = pages.view(*begin, kBlobHeader);
  if (!header) return fail(header.error());
  const auto section = littleEndianAt<std::uint64_t>(header->data() + 8);
  if ((*header)[0] != std::byte{0} || section < kBlobHeader || image.length > section - kBlobHeader ||
      section > file.logicalSize() - *begin)
    return fail(fmt::format("There is no picture of {} bytes at offset {}", image.length, image.fileOffset), where, "Copy or export the file again");
  std::vector<std::byte> bytes(image.length);
  for (std::uint64_t at = 0; at < bytes.size();) {
    const std::size_t part = std::min<std::uint64_t>(bytes.size() - at, 60000);
    const auto piece = pages.view(*begin + kBlobHeader + at, part);
    if (!piece) return fail(piece.error());
    std::memcpy(bytes.data() + at, piece->data(), part);
    at += part;
  }
  return bytes;
}

class EmbeddedPictures : public PictureSource {
 public:
  explicit EmbeddedPictures(E57Pictures pictures) : m_pictures(std::move(pictures)) {}

  Result<ColourImage> picture(std::size_t index) override {
    if (index >= m_pictures.pinholes.size())
      return fail(fmt::format("There is no picture {}", index), m_pictures.file.path(), "Make the project anew");
    const E57Image& image = m_pictures.pinholes[index];
    const std::string where = fmt::format("{}, picture '{}'", m_pictures.file.path(), image.name);
    const auto bytes = blobOf(m_pictures.file, image);
    if (!bytes) return fail(bytes.error());
    const auto header = pictureHeaderOf(*bytes, where);
    if (!header) return fail(header.error());
    if (auto complete = checkPictureComplete(*bytes, where, *header); !complete) return fail(complete.error());
    try {
      // UNCHANGED keeps 16 bits and leaves the EXIF orientation alone.
      const cv::Mat coded(1, static_cast<int>(bytes->size()), CV_8U, const_cast<std::byte*>(bytes->data()));
      const cv::Mat decoded = cv::imdecode(coded, cv::IMREAD_UNCHANGED);
      if (decoded.empty() || (decoded.depth() != CV_8U && decoded.depth() != CV_16U))
        return fail("The picture cannot be decoded: it is damaged or of an unknown kind", where, "Export the file again");
      return colourImageFrom({decoded.data, decoded.step[0], decoded.cols, decoded.rows, decoded.channels(),
                              decoded.depth() == CV_16U ? 2 : 1});
    } catch (const std::exception& error) {
      return fail(std::string("The picture cannot be decoded: ") + error.what(), where, "Export the file again");
    }
  }

 private:
  E57Pictures m_pictures;
};

}  // namespace

ReaderDescription E57CameraReader::description() const { return {"e57-cameras", "E57 cameras", {"e57"}}; }

int E57CameraReader::sniff(const FileProbe& probe) const { return !probe.isFolder && probe.startsWith("ASTM-E57") ? 90 : 0; }

Result<CameraSet> E57CameraReader::inspect(const std::string& path) const { return read(path, Progress()); }

Result<CameraSet> E57CameraReader::read(const std::string& path, const Progress&) const {
  auto pictures = openPictures(path);
  if (!pictures) return fail(pictures.error());
  CameraSet set;
  set.warnings = std::move(pictures->warnings);
  const RigidTransform openCvFromE57{glm::dquat(0.0, 1.0, 0.0, 0.0), glm::dvec3(0)};  // half a turn about x
  for (const E57Image& image : pictures->pinholes) {
    PosedPicture posed;
    posed.name = image.name;
    if (image.hasPose) posed.cameraFromWorld = openCvFromE57 * image.worldFromCamera.inverse();
    auto intrinsics = intrinsicsOf(image);
    if (intrinsics)
      if (auto valid = intrinsics->validate(); !valid) intrinsics = tl::unexpected<Error>(valid.error());
    if (intrinsics) {
      const auto found = std::find_if(set.cameras.begin(), set.cameras.end(), [&](const Intrinsics& each) { return sameCamera(each, *intrinsics); });
      posed.camera = static_cast<int>(found - set.cameras.begin());
      if (found == set.cameras.end()) set.cameras.push_back(*intrinsics);
    } else {
      set.warnings.push_back({intrinsics.error().what, fmt::format("{}, picture '{}'", path, image.name)});
    }
    set.pictures.push_back(std::move(posed));
  }
  set.details = fmt::format("E57, {} pinhole and {} other pictures", set.pictures.size(), pictures->others);
  return set;
}

ReaderDescription E57PictureReader::description() const { return {"e57-pictures", "E57 pictures", {"e57"}}; }

int E57PictureReader::sniff(const FileProbe& probe) const { return !probe.isFolder && probe.startsWith("ASTM-E57") ? 85 : 0; }

Result<PictureSetInfo> E57PictureReader::inspect(const std::string& path) const {
  const auto pictures = openPictures(path);
  if (!pictures) return fail(pictures.error());
  if (pictures->pinholes.empty())
    return fail(pictures->others > 0 ? fmt::format("The file holds {} pictures, but none of a pinhole camera", pictures->others)
                                     : std::string("The file holds no pictures"), path, "Choose a file with pinhole pictures");
  PictureSetInfo info;
  info.isVideo = true;
  info.width = pictures->pinholes.front().width;
  info.height = pictures->pinholes.front().height;
  for (const E57Image& image : pictures->pinholes) info.pictures.push_back({image.name, path, 0});
  info.details = fmt::format("{} embedded in an E57 file, the first {} × {}", info.pictures.size(), info.width, info.height);
  return info;
}

Result<std::unique_ptr<PictureSource>> E57PictureReader::open(const std::string& path) const {
  auto pictures = openPictures(path);
  if (!pictures) return fail(pictures.error());
  return std::make_unique<EmbeddedPictures>(std::move(*pictures));
}

}  // namespace alidade

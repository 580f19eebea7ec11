// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "colmap/colmap_model.h"

namespace alidade {

namespace {

static_assert(std::endian::native == std::endian::little);

const std::string kAdvice = "Copy the model again, or export it as text: colmap model_converter --output_type TXT";

/// COLMAP's model ids (COLMAP 3.8, base/camera_models.h) with their number of parameters.
struct ModelId {
  std::string_view name;
  std::size_t parameters;
};
constexpr ModelId kModels[] = {
    {"SIMPLE_PINHOLE", 3}, {"PINHOLE", 4},     {"SIMPLE_RADIAL", 4},        {"RADIAL", 5},          {"OPENCV", 8},
    {"OPENCV_FISHEYE", 8}, {"FULL_OPENCV", 12}, {"FOV", 5}, {"SIMPLE_RADIAL_FISHEYE", 4}, {"RADIAL_FISHEYE", 5},
    {"THIN_PRISM_FISHEYE", 12}};

/// A file's bytes from front to back; a read past the end leaves `value` alone and makes it bad.
class Cursor {
 public:
  Cursor(std::span<const std::byte> bytes, const std::string& path) : m_bytes(bytes), m_path(path) {}

  template <class T>
  T take() {
    T value{};
    if (left() < sizeof value) {
      m_cut = true;
      m_at = m_bytes.size();
      return value;
    }
    std::memcpy(&value, m_bytes.data() + m_at, sizeof value);
    m_at += sizeof value;
    return value;
  }

  /// Up to a zero byte, which is taken, too.
  std::string_view takeName() {
    const auto* start = reinterpret_cast<const char*>(m_bytes.data() + m_at);
    const auto* end = left() == 0 ? nullptr : static_cast<const char*>(std::memchr(start, 0, left()));
    if (!end) {
      m_cut = true;
      m_at = m_bytes.size();
      return {};
    }
    m_at += static_cast<std::size_t>(end - start) + 1;
    return {start, static_cast<std::size_t>(end - start)};
  }

  /// False, and bad, where that many records of at least that size do not fit.
  bool holds(std::uint64_t count, std::size_t recordBytes) {
    if (count <= left() / recordBytes) return true;
    m_cut = true;
    return false;
  }
  void skip(std::uint64_t bytes) { m_at += static_cast<std::size_t>(bytes); }

  std::size_t left() const { return m_bytes.size() - m_at; }
  double fraction() const { return m_bytes.empty() ? 1.0 : double(m_at) / double(m_bytes.size()); }
  bool cut() const { return m_cut; }
  std::string place() const { return fmt::format("{}, byte {}", m_path, m_at); }
  tl::unexpected<Error> ends(std::string_view what) const {
    return fail(fmt::format("The file ends within {}, or it is no COLMAP model", what), place(), kAdvice);
  }

 private:
  std::span<const std::byte> m_bytes;
  const std::string& m_path;
  std::size_t m_at = 0;
  bool m_cut = false;
};

Result<void> checkEnd(const Cursor& cursor, ColmapModel& model) {
  if (cursor.left() > 0) model.warn(fmt::format("{} bytes after the last record were passed over", cursor.left()), cursor.place());
  return {};
}

}  // namespace

Result<void> parseColmapBinaryCameras(std::span<const std::byte> bytes, const std::string& path, ColmapModel& model) {
  Cursor cursor(bytes, path);
  const auto count = cursor.take<std::uint64_t>();
  if (cursor.cut() || !cursor.holds(count, 24)) return cursor.ends("its cameras");
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::string place = cursor.place();
    const auto id = cursor.take<std::uint32_t>();
    const auto kind = cursor.take<std::int32_t>();
    const auto width = cursor.take<std::uint64_t>(), height = cursor.take<std::uint64_t>();
    if (cursor.cut()) return cursor.ends("a camera");
    if (kind < 0 || kind >= static_cast<std::int32_t>(std::size(kModels)))
      return fail(fmt::format("Camera {} has the unknown model number {}", id, kind), place, kAdvice);
    std::vector<double> parameters(kModels[kind].parameters);
    for (double& value : parameters) value = cursor.take<double>();
    if (cursor.cut()) return cursor.ends("a camera");
    constexpr std::uint64_t kImpossible = 1u << 30;
    if (auto added = model.addCamera(id, kModels[kind].name, std::int64_t(std::min(width, kImpossible)),
                                     std::int64_t(std::min(height, kImpossible)), std::move(parameters), place); !added)
      return added;
  }
  return checkEnd(cursor, model);
}

Result<void> parseColmapBinaryImages(std::span<const std::byte> bytes, const std::string& path, bool withFeatures,
                                     const Progress& progress, ColmapModel& model) {
  constexpr std::size_t kImageBytes = 4 + 7 * 8 + 4 + 1 + 8, kFeatureBytes = 2 * 8 + 8;
  Cursor cursor(bytes, path);
  const auto count = cursor.take<std::uint64_t>();
  if (cursor.cut() || !cursor.holds(count, kImageBytes)) return cursor.ends("its images");
  for (std::uint64_t i = 0; i < count; ++i) {
    if (progress.cancelled()) return fail(cancelledError());
    progress.report(cursor.fraction(), "Reading images.bin");
    const std::string place = cursor.place();
    ColmapModel::Image image;
    image.id = cursor.take<std::uint32_t>();
    for (double& value : image.pose) value = cursor.take<double>();
    image.camera = cursor.take<std::uint32_t>();
    image.name = cursor.takeName();
    const auto features = cursor.take<std::uint64_t>();
    if (cursor.cut()) return cursor.ends("an image");
    if (image.name.empty()) return fail("The image has no name", place, kAdvice);
    if (!cursor.holds(features, kFeatureBytes)) return cursor.ends("the image points");
    if (auto added = model.addImage(image, place); !added) return added;
    if (!withFeatures) {
      cursor.skip(features * kFeatureBytes);
      continue;
    }
    for (std::uint64_t f = 0; f < features; ++f) {
      const auto x = cursor.take<double>(), y = cursor.take<double>();
      cursor.skip(8);
      if (auto added = model.addFeature(x, y, place); !added) return added;
    }
  }
  return checkEnd(cursor, model);
}

Result<void> parseColmapBinaryPoints(std::span<const std::byte> bytes, const std::string& path, const Progress& progress,
                                     ColmapModel& model) {
  constexpr std::size_t kPointBytes = 8 + 3 * 8 + 3 + 8 + 8, kTrackBytes = 8;
  Cursor cursor(bytes, path);
  const auto count = cursor.take<std::uint64_t>();
  if (cursor.cut() || !cursor.holds(count, kPointBytes)) return cursor.ends("its points");
  for (std::uint64_t i = 0; i < count; ++i) {
    if (i % 1024 == 0) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(cursor.fraction(), "Reading points3D.bin");
    }
    const std::string place = cursor.place();
    cursor.skip(cursor.left() < 8 ? cursor.left() : 8);  // the point's id: nothing asks for it
    std::array<double, 3> world{};
    for (double& value : world) value = cursor.take<double>();
    std::array<std::int64_t, 3> colour{};
    for (auto& value : colour) value = cursor.take<std::uint8_t>();
    cursor.take<double>();  // its reprojection error
    const auto track = cursor.take<std::uint64_t>();
    if (cursor.cut()) return cursor.ends("a point");
    if (!cursor.holds(track, kTrackBytes)) return cursor.ends("a point's track");
    if (auto added = model.startPoint(world, colour, place); !added) return added;
    for (std::uint64_t t = 0; t < track; ++t) {
      const auto image = cursor.take<std::uint32_t>(), feature = cursor.take<std::uint32_t>();
      model.addSighting(image, feature, place);
    }
  }
  return checkEnd(cursor, model);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "plugin_api/import_slip.h"
#include "plugin_api/reader.h"

namespace alidade {

/// A COLMAP model on its way into a CameraSet: COLMAP's own ids lead to indices. The text and the
/// binary form both feed it; every check of what the numbers mean is here.
class ColmapModel {
 public:
  struct Image {
    std::int64_t id = 0, camera = 0;
    std::array<double, 7> pose{};  ///< qw qx qy qz tx ty tz, camera from world
    std::string_view name;
  };

  /// Pixels in COLMAP's origin, the corner of the top-left pixel; `place` is for error messages.
  Result<void> addCamera(std::int64_t id, std::string_view modelName, std::int64_t width, std::int64_t height,
                         std::vector<double> parameters, const std::string& place);
  Result<void> addImage(const Image& image, const std::string& place);
  /// Of the last image; in COLMAP's origin.
  Result<void> addFeature(double x, double y, const std::string& place);
  Result<void> startPoint(const std::array<double, 3>& world, const std::array<std::int64_t, 3>& colour, const std::string& place);
  /// Of the last point.
  void addSighting(std::int64_t image, std::int64_t feature, const std::string& place);
  void noteImageWithoutPoints(const std::string& place) { m_noPoints.note(place); }

  /// The finished set, with the slips as warnings.
  CameraSet take();

  bool hasCameras() const { return !m_set.cameras.empty(); }
  void warn(std::string what, std::string where) { m_set.warnings.push_back({std::move(what), std::move(where)}); }

 private:
  CameraSet m_set;
  std::unordered_map<std::int64_t, int> m_cameraById;
  std::unordered_map<std::int64_t, int> m_pictureById;
  std::unordered_set<std::string> m_names;
  std::vector<std::vector<glm::dvec2>> m_features;  ///< by picture; OpenCV's origin; filled on demand
  ImportSlip m_noCamera, m_nameTwice, m_noPoints, m_dangling;
};

/// Each takes the text of one file; `path` is for error messages. On an Error the model is of no use.
Result<void> parseColmapCameras(std::string_view text, const std::string& path, ColmapModel& model);
Result<void> parseColmapImages(std::string_view text, const std::string& path, bool withFeatures,
                               const Progress& progress, ColmapModel& model);
Result<void> parseColmapPoints(std::string_view text, const std::string& path, const Progress& progress,
                               ColmapModel& model);

/// The same of cameras.bin, images.bin and points3D.bin (COLMAP 3.8, scene/reconstruction.cc): little-endian,
/// each a count of 64 bits and that many records.
Result<void> parseColmapBinaryCameras(std::span<const std::byte> bytes, const std::string& path, ColmapModel& model);
Result<void> parseColmapBinaryImages(std::span<const std::byte> bytes, const std::string& path, bool withFeatures,
                                     const Progress& progress, ColmapModel& model);
Result<void> parseColmapBinaryPoints(std::span<const std::byte> bytes, const std::string& path, const Progress& progress,
                                     ColmapModel& model);

}  // namespace alidade

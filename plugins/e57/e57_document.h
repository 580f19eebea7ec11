// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "e57/paged_file.h"
#include "geometry/bounds.h"
#include "geometry/rigid_transform.h"
#include "plugin_api/reader.h"

namespace alidade {

/// A number of a point record, as the prototype describes it.
struct E57Field {
  enum class Kind { Integer, ScaledInteger, Single, Double, String };
  std::string name;  ///< with its extension's prefix: "cartesianX", "nor:normalX", "las:classification"
  Kind kind = Kind::Double;
  std::int64_t minimum = INT64_MIN, maximum = INT64_MAX;  ///< raw, of the integer kinds
  double scale = 1, offset = 0;                           ///< value = raw · scale + offset, of ScaledInteger
  std::optional<double> floatMinimum, floatMaximum;       ///< where a Float states them

  bool isFloat() const { return kind == Kind::Single || kind == Kind::Double; }
  /// Bits a record takes in this field's stream; the least number for a String.
  std::uint64_t bits() const;
  /// Range of values that the field states; nothing where it leaves the whole range open.
  std::optional<std::pair<double, double>> range() const;
};

struct E57Limits {
  double minimum = 0, maximum = 0;
};

/// One set-up: an element of data3D.
struct E57Scan {
  std::string name;
  RigidTransform worldFromScanner;
  bool hasPose = false;
  Bounds localBounds;  ///< scanner's frame; empty where not stated
  std::uint64_t recordCount = 0;
  std::uint64_t fileOffset = 0;  ///< physical, of the compressed vector's section; 0 where there is none
  std::vector<E57Field> fields;  ///< in stream order
  std::optional<E57Limits> intensityLimits;
  std::optional<E57Limits> colourLimits[3];
  std::optional<std::pair<std::int64_t, std::int64_t>> rowBounds, columnBounds;

  int fieldNamed(const std::string& name) const;  ///< -1 where there is none
};

/// One element of images2D.
struct E57Image {
  enum class Projection { Visual, Pinhole, Spherical, Cylindrical };
  enum class Coding { None, Jpeg, Png };
  std::string name;
  Projection projection = Projection::Visual;
  Coding coding = Coding::None;
  std::uint64_t fileOffset = 0, length = 0;  ///< of the picture's blob: physical offset, bytes
  int width = 0, height = 0;
  bool hasPose = false;
  RigidTransform worldFromCamera;  ///< the standard's camera axes: x right, y up, z backwards
  double focalLength = 0, pixelWidth = 0, pixelHeight = 0;   ///< metres; pinhole
  double principalX = 0, principalY = 0;                     ///< pixels; pinhole
  /// The vendor extension for lens distortion: its numbers by name ("CV_K1", "CV_FX" …).
  std::vector<std::pair<std::string, double>> distortion;
};

/// What the XML section says.
struct E57Document {
  std::string library;   ///< what wrote the file; may be empty
  std::string crs;       ///< coordinateMetadata: WKT by the standard
  std::vector<E57Scan> scans;
  std::vector<E57Image> images;
  std::vector<ImportWarning> warnings;
};

/// Reads and checks the XML section. Error for broken XML, elements of a wrong type, unknown codecs, and
/// numbers that are none. Elements of extensions that nobody here knows are passed over.
Result<E57Document> readE57Document(const PagedFile& file);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "plugin_api/reader.h"
#include "plugin_api/text_file.h"

namespace alidade {

/// Numbers of a text one after the other, lines not minded; remembers the line.
class NumberStream {
 public:
  NumberStream(std::string_view text, const std::string& path) : m_lines(text), m_path(path) {}

  /// Error where the text ends or the next word is no finite number.
  Result<double> number();
  Result<std::int64_t> integer();
  /// An integer in [0, limit): a count or an index. `what` is for the message.
  Result<std::size_t> below(std::size_t limit, std::string_view what);

  bool atEnd();
  std::string place() const { return placeInFile(m_path, m_lines.number()); }
  double fraction() const { return m_lines.fraction(); }

 private:
  bool next(std::string_view& word);
  LineReader m_lines;
  FieldReader m_fields{{}};
  std::string_view m_ahead;
  const std::string& m_path;
};

/// A camera of Bundler or BAL as its file gives it.
struct CentredCamera {
  double f = 0, k1 = 0, k2 = 0;
  std::optional<RigidTransform> glCameraFromWorld;  ///< looks along -z, y up
};

/// An observation, pixels from the middle of the picture, y up.
struct CentredSighting {
  std::size_t point = 0, camera = 0;
  glm::dvec2 fromMiddle{0};
};

/// Cameras, points and sightings in Alidade's conventions, every camera with the smallest size that holds its
/// sightings and listed as without size.
Result<CameraSet> cameraSetOf(const std::vector<CentredCamera>& cameras, std::vector<TiePoint> points,
                              const std::vector<CentredSighting>& sightings, const std::string& path);

/// Gives a camera without size the size of its picture, and its sightings the pixels that follow.
void giveSize(CameraSet& set, int camera, int width, int height);

}  // namespace alidade

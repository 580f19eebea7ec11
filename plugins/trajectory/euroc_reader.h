// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string_view>

#include "plugin_api/reader.h"

namespace alidade {

/// Poses as the EuRoC data sets (ASL format) write them: `timestamp [ns], position, quaternion w x y z …` a line, commas
/// between, remarks with #; further columns (velocity, biases) are passed over. The poses are of the *body* in the
/// reference frame: they come out as if a camera sat in the body's place, with a warning, because the file does not
/// say where the camera is on the body: a rig file does. Without names, without cameras.
///
/// Refused, with the line: fewer than eight columns, broken or non-finite numbers, a zero quaternion.
class EurocReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

/// The same of a text in memory; `path` is for messages.
Result<CameraSet> parseEuroc(std::string_view text, const std::string& path, const Progress& progress);

}  // namespace alidade

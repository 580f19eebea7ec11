// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "plugin_api/reader.h"

namespace alidade {

/// The camera of a EuRoC `sensor.yaml` (plugin_api/euroc_sensor.h). Where it sits on its body is asked for by who puts
/// cameras on a sensor, a rig file.
class EurocSensorReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

Result<CameraSet> parseEurocCamera(const std::string& text, const std::string& path);

}  // namespace alidade

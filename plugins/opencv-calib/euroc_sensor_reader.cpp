// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "opencv-calib/euroc_sensor_reader.h"

#include <fmt/format.h>

#include "plugin_api/euroc_sensor.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t(1) << 20;

}  // namespace

Result<CameraSet> parseEurocCamera(const std::string& text, const std::string& path) {
  const auto sensor = parseEurocSensor(text, path);
  if (!sensor) return fail(sensor.error());
  CameraSet set;
  set.cameras.push_back(sensor->intrinsics);
  const glm::dvec3& at = sensor->bodyFromSensor.translation;
  set.details = fmt::format("EuRoC camera: {} × {}, {}, at {:.4f} {:.4f} {:.4f} m on its body", sensor->intrinsics.width, sensor->intrinsics.height,
                            cameraModelName(sensor->intrinsics.model), at.x, at.y, at.z);
  return set;
}

ReaderDescription EurocSensorReader::description() const { return {"euroc-sensor", "EuRoC camera", {"yaml", "yml"}}; }

int EurocSensorReader::sniff(const FileProbe& probe) const {
  return !probe.isFolder && looksLikeEurocSensor({reinterpret_cast<const char*>(probe.head.data()), probe.head.size()}) ? 95 : 0;
}

Result<CameraSet> EurocSensorReader::inspect(const std::string& path) const { return read(path, Progress()); }

Result<CameraSet> EurocSensorReader::read(const std::string& path, const Progress&) const {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return fail(text.error());
  return parseEurocCamera(*text, path);
}

}  // namespace alidade

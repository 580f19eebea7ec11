// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trajectory/tum_trajectory_reader.h"

#include <array>
#include <cmath>

#include "plugin_api/text_file.h"
#include "trajectory/pose_rows.h"
#include "trajectory/timed_pose.h"

namespace alidade {

namespace {

using TumLine = std::array<double, 8>;  // time, tx ty tz, qx qy qz qw

std::optional<TumLine> numbersOf(std::string_view line) {
  FieldReader fields(line);
  TumLine numbers{};
  for (double& value : numbers) {
    const auto number = fields.number();
    if (!number) return std::nullopt;
    value = *number;
  }
  return fields.rest().empty() ? std::optional(numbers) : std::nullopt;
}

double quaternionLength(const TumLine& n) { return std::hypot(std::hypot(n[4], n[5]), std::hypot(n[6], n[7])); }

}  // namespace

Result<CameraSet> parseTumTrajectory(std::string_view text, const std::string& path, const Progress& progress) {
  TrajectoryBuilder trajectory;
  LineReader lines(text);
  const auto read = forPoseRows(lines, path, progress, [&](std::string_view line, const std::string& place) -> Result<void> {
    const auto n = numbersOf(line);
    if (!n)
      return fail("The line is not eight numbers: time, position and quaternion are expected", place,
                  "Export the trajectory as `timestamp tx ty tz qx qy qz qw`");
    const auto& v = *n;
    return trajectory.add(v[0], {v[1], v[2], v[3]}, {v[4], v[5], v[6], v[7]}, place);
  });
  if (!read) return fail(read.error());
  return trajectory.take("TUM trajectory", path);
}

ReaderDescription TumTrajectoryReader::description() const { return {"tum-trajectory", "TUM trajectory", {"txt", "tum"}}; }

int TumTrajectoryReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  const std::string_view head(reinterpret_cast<const char*>(probe.head.data()), probe.head.size());
  LineReader lines(head);
  int poses = 0;
  for (std::string_view line; lines.next(line) && poses < 3;) {
    const std::string_view words = trimmed(line);
    if (words.empty() || words.starts_with('#')) continue;
    // The last line of the head may be cut off.
    if (poses > 0 && lines.fraction() == 1.0 && head.size() >= 4096) break;
    const auto n = numbersOf(line);
    if (!n) return 0;
    // Eight numbers may be many things, a unit quaternion at the end is hardly another one. A pose
    // file with broken numbers still belongs here: its error names the line.
    const double length = quaternionLength(*n);
    if (std::isfinite(length) && std::abs(length - 1) > 0.01) return probe.extension == "tum" ? 40 : 0;
    ++poses;
  }
  return poses > 0 ? 70 : probe.extension == "tum" ? 20 : 0;
}

Result<CameraSet> TumTrajectoryReader::inspect(const std::string& path) const { return read(path, Progress()); }

Result<CameraSet> TumTrajectoryReader::read(const std::string& path, const Progress& progress) const {
  const auto text = readTextFile(path);
  if (!text) return fail(text.error());
  return parseTumTrajectory(*text, path, progress);
}

}  // namespace alidade

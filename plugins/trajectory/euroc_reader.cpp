// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trajectory/euroc_reader.h"

#include <array>
#include <cmath>

#include "plugin_api/text_file.h"
#include "trajectory/pose_rows.h"
#include "trajectory/timed_pose.h"

namespace alidade {

namespace {

/// The first `count` comma-separated fields; nothing where there are fewer.
template <std::size_t count>
std::optional<std::array<std::string_view, count>> fieldsOf(std::string_view line) {
  std::array<std::string_view, count> fields;
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0 && line.empty()) return std::nullopt;
    const std::size_t comma = line.find(',');
    if (comma == std::string_view::npos && i + 1 < count) return std::nullopt;
    fields[i] = trimmed(line.substr(0, comma));
    line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
  }
  return fields;
}

struct EurocLine {
  std::int64_t nanoseconds = 0;
  std::array<double, 7> pose{};  // p, then q as w x y z
};

std::optional<EurocLine> lineOf(std::string_view line) {
  const auto fields = fieldsOf<8>(line);
  if (!fields) return std::nullopt;
  EurocLine parsed;
  const auto time = parseInteger((*fields)[0]);
  if (!time) return std::nullopt;
  parsed.nanoseconds = *time;
  for (std::size_t i = 0; i < 7; ++i) {
    const auto number = parseNumber((*fields)[i + 1]);
    if (!number) return std::nullopt;
    parsed.pose[i] = *number;
  }
  return parsed;
}

/// Whole seconds and the rest apart: a time since 1970 in nanoseconds has more digits than a double.
double secondsOf(std::int64_t nanoseconds) {
  return static_cast<double>(nanoseconds / 1'000'000'000) + static_cast<double>(nanoseconds % 1'000'000'000) * 1e-9;
}

}  // namespace

Result<CameraSet> parseEuroc(std::string_view text, const std::string& path, const Progress& progress) {
  TrajectoryBuilder trajectory;
  LineReader lines(text);
  const auto read = forPoseRows(lines, path, progress, [&](std::string_view line, const std::string& place) -> Result<void> {
    const auto parsed = lineOf(line);
    if (!parsed)
      return fail("The line is no pose: nanoseconds, position and quaternion w x y z are expected, commas between", place,
                  "Choose the data.csv of the ground truth's folder");
    const auto& p = parsed->pose;
    return trajectory.add(secondsOf(parsed->nanoseconds), {p[0], p[1], p[2]}, {p[4], p[5], p[6], p[3]}, place);
  });
  if (!read) return fail(read.error());
  auto set = trajectory.take("EuRoC trajectory", path);
  if (set) set->warnings.push_back({"The poses are of the measuring body, not of a camera: say where the camera is on it in a rig file", path});
  return set;
}

ReaderDescription EurocReader::description() const { return {"euroc-trajectory", "EuRoC trajectory", {"csv"}}; }

int EurocReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder || probe.extension != "csv") return 0;
  LineReader lines({reinterpret_cast<const char*>(probe.head.data()), probe.head.size()});
  for (std::string_view line; lines.next(line);) {
    const std::string_view words = trimmed(line);
    if (words.empty() || words.starts_with('#')) continue;
    const auto parsed = lineOf(words);
    if (!parsed || parsed->nanoseconds < 1'000'000) return 0;
    const auto& p = parsed->pose;
    return std::abs(std::hypot(std::hypot(p[3], p[4]), std::hypot(p[5], p[6])) - 1) < 0.01 ? 80 : 0;
  }
  return 0;
}

Result<CameraSet> EurocReader::inspect(const std::string& path) const { return read(path, Progress()); }

Result<CameraSet> EurocReader::read(const std::string& path, const Progress& progress) const {
  const auto text = readTextFile(path);
  if (!text) return fail(text.error());
  return parseEuroc(*text, path, progress);
}

}  // namespace alidade

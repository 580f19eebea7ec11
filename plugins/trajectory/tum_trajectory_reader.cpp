// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trajectory/tum_trajectory_reader.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "plugin_api/import_slip.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr double kFarthestM = 1e9;

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
  CameraSet set;
  ImportSlip unsorted, unnormalised, twice;
  LineReader lines(text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view words = trimmed(line);
    if (words.empty() || words.starts_with('#')) continue;
    if (lines.number() % 1024 == 0) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(lines.fraction(), "Reading the trajectory");
    }
    const std::string place = placeInFile(path, lines.number());
    const auto n = numbersOf(line);
    if (!n)
      return fail("The line is not eight numbers: time, position and quaternion are expected", place,
                  "Export the trajectory as `timestamp tx ty tz qx qy qz qw`");
    if (!std::all_of(n->begin(), n->end(), [](double v) { return std::isfinite(v); }))
      return fail("The pose is not finite", place, "Remove the line or export the trajectory again");
    if (std::any_of(n->begin() + 1, n->begin() + 4, [](double v) { return std::abs(v) > kFarthestM; }))
      return fail("The position is farther than 1e9 m", place, "Export the trajectory again in metres");
    const double length = quaternionLength(*n);
    if (!(length > 1e-6) || !std::isfinite(length))
      return fail("The rotation is zero or no quaternion", place, "Remove the line or export the trajectory again");
    if (std::abs(length - 1) > 1e-3) unnormalised.note(place);

    const RigidTransform worldFromCamera{
        glm::dquat((*n)[7] / length, (*n)[4] / length, (*n)[5] / length, (*n)[6] / length), {(*n)[1], (*n)[2], (*n)[3]}};
    PosedPicture pose;
    pose.timeSecs = (*n)[0];
    pose.hasTime = true;
    pose.cameraFromWorld = worldFromCamera.inverse();
    if (!set.pictures.empty() && pose.timeSecs < set.pictures.back().timeSecs) unsorted.note(place);
    if (!set.pictures.empty() && pose.timeSecs == set.pictures.back().timeSecs) twice.note(place);
    set.pictures.push_back(std::move(pose));
  }
  if (set.pictures.empty()) return fail("The file holds no pose", path, "Export the trajectory again");
  unsorted.tell(set.warnings, "times are out of order; the poses were sorted by time");
  twice.tell(set.warnings, "times come twice in a row");
  unnormalised.tell(set.warnings, "quaternions are not of unit length; they were normalised");
  std::stable_sort(set.pictures.begin(), set.pictures.end(),
                   [](const PosedPicture& a, const PosedPicture& b) { return a.timeSecs < b.timeSecs; });
  set.details = fmt::format("TUM trajectory: {} poses from {:.3f} s to {:.3f} s", set.pictures.size(),
                            set.pictures.front().timeSecs, set.pictures.back().timeSecs);
  return set;
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

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "bundler/bundler_reader.h"
#include "bundler/centred_camera.h"

namespace alidade {

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t(2) << 30;

/// Unit quaternion of a rotation vector: axis times angle.
glm::dquat rotationOf(const glm::dvec3& vector) {
  const double angle = glm::length(vector);
  return angle > 0 ? glm::angleAxis(angle, vector / angle) : glm::dquat(1.0, 0.0, 0.0, 0.0);
}

/// `cameras points observations` on one line and an observation on the next.
bool looksLikeBal(std::string_view head) {
  LineReader lines(head);
  std::string_view line;
  const auto nextLine = [&] {
    while (lines.next(line))
      if (!trimmed(line).empty()) return true;
    return false;
  };
  if (!nextLine()) return false;
  FieldReader counts(line);
  for (int i = 0; i < 3; ++i)
    if (const auto count = counts.integer(); !count || *count < 1) return false;
  if (!counts.rest().empty() || !nextLine()) return false;
  FieldReader sighting(line);
  const auto camera = sighting.integer(), point = sighting.integer();
  return camera && point && *camera >= 0 && *point >= 0 && sighting.number() && sighting.number() && sighting.rest().empty();
}

}  // namespace

Result<CameraSet> parseBal(std::string_view text, const std::string& path, const Progress& progress) {
  NumberStream numbers(text, path);
  // A number takes two characters at least.
  const std::size_t most = text.size() / 2 + 1;
  std::array<std::size_t, 3> counts{};
  const std::array<std::string_view, 3> names = {"number of cameras", "number of points", "number of observations"};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto count = numbers.below(most, names[i]);
    if (!count) return fail(count.error());
    counts[i] = *count;
  }
  if (counts[0] == 0) return fail("The problem has no cameras", path, "Choose another file");
  if (9 * counts[0] + 3 * counts[1] + 4 * counts[2] > most)
    return fail("The counts promise more than the file holds", numbers.place(), "Copy the file again");

  std::vector<CentredSighting> sightings(counts[2]);
  for (CentredSighting& s : sightings) {
    if (progress.cancelled()) return fail(cancelledError());
    const auto camera = numbers.below(counts[0], "camera"), point = camera ? numbers.below(counts[1], "point") : camera;
    if (!point) return fail(point.error());
    const auto x = numbers.number(), y = x ? numbers.number() : x;
    if (!y) return fail(y.error());
    s = {*point, *camera, {*x, *y}};
  }
  progress.report(0.7, "Reading cameras");
  std::vector<CentredCamera> cameras(counts[0]);
  for (CentredCamera& camera : cameras) {
    std::array<double, 9> v{};
    for (double& value : v) {
      const auto number = numbers.number();
      if (!number) return fail(number.error());
      value = *number;
    }
    camera = {v[6], v[7], v[8], RigidTransform{rotationOf({v[0], v[1], v[2]}), {v[3], v[4], v[5]}}};
  }
  std::vector<TiePoint> points(counts[1]);
  for (TiePoint& point : points)
    for (int axis = 0; axis < 3; ++axis) {
      const auto number = numbers.number();
      if (!number) return fail(number.error());
      point.world[axis] = *number;
    }
  if (!numbers.atEnd()) return fail("The file goes on after its last point: its counts are wrong", numbers.place(), "Copy the file again");
  auto set = cameraSetOf(cameras, std::move(points), sightings, path);
  if (!set) return set;
  set->details = fmt::format("BAL problem: {} cameras, {} points, {} observations", counts[0], counts[1], counts[2]);
  return set;
}

ReaderDescription BalReader::description() const { return {"bal", "BAL bundle adjustment problem", {"txt", "bal"}}; }

int BalReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  return looksLikeBal({reinterpret_cast<const char*>(probe.head.data()), probe.head.size()}) ? 75 : 0;
}

Result<CameraSet> BalReader::inspect(const std::string& path) const { return read(path, Progress()); }

Result<CameraSet> BalReader::read(const std::string& path, const Progress& progress) const {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return fail(text.error());
  return parseBal(*text, path, progress);
}

}  // namespace alidade

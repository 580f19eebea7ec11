// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trajectory/timed_pose.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace alidade {

Result<void> TrajectoryBuilder::add(double timeSecs, const glm::dvec3& position, const glm::dvec4& xyzw, const std::string& place) {
  constexpr double kFarthestM = 1e9;
  const auto finite = [](double v) { return std::isfinite(v); };
  const double numbers[] = {timeSecs, position.x, position.y, position.z, xyzw.x, xyzw.y, xyzw.z, xyzw.w};
  if (!std::all_of(std::begin(numbers), std::end(numbers), finite))
    return fail("The pose is not finite", place, "Remove the line or export the trajectory again");
  if (std::any_of(numbers + 1, numbers + 4, [](double v) { return std::abs(v) > kFarthestM; }))
    return fail("The position is farther than 1e9 m", place, "Export the trajectory again in metres");
  const double length = std::hypot(std::hypot(xyzw.x, xyzw.y), std::hypot(xyzw.z, xyzw.w));
  if (!(length > 1e-6) || !std::isfinite(length))
    return fail("The rotation is zero or no quaternion", place, "Remove the line or export the trajectory again");
  if (std::abs(length - 1) > 1e-3) m_unnormalised.note(place);

  const glm::dvec4 unit = xyzw / length;
  PosedPicture pose;
  pose.timeSecs = timeSecs;
  pose.hasTime = true;
  pose.cameraFromWorld = RigidTransform{glm::dquat(unit.w, unit.x, unit.y, unit.z), position}.inverse();
  if (!m_set.pictures.empty() && timeSecs < m_set.pictures.back().timeSecs) m_unsorted.note(place);
  if (!m_set.pictures.empty() && timeSecs == m_set.pictures.back().timeSecs) m_twice.note(place);
  m_set.pictures.push_back(std::move(pose));
  return {};
}

Result<CameraSet> TrajectoryBuilder::take(const std::string& formatName, const std::string& path) {
  if (m_set.pictures.empty()) return fail("The file holds no pose", path, "Export the trajectory again");
  m_unsorted.tell(m_set.warnings, "times are out of order; the poses were sorted by time");
  m_twice.tell(m_set.warnings, m_twice.count == 1 ? "time comes twice in a row" : "times come twice in a row");
  m_unnormalised.tell(m_set.warnings, "quaternions are not of unit length; they were normalised");
  std::stable_sort(m_set.pictures.begin(), m_set.pictures.end(),
                   [](const PosedPicture& a, const PosedPicture& b) { return a.timeSecs < b.timeSecs; });
  // Rounded, and a negative nothing made a nothing.
  const auto shown = [](const PosedPicture& picture) { return std::round(picture.timeSecs * 1000) / 1000 + 0.0; };
  m_set.details = fmt::format("{}: {} poses from {:.3f} s to {:.3f} s", formatName, m_set.pictures.size(),
                              shown(m_set.pictures.front()), shown(m_set.pictures.back()));
  return std::move(m_set);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bundler/centred_camera.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace alidade {

namespace {

const std::string kAdvice = "Copy the file again: it is cut off or edited";

}  // namespace

bool NumberStream::next(std::string_view& word) {
  if (!m_ahead.empty()) {
    word = std::exchange(m_ahead, {});
    return true;
  }
  while (!m_fields.next(word)) {
    std::string_view line;
    if (!m_lines.next(line)) return false;
    m_fields = FieldReader(trimmed(line).starts_with('#') ? std::string_view() : line);
  }
  return true;
}

bool NumberStream::atEnd() {
  std::string_view word;
  if (!next(word)) return true;
  m_ahead = word;
  return false;
}

Result<double> NumberStream::number() {
  std::string_view word;
  if (!next(word)) return fail("The file ends too early", place(), kAdvice);
  const auto value = parseNumber(word);
  if (!value) return fail("A number is expected, not " + quotedWords(word), place(), kAdvice);
  if (!std::isfinite(*value)) return fail("A number is not finite", place(), kAdvice);
  return *value;
}

Result<std::int64_t> NumberStream::integer() {
  std::string_view word;
  if (!next(word)) return fail("The file ends too early", place(), kAdvice);
  const auto value = parseInteger(word);
  if (!value) return fail("A whole number is expected, not " + quotedWords(word), place(), kAdvice);
  return *value;
}

Result<std::size_t> NumberStream::below(std::size_t limit, std::string_view what) {
  const auto value = integer();
  if (!value) return fail(value.error());
  if (*value < 0 || static_cast<std::uint64_t>(*value) >= limit)
    return fail(fmt::format("The {} {} is not below {}", what, *value, limit), place(), kAdvice);
  return static_cast<std::size_t>(*value);
}

Result<CameraSet> cameraSetOf(const std::vector<CentredCamera>& cameras, std::vector<TiePoint> points,
                              const std::vector<CentredSighting>& sightings, const std::string& path) {
  constexpr double kMaxHalfSide = 1 << 19;
  CameraSet set;
  std::vector<glm::dvec2> reach(cameras.size(), glm::dvec2(0.5));
  for (const CentredSighting& s : sightings) {
    const glm::dvec2 side = glm::abs(s.fromMiddle);
    if (!(side.x < kMaxHalfSide && side.y < kMaxHalfSide)) return fail("An observation is impossibly far from its picture's middle", path, kAdvice);
    reach[s.camera] = glm::max(reach[s.camera], side);
  }
  const RigidTransform openCvFromGl{glm::dquat(0.0, 1.0, 0.0, 0.0), glm::dvec3(0)};  // half a turn about x
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const CentredCamera& camera = cameras[i];
    PosedPicture picture;
    if (camera.glCameraFromWorld) {
      const int width = 2 * static_cast<int>(std::ceil(reach[i].x)), height = 2 * static_cast<int>(std::ceil(reach[i].y));
      const auto intrinsics = Intrinsics::fromParameters(
          CameraModel::Radial, width, height, {camera.f, 0.5 * (width - 1), 0.5 * (height - 1), camera.k1, camera.k2});
      if (!intrinsics) return fail(intrinsics.error().in(fmt::format("{}, camera {}", path, i)));
      picture.camera = static_cast<int>(set.cameras.size());
      set.camerasWithoutSize.push_back(picture.camera);
      set.cameras.push_back(*intrinsics);
      picture.cameraFromWorld = openCvFromGl * *camera.glCameraFromWorld;
      if (!picture.cameraFromWorld->isFinite()) return fail("The pose is not finite", fmt::format("{}, camera {}", path, i), kAdvice);
    }
    set.pictures.push_back(std::move(picture));
  }
  for (const CentredSighting& s : sightings) {
    const int camera = set.pictures[s.camera].camera;
    if (camera < 0) continue;  // never registered
    const Intrinsics& in = set.cameras[static_cast<std::size_t>(camera)];
    points[s.point].seenIn.emplace_back(static_cast<int>(s.camera), glm::dvec2(in.cx + s.fromMiddle.x, in.cy - s.fromMiddle.y));
  }
  set.tiePoints = std::move(points);
  return set;
}

void giveSize(CameraSet& set, int camera, int width, int height) {
  Intrinsics& in = set.cameras[static_cast<std::size_t>(camera)];
  const glm::dvec2 before(in.cx, in.cy), after(0.5 * (width - 1), 0.5 * (height - 1));
  in.width = width;
  in.height = height;
  in.cx = after.x;
  in.cy = after.y;
  std::erase(set.camerasWithoutSize, camera);
  for (TiePoint& point : set.tiePoints)
    for (auto& [picture, pixel] : point.seenIn)
      if (set.pictures[static_cast<std::size_t>(picture)].camera == camera) pixel += after - before;
}

}  // namespace alidade

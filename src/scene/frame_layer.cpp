// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/frame_layer.h"

#include <algorithm>

#include <vtkProperty.h>

namespace alidade {

namespace {

constexpr glm::dvec3 kPyramidColour{0.55, 0.62, 0.72};
constexpr glm::dvec3 kTrajectoryColour{0.38, 0.45, 0.58};
constexpr glm::dvec3 kCurrentColour{1.0, 0.85, 0.2};
constexpr std::size_t kMostPyramids = 150;
// Of the site's diagonal: one of many cameras, and the current one.
constexpr double kLength = 0.012, kCurrentLength = 0.025;
// A pyramid is drawn where it stands this part of its length from the last one or looks elsewhere: a video's would
// stack to a wall.
constexpr double kApart = 0.8, kTurned = 0.3;
constexpr double kPickPx = 5.0;

constexpr std::array<std::array<std::uint32_t, 2>, 10> kPyramidLines = {
    {{0, 1}, {0, 2}, {0, 3}, {0, 4}, {1, 2}, {2, 3}, {3, 4}, {4, 1}, {1, 5}, {5, 2}}};

/// Direction of a corner of the picture at depth 1. Where the lens model has no inverse there, and
/// for very wide lenses, the corner is drawn nearer to the axis.
glm::dvec3 cornerDirection(const Camera& camera, double x, double y) {
  const Intrinsics& k = camera.intrinsics();
  glm::dvec3 direction(0, 0, 1);
  if (const auto exact = camera.unproject({x, y}))
    direction = *exact;
  else if (k.fx > 0 && k.fy > 0)
    direction = {(x - k.cx) / k.fx, (y - k.cy) / k.fy, 1.0};
  const double radius = glm::length(glm::dvec2(direction));
  constexpr double kWidest = 1.5;
  if (radius > kWidest) direction = {direction.x * kWidest / radius, direction.y * kWidest / radius, 1.0};
  return direction;
}

}  // namespace

FrameLayer::FrameLayer(vtkRenderer* renderer)
    : m_pyramids(makeActor(kPyramidColour, false)),
      m_trajectory(makeActor(kTrajectoryColour, false)),
      m_currentPyramid(makeActor(kCurrentColour, false)) {
  for (const LitActor& each : {m_pyramids, m_trajectory, m_currentPyramid}) renderer->AddActor(each.actor);
}

FrameLayer::Pyramid FrameLayer::pyramidOf(std::size_t frame, double length) const {
  const SceneFrustum& source = m_frames[frame];
  const RigidTransform worldFromCamera = source.cameraFromWorld.inverse();
  const double right = source.camera.width() - 0.5, bottom = source.camera.height() - 0.5;
  Pyramid pyramid;
  pyramid.frame = frame;
  pyramid.world[0] = worldFromCamera * glm::dvec3(0);
  const std::array<glm::dvec2, 4> corners = {{{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}}};
  std::array<glm::dvec3, 4> inCamera;
  for (int i = 0; i < 4; ++i) {
    inCamera[i] = length * cornerDirection(source.camera, corners[i].x, corners[i].y);
    pyramid.world[i + 1] = worldFromCamera * inCamera[i];
  }
  const glm::dvec3 top = 0.5 * (inCamera[0] + inCamera[1]), height = inCamera[0] - inCamera[3];
  pyramid.world[5] = worldFromCamera * (top + 0.25 * height);
  return pyramid;
}

void FrameLayer::build(const glm::dvec3& origin, double sceneDiagonal) {
  m_origin = origin;
  const auto lengthOf = [&](double part) { return sceneDiagonal > 0 ? std::clamp(part * sceneDiagonal, 0.05, 50.0) : 1.0; };
  const double length = lengthOf(kLength);
  m_currentLength = lengthOf(kCurrentLength);
  m_shown.clear();
  const std::size_t step = (m_frames.size() + kMostPyramids - 1) / kMostPyramids;
  const RigidTransform* last = nullptr;
  std::vector<glm::vec3> points, path;
  std::vector<std::array<std::uint32_t, 2>> lines;
  for (std::size_t i = 0; i < m_frames.size(); ++i) {
    path.emplace_back(m_frames[i].cameraFromWorld.centre() - m_origin);
    const RigidTransform& pose = m_frames[i].cameraFromWorld;
    if (i % step != 0) continue;
    if (last && glm::length(pose.centre() - last->centre()) < kApart * length && rotationAngleBetween(pose, *last) < kTurned) continue;
    last = &pose;
    const Pyramid pyramid = pyramidOf(i, length);
    const auto first = static_cast<std::uint32_t>(points.size());
    for (const glm::dvec3& corner : pyramid.world) points.emplace_back(corner - m_origin);
    for (const auto& line : kPyramidLines) lines.push_back({first + line[0], first + line[1]});
    m_shown.push_back(pyramid);
  }
  m_pyramids.mapper->SetInputData(linesOf(points, lines));
  m_trajectory.mapper->SetInputData(polylineOf(path));
  buildCurrent();
}

void FrameLayer::setCurrent(FrameId frame) {
  m_current = frame;
  buildCurrent();
}

void FrameLayer::buildCurrent() {
  std::vector<glm::vec3> points;
  std::vector<std::array<std::uint32_t, 2>> lines;
  const SceneFrustum* current = find(m_current);
  if (current != nullptr) {
    const Pyramid pyramid = pyramidOf(static_cast<std::size_t>(current - m_frames.data()), m_currentLength);
    for (const glm::dvec3& corner : pyramid.world) points.emplace_back(corner - m_origin);
    lines.assign(kPyramidLines.begin(), kPyramidLines.end());
  }
  m_currentPyramid.mapper->SetInputData(linesOf(points, lines));
}

void FrameLayer::setLineScale(double devicePixelRatio) {
  m_lineScale = devicePixelRatio;
  m_pyramids.actor->GetProperty()->SetLineWidth(static_cast<float>(m_lineScale));
  m_trajectory.actor->GetProperty()->SetLineWidth(static_cast<float>(1.5 * m_lineScale));
  m_currentPyramid.actor->GetProperty()->SetLineWidth(static_cast<float>(2.5 * m_lineScale));
}

const SceneFrustum* FrameLayer::find(FrameId frame) const {
  const auto found = std::find_if(m_frames.begin(), m_frames.end(),
                                  [&](const SceneFrustum& each) { return frame && each.id == frame; });
  return found == m_frames.end() ? nullptr : &*found;
}

Bounds FrameLayer::bounds() const {
  Bounds all;
  for (const SceneFrustum& frame : m_frames) all.add(frame.cameraFromWorld.centre());
  return all;
}

std::optional<LayerHit> FrameLayer::hit(const ViewCamera& camera, const glm::dvec2& px) const {
  std::vector<Pyramid> candidates = m_shown;
  if (const SceneFrustum* current = find(m_current))
    candidates.push_back(pyramidOf(static_cast<std::size_t>(current - m_frames.data()), m_currentLength));
  std::optional<LayerHit> best;
  double bestDistance = kPickPx * m_lineScale;
  for (const Pyramid& pyramid : candidates) {
    for (const auto& line : kPyramidLines) {
      const auto near = distanceToSegmentPx(camera, px, pyramid.world[line[0]], pyramid.world[line[1]]);
      if (!near || near->x >= bestDistance) continue;
      bestDistance = near->x;
      best = LayerHit{near->y, {}};
      best->pick.world = pyramid.world[0];
      best->pick.frame = m_frames[pyramid.frame].id;
    }
  }
  return best;
}

}  // namespace alidade

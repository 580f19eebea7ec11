// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/observing.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "app/pose_clock.h"
#include "targets/mark_match.h"

namespace alidade {

namespace {

constexpr int kLineSamples = 192;

/// The place on the polyline a-b next to `at`.
glm::dvec2 nearestOnSegment(const glm::dvec2& at, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 d = b - a;
  const double length2 = glm::dot(d, d);
  return a + (length2 > 0 ? std::clamp(glm::dot(at - a, d) / length2, 0.0, 1.0) : 0.0) * d;
}

/// The drawn line from t = `from` to t = `to` of a + t (b - a), next to a pixel.
std::optional<glm::dvec2> nearestOnLine(const Camera& camera, const RollingShutter& shutter, const RigidTransform& cameraFromWorld, const glm::dvec3& a,
                                        const glm::dvec3& b, double from, double to, const glm::dvec2& at) {
  std::optional<glm::dvec2> best, last;
  for (int i = 0; i <= kLineSamples; ++i) {
    const double t = from + (to - from) * i / kLineSamples;
    const auto pixel = project(camera, shutter, cameraFromWorld * (a + t * (b - a)));
    if (pixel && last) {
      const glm::dvec2 near = nearestOnSegment(at, *last, *pixel);
      if (!best || glm::length(near - at) < glm::length(*best - at)) best = near;
    }
    last = pixel ? std::optional(*pixel) : std::nullopt;
  }
  return best;
}

/// Every feature edge of what is shown, with its element.
template <class Use>
void forEachEdge(const FrameDescription& frame, Use&& use) {
  for (const DesignLayer& layer : frame.designs) {
    const DesignModel& model = *layer.model;
    for (std::size_t e = 0; e < model.elements.size(); ++e) {
      if (!layer.elementVisible.empty() && !layer.elementVisible[e]) continue;
      const DesignElement& element = model.elements[e];
      for (std::uint32_t i = 0; i < element.edgeCount; ++i) {
        const auto& edge = model.edges[element.firstEdge + i];
        use(element, model.world(edge[0]), model.world(edge[1]));
      }
    }
  }
}

/// How a frame sees a place: what its picture shows of the plane that faces the reference camera there.
std::optional<glm::dmat2> shapeBetween(const Camera& reference, const RigidTransform& referencePose, const Camera& camera,
                                       const RigidTransform& pose, const glm::dvec3& world) {
  const glm::dvec3 seen = referencePose * world;
  const RigidTransform back = referencePose.inverse();
  const double step = 2 * seen.z / std::sqrt(std::abs(reference.intrinsics().fx * reference.intrinsics().fy));
  const auto in = [&](const Camera& c, const RigidTransform& p, double dx, double dy) {
    return c.project(p * (back * (seen + glm::dvec3(dx, dy, 0))));
  };
  const auto r0 = in(reference, referencePose, 0, 0), rx = in(reference, referencePose, step, 0), ry = in(reference, referencePose, 0, step);
  const auto p0 = in(camera, pose, 0, 0), px = in(camera, pose, step, 0), py = in(camera, pose, 0, step);
  if (!r0 || !rx || !ry || !p0 || !px || !py) return std::nullopt;
  return glm::dmat2(*px - *p0, *py - *p0) * glm::inverse(glm::dmat2(*rx - *r0, *ry - *r0));
}

}  // namespace

ObservationId nextObservationId(const Project& project) {
  ObservationId id;
  for (const Observation& o : project.observations) id.value = std::max(id.value, o.id.value);
  ++id.value;
  return id;
}

std::string freePointName(const Project& project, const std::string& prefix) {
  std::set<std::string> taken;
  for (const Observation& o : project.observations) taken.insert(o.name);
  for (const ControlPoint& p : project.controlPoints) taken.insert(p.name);
  for (const StakePoint& p : project.stakePoints) taken.insert(p.name);
  for (int i = 1;; ++i)
    if (std::string name = fmt::format("{}{}", prefix, i); !taken.contains(name)) return name;
}

std::optional<glm::dvec2> fittedPixel(const Camera& camera, const RollingShutter& shutter, const RigidTransform& cameraFromWorld,
                                      const Observation& seen) {
  if (seen.kind != ObservedKind::Edge) return project(camera, shutter, cameraFromWorld * seen.world);
  // The line goes on beyond its ends, as the adjustment takes it.
  return nearestOnLine(camera, shutter, cameraFromWorld, seen.world, seen.edgeEnd, -0.5, 1.5, seen.pixel);
}

std::optional<double> depthResidualM(const Project& project, const Observation& depth) {
  const Frame* frame = depth.kind == ObservedKind::Depth ? project.findFrame(depth.frame) : nullptr;
  const CameraRecord* camera = frame ? project.findCamera(frame->camera) : nullptr;
  if (!camera || !frame->cameraFromWorld) return std::nullopt;
  const Observation* point = nullptr;
  for (const Observation& o : project.observations) {
    const bool known = o.kind == ObservedKind::Control || o.kind == ObservedKind::Scan;
    if (known && o.name == depth.name && (!point || o.frame == depth.frame)) point = &o;
  }
  if (!point) return std::nullopt;
  const RigidTransform pose = point->frame != depth.frame
                                  ? *frame->cameraFromWorld
                                  : shutterOf(project, *frame).poseAtRow(*frame->cameraFromWorld, point->pixel.y, camera->camera.height());
  return (pose * point->world).z - depth.depthM;
}

std::optional<DesignSnap> designCornerAt(const FrameDescription& frame, const glm::dvec2& pixel, double radiusPx) {
  std::optional<DesignSnap> best;
  double bestDepth = 0;
  forEachEdge(frame, [&](const DesignElement& element, const glm::dvec3& a, const glm::dvec3& b) {
    for (const glm::dvec3& world : {a, b}) {
      const glm::dvec3 inCamera = frame.cameraFromWorld * world;
      const auto at = project(frame.camera, frame.shutter, inCamera);
      if (!at) continue;
      const double distance = glm::length(*at - pixel);
      if (distance > radiusPx) continue;
      const bool nearer = !best || distance < best->distancePx - 1 || (distance < best->distancePx + 1 && inCamera.z < bestDepth);
      if (!nearer) continue;
      best = DesignSnap{element.name, world, {}, distance};
      bestDepth = inCamera.z;
    }
  });
  return best;
}

std::optional<DesignSnap> designEdgeAt(const FrameDescription& frame, const glm::dvec2& pixel, double radiusPx) {
  std::optional<DesignSnap> best;
  double bestDepth = 0;
  forEachEdge(frame, [&](const DesignElement& element, const glm::dvec3& a, const glm::dvec3& b) {
    const auto near = nearestOnLine(frame.camera, frame.shutter, frame.cameraFromWorld, a, b, 0, 1, pixel);
    if (!near) return;
    const double distance = glm::length(*near - pixel);
    const double depth = std::min((frame.cameraFromWorld * a).z, (frame.cameraFromWorld * b).z);
    if (distance > radiusPx) return;
    if (best && !(distance < best->distancePx - 1 || (distance < best->distancePx + 1 && depth < bestDepth))) return;
    best = DesignSnap{element.name, a, b, distance};
    bestDepth = depth;
  });
  return best;
}

Result<MatchedObservations> matchInOtherFrames(const Project& project, const Observation& seen, PictureCache& pictures,
                                               const Progress& progress) {
  if (seen.kind == ObservedKind::Edge || !seen.hasPixel())
    return fail("Only a point that was seen in the picture can be found again", seen.name, "Choose a point");
  const Frame* own = project.findFrame(seen.frame);
  const CameraRecord* ownCamera = own ? project.findCamera(own->camera) : nullptr;
  if (!ownCamera || !own->cameraFromWorld) return fail("The frame of '" + seen.name + "' has no camera or no pose", project.path);
  const auto reference = pictures.picture(project, *own);
  if (!reference) return fail(reference.error());
  std::set<FrameId> done;
  for (const Observation& o : project.observations)
    if (o.name == seen.name && o.hasPixel()) done.insert(o.frame);

  MatchedObservations made;
  ObservationId id = nextObservationId(project);
  for (std::size_t i = 0; i < project.frames.size(); ++i) {
    if (progress.cancelled()) return fail(cancelledError());
    const Frame& frame = project.frames[i];
    progress.report(static_cast<double>(i) / static_cast<double>(project.frames.size()), frame.name);
    const CameraRecord* camera = project.findCamera(frame.camera);
    if (done.contains(frame.id) || !camera || !frame.cameraFromWorld) continue;
    const auto expected = camera->camera.project(*frame.cameraFromWorld * seen.world);
    if (!expected || !camera->camera.inPicture(*expected)) continue;
    const auto shape = shapeBetween(ownCamera->camera, *own->cameraFromWorld, camera->camera, *frame.cameraFromWorld, seen.world);
    if (!shape) continue;
    const auto picture = pictures.picture(project, frame);
    if (!picture) {
      made.notes.push_back(fmt::format("{}: {}", frame.name, picture.error().what));
      continue;
    }
    const auto match = matchMark(**reference, seen.pixel, **picture, *expected, *shape);
    if (!match) {
      made.notes.push_back(fmt::format("{}: {}", frame.name, match.error().what));
      continue;
    }
    Observation found = seen;
    found.id = id, ++id.value;
    found.frame = frame.id;
    found.pixel = match->pixel;
    found.enabled = true;
    made.observations.push_back(std::move(found));
  }
  return made;
}

}  // namespace alidade

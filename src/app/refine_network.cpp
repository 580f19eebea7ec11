// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/refine_network.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "app/observing.h"
#include "app/pose_clock.h"
#include "plugin_api/picture_header.h"

namespace alidade {

namespace {

/// Says something of a point that other rows observe.
bool isOfPoint(const ObservationRow& row) {
  return row.kind == ObservationKind::Surface || row.kind == ObservationKind::Depth;
}

/// Builds the network row by row.
class Builder {
 public:
  Builder(const Project& project, const std::string& frame, const NetworkFreedom& freedom)
      : m_project(project), m_frame(frame), m_freedom(freedom) {}

  Result<void> add(const ObservationRow& row, std::size_t index);
  NetworkRefinement take() { return std::move(m_made); }

 private:
  Result<int> frameOf(const ObservationRow& row);
  Result<int> addFrame(FrameId id, const ObservationRow& row);
  int cameraOf(const CameraRecord& record);
  Result<int> pointOf(const ObservationRow& row);

  const Project& m_project;
  const std::string& m_frame;
  const NetworkFreedom& m_freedom;
  NetworkRefinement m_made;
  std::map<std::string, int> m_points;
  std::map<std::pair<int, int>, std::string> m_seen;
};

Result<int> Builder::frameOf(const ObservationRow& row) {
  const std::string& name = row.frame.empty() ? m_frame : row.frame;
  if (name.empty()) return fail("The row names no frame", row.where, "Add the column frame, or give --frame");
  const auto id = m_project.frameByNameOrIndex(name);
  if (!id) return fail(id.error().in(row.where));
  const auto known = std::find(m_made.frames.begin(), m_made.frames.end(), *id);
  if (known != m_made.frames.end()) return static_cast<int>(known - m_made.frames.begin());
  return addFrame(*id, row);
}

int Builder::cameraOf(const CameraRecord& record) {
  const auto known = std::find(m_made.cameras.begin(), m_made.cameras.end(), record.id);
  if (known != m_made.cameras.end()) return static_cast<int>(known - m_made.cameras.begin());
  m_made.cameras.push_back(record.id);
  m_made.network.cameras.push_back({record.name, record.camera.intrinsics(), m_freedom.focal, m_freedom.principalPoint, m_freedom.distortion});
  return static_cast<int>(m_made.cameras.size()) - 1;
}

Result<int> Builder::addFrame(FrameId id, const ObservationRow& row) {
  const Frame& frame = *m_project.findFrame(id);
  const CameraRecord* record = m_project.findCamera(frame.camera);
  if (!record) return fail("Frame '" + frame.name + "' has no camera", row.where, "Add a calibration first");
  NetworkPose pose;
  pose.name = frame.name;
  pose.bodyFromWorld = frame.cameraFromWorld;
  pose.timeSecs = frame.timeSecs;
  for (int i = 0; i < 3; ++i) pose.locked[i] = m_freedom.lockPosition[i], pose.locked[3 + i] = m_freedom.lockAttitude[i];
  NetworkFrame made;
  made.name = frame.name;
  made.pose = static_cast<int>(m_made.network.poses.size());
  made.camera = cameraOf(*record);
  made.shutter = shutterOf(m_project, frame);
  // A picture that is not there cannot contradict its calibration; opening it says so elsewhere.
  if (const auto header = frame.image.path.empty() ? Result<PictureHeader>(PictureHeader{}) : readPictureHeader(frame.image.path))
    made.pictureWidth = header->width, made.pictureHeight = header->height;
  m_made.frames.push_back(id);
  m_made.network.poses.push_back(std::move(pose));
  m_made.network.frames.push_back(std::move(made));
  return static_cast<int>(m_made.frames.size()) - 1;
}

Result<int> Builder::pointOf(const ObservationRow& row) {
  const PointKind kind = row.kind == ObservationKind::Control ? PointKind::Control
                         : row.kind == ObservationKind::Scan  ? PointKind::Scan
                                                              : PointKind::Tie;
  const auto [at, added] = m_points.emplace(row.name, static_cast<int>(m_made.network.points.size()));
  if (!added) {
    NetworkPoint& point = m_made.network.points[at->second];
    if (point.kind != kind) return fail("'" + row.name + "' is a known point in one row and a tie point in another", row.where, "Name them apart");
    if (kind != PointKind::Tie && glm::length(*point.world - *row.world) > 1e-6)
      return fail("'" + row.name + "' has two positions", row.where, "Name the two points apart, or correct the coordinates");
    return at->second;
  }
  NetworkPoint point;
  point.name = row.name, point.kind = kind, point.world = row.world;
  point.sigmaM = glm::dvec3(kind == PointKind::Tie ? 0.0 : row.sigmaM);
  m_made.network.points.push_back(std::move(point));
  return at->second;
}

Result<void> Builder::add(const ObservationRow& row, std::size_t index) {
  Network& n = m_made.network;
  if (isOfPoint(row)) {
    const auto point = m_points.find(row.name);
    if (point == m_points.end()) return fail("No row observes the point '" + row.name + "'", row.where, "Add a row where a picture shows it");
    if (row.kind == ObservationKind::Surface) {
      NetworkPoint& held = n.points[point->second];
      if (held.kind != PointKind::Tie) return fail("'" + row.name + "' is a known point: it needs no surface", row.where, "Delete the row, or make it a tie point");
      if (held.surface) return fail("'" + row.name + "' lies on two surfaces", row.where, "Delete one of the two");
      held.surface = SurfaceHold{*row.world, *row.second, row.sigmaM};
      m_made.surfaceRows[point->second] = index;
      return {};
    }
    const auto frame = frameOf(row);
    if (!frame) return fail(frame.error());
    n.depths.push_back({*frame, point->second, row.depthM, row.sigmaM, row.heldOut});
    m_made.depthRows.push_back(index);
    return {};
  }
  const auto frame = frameOf(row);
  if (!frame) return fail(frame.error());
  if (row.kind == ObservationKind::Edge) {
    n.edges.push_back({*frame, *row.world, *row.second, row.pixel, row.sigmaPx, row.heldOut, row.name});
    m_made.edgeRows.push_back(index);
    return {};
  }
  if (row.kind == ObservationKind::Position) {
    PosePrior prior;
    prior.pose = n.frames[*frame].pose;
    const auto& pose = n.poses[prior.pose].bodyFromWorld;
    prior.bodyFromWorld.rotation = pose ? pose->rotation : glm::dquat(1, 0, 0, 0);
    prior.bodyFromWorld.translation = -(prior.bodyFromWorld.rotation * *row.world);
    for (int i = 0; i < 3; ++i) prior.covariance[i][i] = row.sigmaM * row.sigmaM;
    n.priors.push_back(prior);
    return {};
  }
  const auto point = pointOf(row);
  if (!point) return fail(point.error());
  const auto [at, added] = m_seen.emplace(std::pair(*frame, *point), row.where);
  if (!added)
    return fail("'" + row.name + "' is observed twice in frame '" + n.frames[*frame].name + "'", row.where, "The other is at " + at->second + "; delete one");
  n.observations.push_back({*frame, *point, row.pixel, row.sigmaPx, row.heldOut});
  m_made.observationRows.push_back(index);
  return {};
}

/// What a file's rows and a project's observations call the same.
constexpr std::array kKinds{
    std::pair{ObservedKind::Control, ObservationKind::Control}, std::pair{ObservedKind::Scan, ObservationKind::Scan},
    std::pair{ObservedKind::Tie, ObservationKind::Tie},         std::pair{ObservedKind::Edge, ObservationKind::Edge},
    std::pair{ObservedKind::Depth, ObservationKind::Depth},     std::pair{ObservedKind::Surface, ObservationKind::Surface}};

ObservationKind kindOf(ObservedKind kind) {
  return std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& pair) { return pair.first == kind; })->second;
}

}  // namespace

Result<NetworkRefinement> networkOf(const Project& project, const std::string& frame,
                                    const std::vector<ObservationRow>& rows, const NetworkFreedom& freedom) {
  Builder builder(project, frame, freedom);
  // What is known of a point comes after the point, wherever its row stands.
  for (const bool points : {true, false})
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (isOfPoint(rows[i]) != points)
        if (const auto added = builder.add(rows[i], i); !added) return fail(added.error());
  NetworkRefinement made = builder.take();
  auto clocks = tieMotion(project, made.frames, freedom.ties, made.network);
  if (!clocks) return fail(clocks.error());
  made.clocks = std::move(*clocks);
  return made;
}

std::optional<std::size_t> NetworkRefinement::rowOf(const NetworkResidual& residual) const {
  const auto index = static_cast<std::size_t>(residual.index);
  switch (residual.kind) {
    case ResidualKind::Control:
    case ResidualKind::Scan:
    case ResidualKind::Tie:
      return observationRows[index];
    case ResidualKind::Edge:
      return edgeRows[index];
    case ResidualKind::Depth:
      return depthRows[index];
    case ResidualKind::Surface:
      return surfaceRows.at(residual.index);
    default:
      return std::nullopt;
  }
}

std::vector<ObservationRow> observationRowsOf(const Project& project, FrameId only) {
  const auto wanted = [&](const Observation& o) {
    if (only) return o.enabled && o.frame == only && o.kind != ObservedKind::Tie;
    return o.enabled && (o.kind == ObservedKind::Surface || project.findFrame(o.frame));
  };
  std::set<std::string> seen;
  for (const Observation& o : project.observations)
    if (wanted(o) && o.hasPixel() && o.kind != ObservedKind::Edge) seen.insert(o.name);
  std::vector<ObservationRow> rows;
  for (std::size_t i = 0; i < project.observations.size(); ++i) {
    const Observation& o = project.observations[i];
    const bool surface = o.kind == ObservedKind::Surface;
    if (!wanted(o) || (!o.hasPixel() && !seen.contains(o.name))) continue;
    ObservationRow row;
    row.where = fmt::format("{}, observation {}", project.path, i + 1);
    row.id = o.id;
    if (!surface) row.frame = project.findFrame(o.frame)->name;
    row.name = o.name.empty() ? fmt::format("observation {}", i + 1) : o.name;
    row.kind = kindOf(o.kind);
    if (o.kind != ObservedKind::Tie || o.world != glm::dvec3(0)) row.world = o.world;
    row.pixel = o.pixel, row.sigmaPx = o.sigmaPx, row.sigmaM = o.sigmaM, row.heldOut = o.heldOut;
    row.depthM = o.depthM;
    if (o.kind == ObservedKind::Edge || surface) row.second = o.edgeEnd;
    rows.push_back(std::move(row));
  }
  return rows;
}

Result<void> keepObservations(Project& project, const std::string& frame, const std::vector<ObservationRow>& rows) {
  std::vector<Observation> kept;
  std::set<std::tuple<FrameId, ObservedKind, std::string>> replaced;
  ObservationId id = nextObservationId(project);
  for (const ObservationRow& row : rows) {
    const auto kind = std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& pair) { return pair.second == row.kind; });
    if (kind == kKinds.end()) return fail("A project keeps no camera's position", row.where, "Leave the row out, or do not keep the observations");
    Observation o;
    if (row.kind != ObservationKind::Surface) {
      const auto named = project.frameByNameOrIndex(row.frame.empty() ? frame : row.frame);
      if (!named) return fail(named.error().in(row.where));
      o.frame = *named;
    }
    o.id = id, ++id.value;
    o.kind = kind->first, o.name = row.name, o.pixel = row.pixel, o.depthM = row.depthM;
    o.world = row.world.value_or(glm::dvec3(0)), o.edgeEnd = row.second.value_or(glm::dvec3(0));
    o.sigmaPx = row.sigmaPx, o.sigmaM = row.sigmaM, o.heldOut = row.heldOut;
    replaced.emplace(o.frame, o.kind, o.name);
    kept.push_back(std::move(o));
  }
  std::erase_if(project.observations, [&](const Observation& o) { return replaced.contains({o.frame, o.kind, o.name}); });
  project.observations.insert(project.observations.end(), kept.begin(), kept.end());
  return {};
}

Result<NetworkSummary> refineNetwork(Project& project, const NetworkRefinement& refinement, const NetworkOptions& options,
                                     bool dryRun, const Progress& progress) {
  auto summary = adjustNetwork(refinement.network, options, progress);
  if (!summary || !summary->converged || dryRun) return summary;
  applyMotion(project, refinement.frames, refinement.network, refinement.clocks, *summary);
  for (std::size_t i = 0; i < refinement.frames.size(); ++i) {
    Frame& frame = *project.findFrame(refinement.frames[i]);
    const AdjustedPose& adjusted = summary->poses[refinement.network.frames[i].pose];
    if (!frame.originalCameraFromWorld) frame.originalCameraFromWorld = frame.cameraFromWorld;
    frame.cameraFromWorld = cameraFromWorld(refinement.network, *summary, static_cast<int>(i));
    frame.poseSource = PoseSource::Refined;
    frame.quality = PoseQuality{adjusted.rmsPx, summary->sigma0, adjusted.positionStdM, adjusted.rotationStdRad, adjusted.observations};
  }
  for (std::size_t i = 0; i < refinement.cameras.size(); ++i) {
    const NetworkCamera& camera = refinement.network.cameras[i];
    if (!camera.freeFocal && !camera.freePrincipalPoint && !camera.freeDistortion) continue;
    for (CameraRecord& record : project.cameras)
      if (record.id == refinement.cameras[i]) record.camera = Camera(summary->cameras[i]);
  }
  return summary;
}

}  // namespace alidade

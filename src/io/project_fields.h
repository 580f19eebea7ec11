// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "survey/classification.h"
#include "survey/project.h"

namespace alidade {

// Which member stands in which column of resources/schemas/project.sql, said once for writing and
// reading: a visitor is called with every column's name and its member, in the table's order.

/// A list that hangs on another one: `parent` is the position of its owner.
struct ScanAttributeRow {
  std::int64_t parent = 0;
  std::string name;
};
struct ScanStationRow {
  std::int64_t parent = 0;
  Station station;
};
/// The rolling shutter of the camera at position `parent`; those of a global shutter have no row.
struct CameraShutterRow {
  std::int64_t parent = 0;
  double readoutSecs = 0;
};
struct CameraMountRow {
  std::int64_t parent = 0;
  CameraMount mount;
};
struct VideoTimingRow {
  std::int64_t parent = 0;
  FrameTiming timing = FrameTiming::Container;
};
struct TrajectoryPoseRow {
  std::int64_t parent = 0;
  PoseSample sample;
};
/// The trajectory of the frame at position `parent`.
struct FrameTrajectoryRow {
  std::int64_t parent = 0;
  TrajectoryId trajectory;
};
/// One of PointStyle::cuts.
struct PointCutRow {
  CutPlane cut;
};
struct HiddenElementRow {
  std::int64_t parent = 0;
  std::string globalId;
};
/// Camera itself is immutable.
struct CameraRow {
  CameraId id;
  std::string name;
  Intrinsics intrinsics;
};
struct ProjectRow {
  std::string name, crs;
};

template <class V>
void visitVector(V& v, const std::array<const char*, 3>& columns, glm::dvec3& value) {
  for (int i = 0; i < 3; ++i) v(columns[i], value[i]);
}

template <class V>
void visitPose(V& v, const std::array<const char*, 7>& columns, RigidTransform& pose) {
  v(columns[0], pose.rotation.w);
  v(columns[1], pose.rotation.x);
  v(columns[2], pose.rotation.y);
  v(columns[3], pose.rotation.z);
  visitVector(v, {columns[4], columns[5], columns[6]}, pose.translation);
  v.check(pose.isFinite(), columns[0], "is no finite pose");
}

template <class V>
void visitOptionalPose(V& v, const char* flag, const std::array<const char*, 7>& columns,
                       std::optional<RigidTransform>& pose) {
  bool has = pose.has_value();
  v(flag, has);
  RigidTransform value = pose.value_or(RigidTransform::identity());
  visitPose(v, columns, value);
  pose = has ? std::optional(value) : std::nullopt;
}

template <class V>
void visitSource(V& v, const std::array<const char*, 3>& columns, SourceFile& source) {
  v(columns[0], source.path);
  v(columns[1], source.size);
  v(columns[2], source.hash);
}

template <class V>
void visit(V& v, ProjectRow& row) {
  v("name", row.name);
  v("crs", row.crs);
}

template <class V>
void visit(V& v, DisplaySettings& d) {
  v("image_pass", d.imagePass);
  v("depth_pass", d.depthPass);
  v("design_pass", d.designPass);
  v("point_pass", d.pointPass);
  v("density", d.density);
  v.choice("density_law", d.densityLaw, {"points_per_pixel", "points_per_square_metre"});
  v("points_per_square_metre", d.pointsPerSquareMetre);
  v.choice("level_threshold", d.levelThreshold, {"by_distance", "by_point", "uniform"});
  v("point_size", d.pointSize);
  v("round_points", d.roundPoints);
  v.choice("hidden", d.hidden, {"hide", "ghost", "dash"});
  v("design_opacity", d.designOpacity);
  v("design_edges", d.designEdges);
  v("design_faces", d.designFaces);
  v("grayscale_image", d.grayscaleImage);
  v("grayscale_design", d.grayscaleDesign);
  visitVector(v, {"light_x", "light_y", "light_z"}, d.lightDirection);
  v("ambient", d.ambient);
  v("diffuse", d.diffuse);
  v("specular", d.specular);
  v("shininess", d.shininess);
  v("stake_points", d.stakePoints);
  v("annotations", d.annotations);
  v("labels", d.labels);
  v("residual_scale", d.residualScale);
  v("subdivision_error_px", d.subdivisionErrorPx);
  v("depth_tolerance_m", d.depthToleranceM);
}

template <class V>
void visit(V& v, PointStyle& p) {
  v.choice("colour_by", p.colourBy,
           {"rgb", "intensity", "height", "classification", "return", "gps_time", "scan", "distance", "normal"});
  v.choice("ramp", p.ramp, {"viridis", "cividis", "grey"});
  v("automatic_range", p.automaticRange);
  v("range_low", p.rangeLow);
  v("range_high", p.rangeHigh);
  std::string classes = textOfClasses(p.hiddenClasses);
  v("hidden_classes", classes);
  const auto parsed = classesOfText(classes);
  v.check(parsed.has_value(), "hidden_classes", "is no list of classes");
  if (parsed) p.hiddenClasses = *parsed;
  v("box_on", p.clipBox.on);
  visitVector(v, {"box_e", "box_n", "box_h"}, p.clipBox.centre);
  visitVector(v, {"box_size_x", "box_size_y", "box_size_z"}, p.clipBox.size);
  v("box_heading_rad", p.clipBox.headingRad);
  v("section_on", p.section.on);
  visitVector(v, {"section_e", "section_n", "section_h"}, p.section.point);
  v("section_azimuth_rad", p.section.azimuthRad);
  v("section_elevation_rad", p.section.elevationRad);
  v("section_thickness_m", p.section.thicknessM);
  v.choice("size_law", p.sizeLaw, {"spacing", "screen", "fixed"});
  v("eye_dome", p.eyeDome);
  v("eye_dome_strength", p.eyeDomeStrength);
}

template <class V>
void visit(V& v, PointCutRow& row) {
  v("is_on", row.cut.on);
  visitVector(v, {"e", "n", "h"}, row.cut.point);
  v("azimuth_rad", row.cut.azimuthRad);
  v("elevation_rad", row.cut.elevationRad);
}

template <class V>
void visit(V& v, Scan& scan) {
  v("id", scan.id);
  v("name", scan.name);
  visitSource(v, {"source_path", "source_size", "source_hash"}, scan.source);
  v("visible", scan.visible);
  v("point_count", scan.info.pointCount);
  visitVector(v, {"bounds_min_e", "bounds_min_n", "bounds_min_h"}, scan.info.bounds.min);
  visitVector(v, {"bounds_max_e", "bounds_max_n", "bounds_max_h"}, scan.info.bounds.max);
  v("crs", scan.info.crs);
  visitVector(v, {"scale_e", "scale_n", "scale_h"}, scan.info.scale);
  v("details", scan.info.details);
}

template <class V>
void visit(V& v, ScanAttributeRow& row) {
  v("scan", row.parent);
  v("name", row.name);
}

template <class V>
void visit(V& v, ScanStationRow& row) {
  v("scan", row.parent);
  v("name", row.station.name);
  visitPose(v, {"qw", "qx", "qy", "qz", "te", "tn", "th"}, row.station.worldFromScanner);
  v("grid_rows", row.station.rows);
  v("grid_columns", row.station.columns);
}

template <class V>
void visit(V& v, Design& design) {
  v("id", design.id);
  v("name", design.name);
  visitSource(v, {"source_path", "source_size", "source_hash"}, design.source);
  v("visible", design.visible);
}

template <class V>
void visit(V& v, HiddenElementRow& row) {
  v("design", row.parent);
  v("global_id", row.globalId);
}

template <class V>
void visit(V& v, CameraRow& row) {
  v("id", row.id);
  v("name", row.name);
  Intrinsics& k = row.intrinsics;
  std::string model(cameraModelName(k.model));
  v("model", model);
  const auto parsed = parseCameraModel(model);
  v.check(parsed.has_value(), "model", "is no camera model of this version");
  if (parsed) k.model = *parsed;
  v("width", k.width);
  v("height", k.height);
  v("fx", k.fx);
  v("fy", k.fy);
  v("cx", k.cx);
  v("cy", k.cy);
  Distortion& d = k.distortion;
  constexpr std::array<const char*, 6> radial = {"k1", "k2", "k3", "k4", "k5", "k6"};
  for (std::size_t i = 0; i < radial.size(); ++i) v(radial[i], d.k[i]);
  constexpr std::array<const char*, 3> denominator = {"q1", "q2", "q3"};
  for (std::size_t i = 0; i < denominator.size(); ++i) v(denominator[i], d.q[i]);
  v("p1", d.p1);
  v("p2", d.p2);
  constexpr std::array<const char*, 4> growth = {"t3", "t4", "t5", "t6"}, prism = {"s1", "s2", "s3", "s4"};
  for (std::size_t i = 0; i < growth.size(); ++i) v(growth[i], d.t[i]);
  for (std::size_t i = 0; i < prism.size(); ++i) v(prism[i], d.s[i]);
  v("shear", d.shear);
  // One column for the two: no model has both.
  v("skew", k.model == CameraModel::BrownSkewed ? d.imageSkew : d.skew);
  v("tau_x", d.tauX);
  v("tau_y", d.tauY);
  v("fisheye", d.fisheye);
  // A camera that never got a calibration is kept as it is; any other must be one that projects.
  const auto valid = k.width == 0 && k.fx == 0 ? Result<void>() : k.validate();
  v.check(valid.has_value(), "fx", valid ? "" : "gives no camera: " + valid.error().what);
}

template <class V>
void visit(V& v, Video& video) {
  v("id", video.id);
  v("name", video.name);
  visitSource(v, {"source_path", "source_size", "source_hash"}, video.source);
  v("frames_per_second", video.framesPerSecond);
  v("frame_count", video.frameCount);
}

template <class V>
void visit(V& v, CameraShutterRow& row) {
  v("camera", row.parent);
  v("readout_s", row.readoutSecs);
  v.check(std::isfinite(row.readoutSecs), "readout_s", "is no time");
}

template <class V>
void visit(V& v, CameraMountRow& row) {
  v("camera", row.parent);
  v("body", row.mount.body);
  visitPose(v, {"qw", "qx", "qy", "qz", "tx", "ty", "tz"}, row.mount.cameraFromBody);
  visitVector(v, {"std_tx_m", "std_ty_m", "std_tz_m"}, row.mount.offsetStdM);
  visitVector(v, {"std_x_rad", "std_y_rad", "std_z_rad"}, row.mount.rotationStdRad);
}

template <class V>
void visit(V& v, VideoTimingRow& row) {
  v("video", row.parent);
  v.choice("timing", row.timing, {"container", "constant_rate", "table"});
}

template <class V>
void visit(V& v, Trajectory& trajectory) {
  v("id", trajectory.id);
  v("name", trajectory.name);
  visitSource(v, {"source_path", "source_size", "source_hash"}, trajectory.source);
  v("clock_offset_s", trajectory.clockOffsetSecs);
  v.check(std::isfinite(trajectory.clockOffsetSecs), "clock_offset_s", "is no time");
  bool hasStd = trajectory.clockOffsetStdSecs.has_value();
  double std = trajectory.clockOffsetStdSecs.value_or(0);
  v("has_clock_offset_std", hasStd);
  v("clock_offset_std_s", std);
  trajectory.clockOffsetStdSecs = hasStd ? std::optional(std) : std::nullopt;
}

template <class V>
void visit(V& v, TrajectoryPoseRow& row) {
  v("trajectory", row.parent);
  v("time_s", row.sample.timeSecs);
  v.check(std::isfinite(row.sample.timeSecs), "time_s", "is no time");
  visitPose(v, {"qw", "qx", "qy", "qz", "tx", "ty", "tz"}, row.sample.cameraFromWorld);
}

template <class V>
void visit(V& v, FrameTrajectoryRow& row) {
  v("frame", row.parent);
  v("trajectory", row.trajectory);
}

template <class V>
void visit(V& v, Frame& frame) {
  v("id", frame.id);
  v("name", frame.name);
  v("time_s", frame.timeSecs);
  v("camera", frame.camera);
  visitSource(v, {"image_path", "image_size", "image_hash"}, frame.image);
  v("video", frame.video);
  v("video_frame", frame.videoFrame);
  visitOptionalPose(v, "has_pose", {"qw", "qx", "qy", "qz", "tx", "ty", "tz"}, frame.cameraFromWorld);
  visitOptionalPose(v, "has_original_pose",
                    {"original_qw", "original_qx", "original_qy", "original_qz", "original_tx", "original_ty",
                     "original_tz"},
                    frame.originalCameraFromWorld);
  v.choice("pose_source", frame.poseSource, {"none", "file", "interpolated", "refined"});
  bool hasQuality = frame.quality.has_value();
  PoseQuality quality = frame.quality.value_or(PoseQuality{});
  v("has_quality", hasQuality);
  v("rms_px", quality.rmsPx);
  v("sigma0", quality.sigma0);
  visitVector(v, {"std_e_m", "std_n_m", "std_h_m"}, quality.positionStdM);
  visitVector(v, {"std_x_rad", "std_y_rad", "std_z_rad"}, quality.rotationStdRad);
  v("quality_observations", quality.observations);
  frame.quality = hasQuality ? std::optional(quality) : std::nullopt;
}

template <class V>
void visit(V& v, StakePoint& point) {
  v("name", point.name);
  visitVector(v, {"e", "n", "h"}, point.position);
  v("code", point.code);
  v("tolerance_m", point.toleranceM);
}

template <class V>
void visit(V& v, ControlPoint& point) {
  v("name", point.name);
  visitVector(v, {"e", "n", "h"}, point.position);
  v("sigma_m", point.sigmaM);
}

template <class V>
void visit(V& v, Observation& observation) {
  v("id", observation.id);
  v("frame", observation.frame);
  v.choice("kind", observation.kind, {"control", "scan", "tie", "edge", "depth", "surface"});
  v("u_px", observation.pixel.x);
  v("v_px", observation.pixel.y);
  visitVector(v, {"e", "n", "h"}, observation.world);
  visitVector(v, {"e2", "n2", "h2"}, observation.edgeEnd);
  v("depth_m", observation.depthM);
  v("sigma_px", observation.sigmaPx);
  v("sigma_m", observation.sigmaM);
  v("name", observation.name);
  v("enabled", observation.enabled);
  v("held_out", observation.heldOut);
}

template <class V>
void visit(V& v, Annotation& annotation) {
  v("id", annotation.id);
  v.choice("kind", annotation.kind, {"text", "arrow", "callout"});
  v.choice("anchor", annotation.anchor, {"world", "picture"});
  v("text", annotation.text);
  v("frame", annotation.frame);
  visitVector(v, {"e", "n", "h"}, annotation.world);
  v("u_px", annotation.pixel.x);
  v("v_px", annotation.pixel.y);
  v("offset_u_px", annotation.offsetPx.x);
  v("offset_v_px", annotation.offsetPx.y);
  v("red", annotation.colour.r);
  v("green", annotation.colour.g);
  v("blue", annotation.colour.b);
  v("alpha", annotation.colour.a);
}

template <class V>
void visit(V& v, Finding& finding) {
  v("id", finding.id);
  v("name", finding.name);
  v("text", finding.text);
  v("element_global_id", finding.elementGlobalId);
  visitVector(v, {"e", "n", "h"}, finding.world);
  v("deviation_m", finding.deviationM);
}

}  // namespace alidade

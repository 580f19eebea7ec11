// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/image.h"
#include "camera/camera.h"
#include "geometry/rigid_transform.h"
#include "survey/display_settings.h"
#include "survey/ids.h"
#include "survey/point_batch.h"
#include "survey/trajectory.h"

namespace alidade {

/// A file the project stands on. Stored relative to the project file; checked by size and hash.
struct SourceFile {
  std::string path;        ///< absolute in memory; relative to the project in the store
  std::uint64_t size = 0;  ///< bytes
  std::string hash;        ///< see io/project_store.h; empty where not taken yet
};

struct Scan {
  ScanId id;
  std::string name;
  SourceFile source;
  ScanInfo info;
  bool visible = true;
};

struct Design {
  DesignId id;
  std::string name;
  SourceFile source;
  bool visible = true;
  std::vector<std::string> hiddenElements;  ///< globalIds switched off
};

/// Where a camera sits on the body that carries it: the sensor whose trajectory is known, or the camera that the others
/// of a rig were adjusted to.
struct CameraMount {
  std::string body;               ///< its name; mounts on the same body make one rig
  RigidTransform cameraFromBody;
  glm::dvec3 offsetStdM{0};       ///< of the translation, where it was adjusted
  glm::dvec3 rotationStdRad{0};   ///< about the camera's x, y, z
};

struct CameraRecord {
  CameraId id;
  std::string name;
  Camera camera;
  double readoutSecs = 0;  ///< rolling shutter, see camera/rolling_shutter.h; 0: all rows at once
  std::optional<CameraMount> mount = {};
};

/// Where a video's frames have their times from.
enum class FrameTiming { Container, ConstantRate, Table };

struct Video {
  VideoId id;
  std::string name;
  SourceFile source;
  double framesPerSecond = 0;
  std::int64_t frameCount = 0;
  FrameTiming timing = FrameTiming::Container;
};

/// A camera's poses over time, and how their clock stands to the pictures': a frame of time t has the pose at
/// t + clockOffsetSecs.
struct Trajectory {
  TrajectoryId id;
  std::string name;
  SourceFile source;
  PoseTrack track;
  double clockOffsetSecs = 0;
  std::optional<double> clockOffsetStdSecs;  ///< where it was estimated
};

/// Where a frame's pose comes from, in the words shown on screen.
enum class PoseSource { None, File, Interpolated, Refined };

/// How well a frame's pose is known; all from adjust/.
struct PoseQuality {
  double rmsPx = 0;
  double sigma0 = 0;
  glm::dvec3 positionStdM{0};    ///< standard deviations of the camera's centre, E N H, metres
  glm::dvec3 rotationStdRad{0};  ///< about the camera's x, y, z
  int observations = 0;
};

/// One picture with its time and, where known, its pose.
struct Frame {
  FrameId id;
  std::string name;
  double timeSecs = 0;
  CameraId camera;
  SourceFile image;             ///< a picture file; empty where the frame is of a video
  VideoId video;
  std::int64_t videoFrame = 0;  ///< index in the video, from 0

  TrajectoryId trajectory;      ///< that its pose is interpolated on, and its velocity taken from

  std::optional<RigidTransform> cameraFromWorld;
  std::optional<RigidTransform> originalCameraFromWorld;  ///< as imported, once a refinement replaced it
  PoseSource poseSource = PoseSource::None;
  std::optional<PoseQuality> quality;
};

/// A point to be set out: name, coordinates, code, tolerance circle.
struct StakePoint {
  std::string name;
  glm::dvec3 position{0};  ///< world metres
  std::string code;
  double toleranceM = 0.02;
};

/// A point of known coordinates that poses are held to.
struct ControlPoint {
  std::string name;
  glm::dvec3 position{0};
  double sigmaM = 0.003;
};

/// What was seen in a picture.
enum class ObservedKind {
  Control,  ///< a surveyed or designed point
  Scan,     ///< a point picked in a scan
  Tie,      ///< a point of unknown place, under the same name in several frames; `world` is a first guess, zero where there is none
  Edge,     ///< a place on the straight edge from `world` to `edgeEnd`
  Depth,    ///< how far along the optical axis the point of that name lies; no pixel
  Surface,  ///< the tie point of that name lies on the plane through `world` with the normal `edgeEnd`; no frame, no pixel
};

/// A world point, or a place on an edge, seen in a picture; or what else is known of a point.
struct Observation {
  ObservationId id;
  FrameId frame;
  ObservedKind kind = ObservedKind::Control;
  glm::dvec2 pixel{0};    ///< OpenCV's origin
  glm::dvec3 world{0};    ///< metres
  glm::dvec3 edgeEnd{0};  ///< of an edge; of a surface its normal
  double depthM = 0;      ///< of a depth
  double sigmaPx = 0.5;
  double sigmaM = 0;      ///< of the world point, on each axis; of the depth; across the surface
  std::string name;
  bool enabled = true;
  bool heldOut = false;   ///< takes no part; its residual is shown beside the fitted ones

  bool hasPixel() const { return kind != ObservedKind::Depth && kind != ObservedKind::Surface; }
};

enum class AnnotationKind { Text, Arrow, Callout };
enum class AnnotationAnchor { World, Picture };

/// A remark. Tied to the world it follows the camera and shows in every frame that sees it; tied
/// to the picture it belongs to one frame.
struct Annotation {
  AnnotationId id;
  AnnotationKind kind = AnnotationKind::Text;
  AnnotationAnchor anchor = AnnotationAnchor::Picture;
  std::string text;
  FrameId frame;                ///< the frame it was made in; the only one that shows a Picture anchor
  glm::dvec3 world{0};          ///< what it points at (anchor World)
  glm::dvec2 pixel{0};          ///< what it points at (anchor Picture), pixels of the raw picture
  glm::dvec2 offsetPx{60, -40}; ///< from there to the text, or the arrow's tail; raw-picture pixels
  Rgba8 colour{255, 200, 0, 255};
};

/// Something found wrong, with the element it concerns. Issues beyond the first release fill it.
struct Finding {
  FindingId id;
  std::string name;
  std::string text;
  std::string elementGlobalId;
  glm::dvec3 world{0};
  double deviationM = 0;
};

/// All that a project file holds. Plain data: copy it to change it (undo is a copy).
struct Project {
  std::string name;
  std::string crs;
  std::string path;  ///< of the project file; empty before the first save
  std::vector<Scan> scans;
  std::vector<Design> designs;
  std::vector<CameraRecord> cameras;
  std::vector<Video> videos;
  std::vector<Trajectory> trajectories;
  std::vector<Frame> frames;  ///< in time order
  std::vector<StakePoint> stakePoints;
  std::vector<ControlPoint> controlPoints;
  std::vector<Observation> observations;
  std::vector<Annotation> annotations;
  std::vector<Finding> findings;
  DisplaySettings display;

  const Frame* findFrame(FrameId id) const;
  Frame* findFrame(FrameId id);
  const CameraRecord* findCamera(CameraId id) const;
  CameraRecord* findCamera(CameraId id);
  const Video* findVideo(VideoId id) const;
  const Trajectory* findTrajectory(TrajectoryId id) const;
  Trajectory* findTrajectory(TrajectoryId id);
  /// By name ("101_0367_0007.JPG", with or without its ending) or by index from 0 ("12").
  Result<FrameId> frameByNameOrIndex(const std::string& text) const;
};

}  // namespace alidade

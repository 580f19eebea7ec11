// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "adjust/pose_accuracy.h"
#include "base/error.h"
#include "base/progress.h"
#include "camera/camera.h"
#include "camera/rolling_shutter.h"
#include "geometry/rigid_transform.h"

namespace alidade {

// A network: pictures, what was seen in them, and all else that is known of where they were taken. Plain data;
// indices count from 0. Metres, radians, pixels in OpenCV's origin. Standard deviations are a priori.

/// A camera, or the body (a rig, a sensor) that carries cameras, at one moment.
struct NetworkPose {
  std::string name;
  std::optional<RigidTransform> bodyFromWorld;  ///< start; nothing: found from known points, where it carries a camera itself
  std::array<bool, 6> locked{};                 ///< centre E N H, rotation about the body's x y z
  double timeSecs = 0;                          ///< for trajectories and smoothness
};

/// Where a camera sits on its body: one offset for all pictures taken with it (source B's device chain).
struct NetworkMount {
  std::string name;
  RigidTransform cameraFromBody;
  std::array<bool, 6> locked{true, true, true, true, true, true};  ///< translation, rotation about the camera's x y z
};

struct NetworkCamera {
  std::string name;
  Intrinsics intrinsics;
  bool freeFocal = false, freePrincipalPoint = false, freeDistortion = false;
  std::vector<bool> held = {};  ///< parameters in the model's order that stay as they are all the same; empty: none
};

struct NetworkFrame {
  std::string name;
  int pose = -1, camera = -1;
  int mount = -1;                         ///< -1: the pose is the camera's own
  int pictureWidth = 0, pictureHeight = 0;  ///< of the picture itself, where known: it must fit the calibration
  /// Picks and edges are held to the pose of the row that they were seen in, the depth of a picked point too; the motion is
  /// taken as known. The frame's pose is that of the middle row, which other depths refer to.
  RollingShutter shutter = {};
};

enum class PointKind {
  Control,  ///< surveyed
  Scan,     ///< picked in a scan
  Tie,      ///< unknown
};

/// Holds a point to a surface that the scan shows: normal · (X - through) = 0 ± sigma.
struct SurfaceHold {
  glm::dvec3 through{0}, normal{0, 0, 1};
  double sigmaM = 0.005;
};

struct NetworkPoint {
  std::string name;
  PointKind kind = PointKind::Tie;
  std::optional<glm::dvec3> world;  ///< known coordinates, or a tie point's start; without it, intersected from its rays
  glm::dvec3 sigmaM{0};             ///< of known coordinates, E N H; 0: exact
  std::optional<SurfaceHold> surface;  ///< tie points only
};

/// A point seen in a picture. Held out: takes no part, its residual is reported beside the fitted ones.
struct PictureObservation {
  int frame = -1, point = -1;
  glm::dvec2 pixel{0};
  double sigmaPx = 0.5;
  bool heldOut = false;
};

/// A place on the picture of a straight edge, whose line in the world goes through `from` and `to`. The residual
/// is the distance, across the edge as the lens draws it. Two places or more an edge and picture.
struct EdgeObservation {
  int frame = -1;
  glm::dvec3 from{0}, to{0};
  glm::dvec2 pixel{0};
  double sigmaPx = 0.5;
  bool heldOut = false;
  std::string name;
};

/// Depth (z along the optical axis) of a point in a picture, as a scan or a depth camera gives it.
struct DepthObservation {
  int frame = -1, point = -1;
  double depthM = 0, sigmaM = 0.01;
  bool heldOut = false;
};

/// A pose known beforehand: GNSS and IMU, or another adjustment.
struct PosePrior {
  int pose = -1;
  RigidTransform bodyFromWorld;
  Covariance6 covariance{};  ///< centre E N H, rotation about the body's x y z; a zero variance on the diagonal: not known at all
};

/// Poses on a clock of their own: pose i, taken at its timeSecs on the pictures' clock, is held to the trajectory at
/// timeSecs + clockOffsetSecs, with one standard deviation for position and attitude.
struct NetworkTrajectory {
  std::vector<double> timeSecs;               ///< increasing
  std::vector<RigidTransform> bodyFromWorld;  ///< one a time
  std::vector<int> poses;                     ///< the poses held to it
  double positionSigmaM = 0.02, attitudeSigmaRad = 0.002;
  double clockOffsetSecs = 0;
  bool clockFree = false;
};

/// Three consecutive poses or more move smoothly: velocities change like a random walk (white acceleration).
struct NetworkSmoothness {
  std::vector<int> poses;                ///< in time order
  double metresPerSecond2 = 1;           ///< standard deviation of acceleration, times sqrt(1 s)
  double radiansPerSecond2 = 0.5;
};

struct Network {
  std::vector<NetworkPose> poses;
  std::vector<NetworkMount> mounts;
  std::vector<NetworkCamera> cameras;
  std::vector<NetworkFrame> frames;
  std::vector<NetworkPoint> points;
  std::vector<PictureObservation> observations;
  std::vector<EdgeObservation> edges;
  std::vector<DepthObservation> depths;
  std::vector<PosePrior> priors;
  std::vector<NetworkTrajectory> trajectories;
  std::vector<NetworkSmoothness> smoothness;
};

struct NetworkOptions {
  double huberSigmas = 2.5;    ///< robust loss of what is seen; 0: none
  double outlierSigmas = 3.5;  ///< beyond this (and beyond what chance gives so many) an observation takes no part
  int maximumIterations = 100;
  bool freeNetwork = false;    ///< nothing known need fix origin, direction and scale; standard deviations are then not given
  bool covariance = true;
  struct At {
    int frame = -1;
    glm::dvec3 world{0};
  };
  std::vector<At> at;          ///< where the expected error is wanted

  Result<void> validate() const;
};

enum class ResidualKind { Control, Scan, Tie, Edge, Depth, Surface, Coordinates, Prior, Trajectory, Smoothness };
const char* residualKindName(ResidualKind kind);

struct NetworkResidual {
  ResidualKind kind = ResidualKind::Control;
  int index = -1;            ///< into the network's list of that kind (a surface or coordinates: the point)
  int frame = -1, point = -1;
  std::string name;
  glm::dvec2 residualPx{0};  ///< projected - observed; of an edge: across it. NaN where the kind has no pixels
  double residualM = 0;      ///< of a depth: adjusted - observed; of a surface: off it along the normal. Else NaN
  double sigmas = 0;         ///< length in standard deviations
  bool outlier = false, heldOut = false;
};

struct ResidualGroup {
  ResidualKind kind = ResidualKind::Control;
  bool heldOut = false;
  int count = 0, outliers = 0;
  double rmsPx = 0;      ///< NaN where the kind has no pixels
  double rmsM = 0;       ///< NaN but for depths and surfaces
  double rmsSigmas = 0;  ///< one for honest sigmas, a little less where much was adjusted
};

struct AdjustedPose {
  RigidTransform bodyFromWorld;
  Covariance6 covariance{};
  glm::dvec3 positionStdM{0}, rotationStdRad{0};
  PositionEllipse ellipse;
  double rmsPx = 0;       ///< of what was fitted in its pictures
  int observations = 0, outliers = 0;
};

/// How well a calibration is known.
struct CameraAccuracy {
  std::vector<double> covariance;  ///< of its parameters in the model's order, row by row, locked ones 0; empty: none was free
  /// Correlation of the (first) focal length with the way of the camera along its axis, for each of its frames with a
  /// pose of its own; 1: the two cannot be told apart.
  std::vector<double> focalWithDistance;

  double std(int parameter) const;
  double correlation(int a, int b) const;  ///< 0 where one is locked
};

/// How well a mount is known; zero where it was locked.
struct MountAccuracy {
  glm::dvec3 offsetStdM{0}, rotationStdRad{0};
};

/// A known point that took no part: where the adjusted rays of two pictures or more meet, against its coordinates.
struct CheckPoint {
  int point = -1;
  std::string name;
  glm::dvec3 differenceM{0};  ///< intersected - known
};

struct NetworkSummary {
  bool converged = false;
  std::string reason;              ///< why it ended, or why it was refused
  int iterations = 0;
  double initialCost = 0, finalCost = 0;  ///< half the (robust) sum of squares, Ceres' convention; what took part at the end
  double sigma0 = 0;
  /// All standard deviations, ellipses and expected errors are multiplied by it: sigma0 where the residuals are far
  /// above the given sigmas, else 1. Never below. As sigma0 is estimated then, 95 % regions are wider still, by Fisher's
  /// distribution instead of the normal one.
  double sigmaScale = 1;
  int redundancy = 0;
  std::vector<AdjustedPose> poses; ///< the start where not converged
  std::vector<RigidTransform> cameraFromBody;  ///< of each mount
  std::vector<MountAccuracy> mountAccuracy;    ///< of each mount; empty without covariance
  std::vector<Intrinsics> cameras;
  std::vector<CameraAccuracy> cameraAccuracy;  ///< of each camera; empty without covariance
  std::vector<double> clockOffsetSecs, clockStdSecs;  ///< of each trajectory
  std::vector<glm::dvec3> points;  ///< NaN where a tie point could not be had
  std::vector<NetworkResidual> residuals;
  std::vector<ResidualGroup> groups;
  std::vector<CheckPoint> checkPoints;
  std::vector<std::string> correlations;  ///< pairs of unknowns that can hardly be told apart, as sentences
  std::vector<std::string> warnings;      ///< duplicates, observations behind the camera, points left out
  std::vector<ExpectedError> expected;    ///< one for each of Options::at

  int outlierCount() const;
  std::string report(const Network& network) const;  ///< a page or two of text
};

/// The camera's pose of a frame after adjustment.
RigidTransform cameraFromWorld(const Network& network, const NetworkSummary& summary, int frame);

/// A line a mount: where it sits on its body, how far it moved, how well it is known.
std::string mountsText(const Network& network, const NetworkSummary& summary);

/// Least squares over all of the network at once: Levenberg-Marquardt on normal equations from which the points are
/// eliminated (Schur complement; Triggs et al., Bundle adjustment, a modern synthesis, 2000), observations made
/// robust by Huber's loss until the outliers are known. Analytic derivatives.
///
/// A network that its observations do not determine is refused: converged false, reason says what is open and what
/// to do. Error for input that makes no sense: non-finite numbers, indices and pictures that do not fit, a frame
/// without pose, a pose without frame.
Result<NetworkSummary> adjustNetwork(const Network& network, const NetworkOptions& options = {},
                                     const Progress& progress = {});

}  // namespace alidade

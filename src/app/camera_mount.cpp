// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/camera_mount.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "geometry/angle.h"
#include "geometry/attitude.h"

namespace alidade {

namespace {

constexpr double kFarthestM = 1000;
constexpr double kRoundingM = 1e-9, kRoundingRad = 1e-12;  ///< figures that only went to the screen and back
/// Photogrammetry's photo axes against the camera's: a half turn about x.
const glm::dquat kPhotoFromCamera(0, 1, 0, 0);

bool isFinite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

RigidTransform bodyPlace(const std::optional<CameraMount>& mount) {
  return mount ? mount->cameraFromBody : RigidTransform::identity();
}

/// The trajectories of the camera's frames; error where one of them serves another camera as well.
Result<std::set<TrajectoryId>> ownTrajectories(const Project& project, const CameraRecord& camera) {
  std::set<TrajectoryId> own;
  for (const Frame& frame : project.frames)
    if (frame.camera == camera.id && frame.trajectory) own.insert(frame.trajectory);
  for (const Frame& frame : project.frames) {
    if (frame.camera == camera.id || !own.contains(frame.trajectory)) continue;
    const Trajectory* trajectory = project.findTrajectory(frame.trajectory);
    return fail(fmt::format("The trajectory '{}' gives the poses of several cameras", trajectory ? trajectory->name : ""), camera.name,
                "Make the project of a rig file, which gives each camera a trajectory of its own: alidade-cli new --rig");
  }
  return own;
}

}  // namespace

MountFigures figuresOf(const CameraMount& mount) {
  const OmegaPhiKappa angles = omegaPhiKappaOf(glm::conjugate(mount.cameraFromBody.rotation) * kPhotoFromCamera);
  return {mount.body, mount.cameraFromBody.centre(), {angles.omega, angles.phi, angles.kappa}, mount.offsetStdM, mount.rotationStdRad};
}

Result<CameraMount> mountOf(const MountFigures& figures) {
  const auto& [body, position, angles, positionStd, anglesStd] = figures;
  if (body.find_first_not_of(" \t") == std::string::npos)
    return fail("The mount names no body", {}, "Name what carries the camera: the sensor whose trajectory is known, or another camera");
  if (!isFinite(position) || !isFinite(angles) || !isFinite(positionStd) || !isFinite(anglesStd))
    return fail("A figure of the mount is no finite number", body, "Give metres and degrees");
  if (glm::length(position) > kFarthestM)
    return fail(fmt::format("The camera would sit {:.0f} m from its body", glm::length(position)), body,
                fmt::format("Give its position in the body's axes, at most {:.0f} m; world coordinates belong into the trajectory", kFarthestM));
  if (glm::any(glm::lessThan(positionStd, glm::dvec3(0))) || glm::any(glm::lessThan(anglesStd, glm::dvec3(0))))
    return fail("A standard deviation is negative", body, "Give 0 where it is not known");
  const glm::dquat bodyFromCamera = worldFromCameraRotation({angles.x, angles.y, angles.z}) * glm::conjugate(kPhotoFromCamera);
  return CameraMount{body, RigidTransform{bodyFromCamera, position}.inverse(), positionStd, anglesStd};
}

Result<int> setMount(Project& project, CameraId id, const std::optional<CameraMount>& mount) {
  CameraRecord* camera = project.findCamera(id);
  if (!camera) return fail("The project has no such camera", project.path, "Add a calibration");
  const bool isOnAnother = mount && camera->mount && mount->body != camera->mount->body;
  const RigidTransform newFromOld = isOnAnother ? RigidTransform::identity() : bodyPlace(mount) * bodyPlace(camera->mount).inverse();
  const glm::dquat& turn = newFromOld.rotation;
  const bool moves = glm::length(newFromOld.translation) > kRoundingM || glm::length(glm::dvec3(turn.x, turn.y, turn.z)) > kRoundingRad;
  int followed = 0;
  if (moves) {
    const auto own = ownTrajectories(project, *camera);
    if (!own) return fail(own.error());
    for (const TrajectoryId& trajectory : *own) {
      Trajectory* its = project.findTrajectory(trajectory);
      if (!its) continue;
      std::vector<PoseSample> samples = its->track.samples();
      for (PoseSample& sample : samples) sample.cameraFromWorld = newFromOld * sample.cameraFromWorld;
      its->track = PoseTrack(std::move(samples));
    }
    // Moved as they are: what a whole sequence's refinement corrected between keyframes stays corrected.
    for (Frame& frame : project.frames) {
      if (!own->contains(frame.trajectory)) continue;
      if (frame.poseSource == PoseSource::Interpolated && frame.cameraFromWorld) frame.cameraFromWorld = newFromOld * *frame.cameraFromWorld, ++followed;
      if (frame.originalCameraFromWorld) frame.originalCameraFromWorld = newFromOld * *frame.originalCameraFromWorld;
    }
  }
  camera->mount = mount;
  return followed;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/jobs.h"
#include "overlay/scan_painter.h"

namespace alidade {

namespace {

/// Occlusion is judged on a picture of at most this width: finer than any scan's spacing supports,
/// and a 20 Mpx photo costs no more than a video frame.
constexpr int kOcclusionWidth = 1920;

}  // namespace

Result<std::vector<ProjectedPoint>> projectPoints(const Project& project, const LoadedData& data, FrameId frameId,
                                                  const std::vector<glm::dvec3>& world) {
  auto description = describeFrame(project, data, frameId, nullptr);
  if (!description) return fail(description.error());
  const Camera& camera = description->camera;
  const double shrink = std::min(1.0, static_cast<double>(kOcclusionWidth) / camera.width());
  const Camera small = camera.scaledTo(static_cast<int>(std::lround(camera.width() * shrink)),
                                       static_cast<int>(std::lround(camera.height() * shrink)));

  DepthImage occlusion;
  if (!description->scans.empty() && project.display.depthPass) {
    description->display.pointPass = false;
    occlusion = ScanPainter().draw(*description, small).depth;
  }

  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<ProjectedPoint> projected;
  projected.reserve(world.size());
  for (const glm::dvec3& p : world) {
    const glm::dvec3 inCamera = description->cameraFromWorld * p;
    ProjectedPoint point{{kNone, kNone}, inCamera.z > 0 ? inCamera.z : kNone, Visibility::Outside};
    if (const auto pixel = camera.project(inCamera)) {
      point.pixel = *pixel;
      if (camera.inPicture(*pixel)) {
        const glm::dvec2 scale(static_cast<double>(small.width()) / camera.width(),
                               static_cast<double>(small.height()) / camera.height());
        const glm::dvec2 onSmall = (*pixel + 0.5) * scale - 0.5;
        point.state = occlusion.empty()
                          ? Visibility::Visible
                          : visibilityAt(occlusion, onSmall, inCamera.z, project.display.depthToleranceM);
      }
    }
    projected.push_back(point);
  }
  return projected;
}

}  // namespace alidade

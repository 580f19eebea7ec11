// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "camera/camera.h"
#include "geometry/bounds.h"
#include "geometry/rigid_transform.h"

namespace alidade {

/// A half-line in world coordinates; direction is unit.
struct ViewRay {
  glm::dvec3 origin{0};
  glm::dvec3 direction{0, 0, 1};
};

/// The eye of the 3D view, in double world metres: a perspective camera moved with the mouse. No
/// graphics in it. Pixels count from the top-left corner of the picture.
class ViewCamera {
 public:
  void resize(int widthPx, int heightPx);
  int width() const { return m_width; }
  int height() const { return m_height; }

  const glm::dvec3& position() const { return m_position; }
  glm::dvec3 forward() const { return m_worldFromView * glm::dvec3(0, 0, -1); }
  glm::dvec3 up() const { return m_worldFromView * glm::dvec3(0, 1, 0); }
  glm::dvec3 right() const { return m_worldFromView * glm::dvec3(1, 0, 0); }
  double verticalFov() const { return m_verticalFov; }  ///< radians

  ViewRay rayThrough(const glm::dvec2& px) const;
  /// Pixel and depth along the view axis in metres; nothing at or behind the eye.
  std::optional<glm::dvec3> project(const glm::dvec3& world) const;
  double depthOf(const glm::dvec3& world) const;
  /// The same view as a lens without distortion, whose pixels count from the centre of the first.
  Camera pinhole() const;
  RigidTransform cameraFromWorld() const;
  /// Metres that one pixel spans at this depth.
  double metresPerPixel(double depth) const;

  /// Looks at the whole box from the south-east and above, level.
  void fit(const Bounds& bounds);
  /// Stands at `position`; at least the given angles (radians) are in the picture.
  void lookFrom(const glm::dvec3& position, const glm::dvec3& forward, const glm::dvec3& up, double horizontalFov,
                double verticalFov);
  /// Turns about the pivot: left-right about the world's vertical, up-down about the view's right.
  void orbit(const glm::dvec3& pivot, const glm::dvec2& deltaPx);
  /// Moves so that `grabbed` follows the cursor.
  void pan(const glm::dvec3& grabbed, const glm::dvec2& deltaPx);
  /// Comes `factor` times nearer to `target`, which keeps its place in the picture.
  void zoomTowards(const glm::dvec3& target, double factor);

  friend bool operator==(const ViewCamera&, const ViewCamera&) = default;

 private:
  double focalPx() const;

  glm::dvec3 m_position{0, -10, 5};
  glm::dquat m_worldFromView{1, 0, 0, 0};  // view axes: x right, y up, looking along -z
  double m_verticalFov = 0.7;
  int m_width = 640, m_height = 480;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "camera/camera.h"
#include "geometry/rigid_transform.h"
#include "simulate/lighting.h"

namespace alidade {

/// What a frame truly shows, at the centre of each pixel.
struct FrameTruth {
  DepthImage depth;                ///< of the site as built; metres along the optical axis, +inf for sky
  DepthImage designDepth;          ///< of the design; +inf where none
  Image<std::uint8_t> visibility;  ///< 0 no design, 1 visible, 2 hidden
};

/// A design point counts as hidden when the site as built stands more than this before it, metres along the
/// optical axis.
constexpr double kHiddenTolerance = 0.02;

/// Draws frames by casting rays through the camera's own lens. One ray at each pixel's centre gives the truth
/// and the colour; pixels on an edge get more. Then vignetting, shot noise and read noise.
class FrameRenderer {
 public:
  FrameRenderer(const Camera& camera, const RayScene& asBuilt, const RayScene& design,
                const Lighting& lighting, std::uint32_t seed, bool colour);

  /// `cameraFromSite`: one pose, or one for each row of a rolling shutter.
  ColourImage render(const std::vector<RigidTransform>& cameraFromSite, int frame, FrameTruth& truth) const;

 private:
  struct Sample;

  Sample trace(const glm::dvec3& origin, const glm::dmat3& siteFromCamera, const glm::dvec3& direction) const;
  void traceCentres(const std::vector<RigidTransform>& siteFromCamera, Image<Sample>& samples, FrameTruth& truth) const;
  /// How many more rays each pixel wants: 4 on edges of things and shadows, 2 on strong texture.
  Image<std::uint8_t> findEdges(const Image<Sample>& samples) const;
  Rgba8 develop(const glm::vec3& radiance, int x, int y, int frame) const;
  /// Direction (x, y, 1) that a place of the picture sees, between its neighbours' centres.
  glm::dvec3 directionAt(double x, double y) const;

  Camera m_camera;
  const RayScene& m_asBuilt;
  const RayScene& m_design;
  const Lighting& m_lighting;
  std::uint32_t m_seed;
  bool m_colour;
  float m_pixelAngle;
  Image<glm::dvec2>
      m_centres;  ///< (x, y) of (x, y, 1) at each pixel's centre; NaN where the lens sees nothing
};

}  // namespace alidade

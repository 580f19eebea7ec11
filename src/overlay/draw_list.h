// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "base/image.h"
#include "camera/camera.h"
#include "overlay/element_shape.h"
#include "overlay/frame_description.h"

namespace alidade {

/// A design surface vertex after subdivision, in camera axes (metres, float relative to the camera).
/// The device distorts and projects it.
struct SurfaceVertex {
  glm::vec3 pInCamera;
  glm::vec3 normal;           ///< camera axes, unit, of the face
  std::uint32_t element = 0;  ///< 1 + index over all layers' elements
};

struct EdgeVertex {
  glm::vec3 pInCamera;
  std::uint32_t element = 0;
  float along = 0;  ///< metres from the edge's start, for dashes
};

/// Look of one element; index as in SurfaceVertex::element - 1.
struct ElementStyle {
  glm::vec4 colour{0.8f, 0.8f, 0.8f, 1.0f};  ///< a: opacity of visible faces
  std::uint32_t selected = 0;
  std::uint32_t edgesAlone = 0;  ///< 1 where it has no faces, so that its edges carry its pixels
  Winding winding = Winding::Open;
  std::uint32_t hiddenRank = 0;  ///< see element_shape.h
};

/// What a device draws: subdivided camera-space geometry beside the pictures from raster/. Made by
/// buildDrawList from a FrameDescription, so that no device knows the world, the survey or a lens bound.
struct DrawList {
  int width = 0, height = 0;
  Camera camera;                             ///< scaled to width × height
  const ColourImage* image = nullptr;        ///< any size; stretched to the result
  const DepthImage* scanDepth = nullptr;     ///< width × height; null: nothing hides
  const ColourImage* pointColour = nullptr;  ///< width × height; null: pass off
  std::vector<SurfaceVertex> surface;        ///< indexed by `triangles`
  std::vector<std::uint32_t> triangles;
  std::vector<EdgeVertex> edges;  ///< pairs
  std::vector<ElementStyle> styles;
  glm::vec3 lightDirection{0, 0, 1};  ///< camera axes, unit, the way light travels
  DisplaySettings display;
  double worstErrorPx = 0;
  double lensRadius = 0;   ///< of the lens's domain on the image plane, see LensError
  bool lensFolds = false;  ///< it ends within the picture's reach, so that pixels must be held to it
};

/// Culls against the lens's mask, subdivides triangles and edges by need (a bound in pixels per edge,
/// equal on both sides of a shared edge, so neighbours never crack), clips at the near plane.
DrawList buildDrawList(const FrameDescription& frame, const Camera& scaledCamera);

}  // namespace alidade

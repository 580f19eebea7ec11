// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>

#include <glm/glm.hpp>

#include "camera/lens_uniform.h"
#include "overlay/draw_list.h"

namespace alidade {

/// The std140 block `FrameBlock` of resources/shaders/overlay_frame.glsl, member by member.
struct FrameUniform {
  LensUniform lens;
  glm::vec4 light;    ///< direction of travel in camera axes; ambient
  glm::vec4 shading;  ///< diffuse, specular, shininess, opacity of visible faces
  glm::vec4 picture;  ///< 1: image there, 1: image gray, 1: design gray, 1: image of the result's size
  glm::vec4 scan;     ///< 1: the scan hides, tolerance (m), hidden style, 1: point pass
  glm::vec4 lines;    ///< half width of edge and casing (px), pattern scale, 1: edges
  glm::vec4 view;     ///< near plane (m), 1: faces, depth slack of edges, pixels of a metre at depth 1 m
  glm::vec4 hidden;   ///< 1: there is a hidden layer; unused
};
static_assert(offsetof(FrameUniform, light) == 176);
static_assert(offsetof(FrameUniform, shading) == 192);
static_assert(offsetof(FrameUniform, picture) == 208);
static_assert(offsetof(FrameUniform, scan) == 224);
static_assert(offsetof(FrameUniform, lines) == 240);
static_assert(offsetof(FrameUniform, view) == 256);
static_assert(offsetof(FrameUniform, hidden) == 272);
static_assert(sizeof(FrameUniform) == 288);

/// The std430 entry of `StyleBlock` there.
struct StyleUniform {
  glm::vec4 colour;
  glm::uvec4 flags;  ///< selected, edges alone, winding, hidden rank
};
static_assert(sizeof(StyleUniform) == 32);
static_assert(sizeof(SurfaceVertex) == 28 && offsetof(SurfaceVertex, normal) == 12);
static_assert(sizeof(EdgeVertex) == 20 && offsetof(EdgeVertex, element) == 12 &&
              offsetof(EdgeVertex, along) == 16);

/// Lines and patterns keep their size on a 1080-line picture and grow with larger ones. `enlargement` as in FrameDescription.
double drawingScale(int width, int height, double enlargement = 1);

/// Whether the edge pass runs at all.
inline bool drawsEdges(const DrawList& list) {
  return list.display.designEdges && list.display.designPass && !list.edges.empty();
}

/// Whether what the scan hides behind visible design is looked for.
inline bool drawsHiddenLayer(const DrawList& list) {
  return list.scanDepth != nullptr && list.display.designPass && !list.triangles.empty();
}

FrameUniform frameUniform(const DrawList& list);

}  // namespace alidade

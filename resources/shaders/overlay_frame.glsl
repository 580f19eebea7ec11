// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What all overlay passes share: the frame's uniform block (src/overlay/frame_uniform.h member by
// member), the styles of the elements and the law of what the scan hides.

#ifndef ALIDADE_OVERLAY_FRAME_GLSL
#define ALIDADE_OVERLAY_FRAME_GLSL

#include "distortion.glsl"

layout(std140, set = 0, binding = 0) uniform FrameBlock {
  LensUniform lens;
  vec4 light;    // direction of travel in camera axes; ambient
  vec4 shading;  // diffuse, specular, shininess, opacity of visible faces
  vec4 picture;  // 1 where there is an image, 1: image gray, 1: design gray, 1 where image and result agree in size
  vec4 scan;     // 1 where the scan hides, tolerance in metres, hidden style, 1: point pass
  vec4 lines;    // half width of an edge and of its casing in pixels, pattern scale, 1: edges
  vec4 view;     // near plane in metres, 1: faces, depth slack of edges, pixels of a metre at depth 1 m
  vec4 hidden;   // 1: there is a hidden layer, unused, unused, unused
} frame;

struct ElementStyle {
  vec4 colour;     // a: opacity
  // 1: selected, 1: has edges alone, winding (0 open, 1 normals outwards, 2 inwards), hidden rank
  uvec4 flags;
};

layout(std430, set = 0, binding = 1) readonly buffer StyleBlock { ElementStyle styles[]; };

// Visibility of raster/occlusion.h.
const uint stateVisible = 0u;
const uint stateHidden = 1u;
const uint stateUnknown = 2u;
const uint stateOutside = 3u;

const float hiddenHide = 0.0;
const float hiddenGhost = 1.0;
const float hiddenDash = 2.0;

const vec3 selectionColour = vec3(1.0, 0.55, 0.05);

// The scan's depth: < 0 where unknown, infinite where it sees through. The same law as visibilityAt().
uint stateOf(float z, float scanDepth) {
  if (frame.scan.x < 0.5) return stateVisible;
  if (scanDepth < 0.0) return stateUnknown;
  return z <= scanDepth + frame.scan.y + 0.0005 * z ? stateVisible : stateHidden;
}

// A pixel of the front design layer in a byte: what the scan says in the low bits, above them a mark that
// tells neighbouring elements apart (not all elements); 0 where there is no design. Hidden by no more than
// thrice the tolerance is told apart: it is reported as hidden, but does not decide how others are drawn.
const uint barelyHidden = 3u;

uint keyOf(uint element, float z, float scanDepth) {
  uint state = stateOf(z, scanDepth);
  bool isBarely = stateOf(z - 2.0 * frame.scan.y, scanDepth) == stateVisible;
  if (state == stateHidden && isBarely) state = barelyHidden;
  return state | ((1u + element % 63u) << 2);
}
uint stateOfKey(uint key) {
  uint state = key & 3u;
  return key == 0u ? stateOutside : (state == barelyHidden ? stateHidden : state);
}

float luminance(vec3 c) { return dot(c, vec3(0.299, 0.587, 0.114)); }

// Camera axes to clip space through the lens, w = z: attributes are interpolated perspective-correctly
// although the position is bent. Depth is reversed, near / z.
vec4 clipPosition(vec2 pixel, float z) {
  vec2 ndc = 2.0 * (pixel + 0.5) / frame.lens.domain.zw - 1.0;
  return vec4(ndc * z, frame.view.x, z);
}

vec2 pixelOf(vec3 pInCamera) {
  return pixelOfDistorted(distortPoint(pInCamera.xy / pInCamera.z, frame.lens), frame.lens);
}

#endif

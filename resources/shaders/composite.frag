#version 460
// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Puts the picture together, once a pixel: camera image, design faces as visible, hidden or unknown, design
// edges, the scan's points. Hidden and unknown differ in shape, not in colour alone.

#extension GL_GOOGLE_include_directive : require
#include "overlay_frame.glsl"

layout(set = 0, binding = 2) uniform sampler2D image;
layout(set = 0, binding = 3) uniform sampler2D scanDepth;
layout(set = 0, binding = 4) uniform sampler2D points;
layout(set = 0, binding = 5) uniform sampler2D faceColour;
layout(set = 0, binding = 6) uniform usampler2D faceElement;
layout(set = 0, binding = 7) uniform sampler2D faceDepth;
layout(set = 0, binding = 8) uniform sampler2D edgeCover;
layout(set = 0, binding = 9) uniform usampler2D edgeElement;
layout(set = 0, binding = 10) uniform sampler2D edgeDepth;

layout(location = 0) out vec4 outColour;
layout(location = 1) out uint outElement;
layout(location = 2) out float outDepth;
layout(location = 3) out uint outState;

const vec3 groundColour = vec3(0.11, 0.12, 0.14);

vec3 cameraImage(ivec2 at) {
  if (frame.picture.x < 0.5) return groundColour;
  vec3 c = frame.picture.w > 0.5 ? texelFetch(image, at, 0).rgb
                                 : textureLod(image, gl_FragCoord.xy / frame.lens.domain.zw, 0.0).rgb;
  return frame.picture.y > 0.5 ? vec3(luminance(c)) : c;
}

// 1 on the stripes of a hatch that rises to the right.
float hatch(vec2 at, float period, float drawn) {
  return fract((at.x + at.y) / (period * frame.lines.z)) < drawn ? 1.0 : 0.0;
}

// 1 on dots in staggered rows.
float dots(vec2 at, float period) {
  vec2 cell = at / (period * frame.lines.z);
  cell.x += 0.5 * mod(floor(cell.y), 2.0);
  vec2 d = fract(cell) - 0.5;
  return dot(d, d) < 0.06 ? 1.0 : 0.0;
}

vec3 overFace(vec3 under, vec4 face, uint state) {
  vec3 c = frame.picture.z > 0.5 ? vec3(luminance(face.rgb)) : face.rgb;
  float opacity = face.a;
  if (state == stateUnknown) {
    float dot = dots(gl_FragCoord.xy, 7.0);
    opacity *= mix(0.16, 0.9, dot);
    c = mix(c, vec3(luminance(c)), 0.4);
  } else if (state == stateHidden) {
    if (frame.scan.z == hiddenHide) return under;
    if (frame.scan.z == hiddenGhost) {
      c = mix(c, vec3(luminance(c)), 0.7);
      opacity *= 0.3;
    } else {
      opacity *= mix(0.08, 0.85, hatch(gl_FragCoord.xy, 9.0, 0.25));
    }
  }
  return mix(under, c, opacity);
}

vec3 overEdge(vec3 under, vec2 cover, uint element) {
  ElementStyle style = styles[element - 1u];
  bool selected = style.flags.x != 0u;
  vec3 line = selected ? selectionColour : 0.42 * style.colour.rgb;
  if (frame.picture.z > 0.5 && !selected) line = vec3(luminance(line));
  vec3 c = mix(under, vec3(selected ? 1.0 : 0.93), cover.y);
  return mix(c, line, cover.x);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 colour = cameraImage(at);
  float scanned = texelFetch(scanDepth, at, 0).r;
  uint element = texelFetch(faceElement, at, 0).r;
  float depth = texelFetch(faceDepth, at, 0).r;
  uint state = stateOutside;
  if (element != 0u) {
    state = stateOf(depth, scanned);
    if (frame.view.y > 0.5) colour = overFace(colour, texelFetch(faceColour, at, 0), state);
  }
  vec2 cover = frame.lines.w > 0.5 ? texelFetch(edgeCover, at, 0).rg : vec2(0.0);
  if (cover.y > 0.0) {
    uint owner = texelFetch(edgeElement, at, 0).r;
    colour = overEdge(colour, cover, owner);
    if (element == 0u && styles[owner - 1u].flags.y != 0u) {
      element = owner;
      depth = texelFetch(edgeDepth, at, 0).r;
      state = stateOf(depth, scanned);
    }
  }
  if (frame.scan.w > 0.5) {
    vec4 point = texelFetch(points, at, 0);
    if (point.a > 0.0) colour = mix(colour, point.rgb, 0.5);
  }
  outColour = vec4(colour, 1.0);
  outElement = element;
  outDepth = depth;
  outState = state;
}

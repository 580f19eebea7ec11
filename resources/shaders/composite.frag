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
layout(set = 0, binding = 8) uniform usampler2D faceKey;
layout(set = 0, binding = 9) uniform usampler2D hiddenElement;
layout(set = 0, binding = 10) uniform sampler2D edgeCover;
layout(set = 0, binding = 11) uniform usampler2D edgeElement;
layout(set = 0, binding = 12) uniform sampler2D edgeDepth;

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

vec3 designColour(vec3 c) { return frame.picture.z > 0.5 ? vec3(luminance(c)) : c; }

// Adds what the scan says of the same element at eight pixels: the corners or the sides of a square, 2 r wide.
uvec4 votesAround(ivec2 at, uint mine, int r) {
  ivec2 last = ivec2(frame.lens.domain.zw) - 1;
  uvec4 votes = uvec4(0u);
  for (int i = 0; i < 9; ++i) {
    if (i == 4) continue;
    uint other = texelFetch(faceKey, clamp(at + r * ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last), 0).r;
    if ((other >> 2) == mine) ++votes[other & 3u];
  }
  return votes;
}

// What a pixel of the front layer is drawn as: its own state, but for specks, where the scan's noise spoke.
// They follow what most of the same element is around them. What is seen or hidden in more than a speck
// stays, so that thin things stay in front; what is unknown or barely hidden always follows.
uint drawnState(ivec2 at, uint key) {
  uint own = key & 3u, mine = key >> 2;
  ivec2 last = ivec2(frame.lens.domain.zw) - 1;
  bool isCalm = own != barelyHidden;
  for (int i = 0; i < 4 && isCalm; ++i) {
    ivec2 side = (i & 1) != 0 ? ivec2(1, 0) : ivec2(0, 1);
    uint other = texelFetch(faceKey, clamp(at + ((i & 2) != 0 ? side : -side), ivec2(0), last), 0).r;
    isCalm = other == key || (other >> 2) != mine;
  }
  if (isCalm && own != stateUnknown) return own;
  uvec4 votes = votesAround(at, mine, 1);
  if (own == stateVisible && votes.x > 2u) return own;
  if (own == stateHidden && votes.y + votes.w > 3u) return own;
  votes += votesAround(at, mine, 3) + votesAround(at, mine, 5);
  uint count = votes.x + votes.y + votes.z;
  for (uint other = 0u; other < 3u; ++other)
    if (2u * votes[other] > count) return other;
  return own == barelyHidden ? stateHidden : own;
}

vec3 overFace(vec3 under, vec4 face, uint state) {
  vec3 c = designColour(face.rgb);
  float opacity = face.a;
  if (state == stateUnknown) {
    opacity *= mix(0.14, 0.55, dots(gl_FragCoord.xy, 7.0));
    c = mix(c, vec3(luminance(c)), 0.4);
  }
  return mix(under, c, opacity);
}

// A face that the scan hides, over whatever is seen: so faint that the picture stays readable.
vec3 overHidden(vec3 under, uint element, bool isThrough) {
  if (frame.scan.z == hiddenHide) return under;
  ElementStyle style = styles[element - 1u];
  vec3 c = style.flags.x != 0u ? selectionColour : designColour(style.colour.rgb);
  float opacity = style.flags.x != 0u ? 0.3 : 0.12;
  // Through a visible face the outline speaks; the hatch only tells which side of it is meant.
  if (frame.scan.z == hiddenDash)
    opacity *= isThrough ? 1.2 * hatch(gl_FragCoord.xy, 14.0, 0.12) : 3.0 * hatch(gl_FragCoord.xy, 9.0, 0.22);
  return mix(under, c, opacity * style.colour.a);
}

// Where the hidden layer's element ends, not counting ends that the front layer makes. Of two elements
// that meet there, the one of higher rank is outlined.
bool isOutline(ivec2 at, uint element) {
  ivec2 last = ivec2(frame.lens.domain.zw) - 1;
  for (int i = 0; i < 4; ++i) {
    ivec2 side = (i & 1) != 0 ? ivec2(1, 0) : ivec2(0, 1);
    ivec2 near = clamp(at + ((i & 2) != 0 ? side : -side), ivec2(0), last);
    uint other = texelFetch(hiddenElement, near, 0).r;
    if (other == element || stateOfKey(texelFetch(faceKey, near, 0).r) != stateVisible) continue;
    if (texelFetch(faceElement, near, 0).r == element) continue;
    if (other == 0u || styles[other - 1u].flags.w < styles[element - 1u].flags.w) return true;
  }
  return false;
}

// 1 on the drawn part of an outline: cells of a chequerboard, which dash a line of any direction.
float chequer(float size) {
  vec2 cell = floor(gl_FragCoord.xy / (size * frame.lines.z));
  return mod(cell.x + cell.y, 2.0);
}

vec3 overOutline(vec3 under, uint element) {
  if (frame.scan.z == hiddenHide || frame.lines.w < 0.5) return under;
  ElementStyle style = styles[element - 1u];
  vec3 c = style.flags.x != 0u ? selectionColour : designColour(style.colour.rgb);
  return mix(under, c, frame.scan.z == hiddenDash ? 0.8 * chequer(6.0) : 0.5);
}

vec3 overEdge(vec3 under, vec2 cover, uint element) {
  ElementStyle style = styles[element - 1u];
  bool selected = style.flags.x != 0u;
  vec3 line = selected ? selectionColour : designColour(0.42 * style.colour.rgb);
  vec3 c = mix(under, vec3(selected ? 1.0 : 0.93), cover.y);
  return mix(c, line, cover.x);
}

vec3 overHiddenEdge(vec3 under, vec2 cover, uint element) {
  ElementStyle style = styles[element - 1u];
  bool selected = style.flags.x != 0u;
  vec3 line = selected ? selectionColour : designColour(mix(style.colour.rgb, vec3(1.0), 0.3));
  vec3 c = mix(under, vec3(0.1), cover.y);
  return mix(c, line, cover.x);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 colour = cameraImage(at);
  uint key = texelFetch(faceKey, at, 0).r;
  uint element = 0u, state = stateOutside;
  float depth = texelFetch(faceDepth, at, 0).r;
  if (key != 0u) {
    element = texelFetch(faceElement, at, 0).r;
    state = stateOfKey(key);
    if (frame.view.y > 0.5) {
      uint drawn = frame.scan.x > 0.5 ? drawnState(at, key) : state;
      uint behind = drawn == stateHidden ? element : 0u;
      if (drawn != stateHidden) colour = overFace(colour, texelFetch(faceColour, at, 0), drawn);
      bool isThrough = frame.hidden.x > 0.5 && state == stateVisible;
      if (isThrough) behind = texelFetch(hiddenElement, at, 0).r;
      if (behind != 0u) colour = overHidden(colour, behind, isThrough);
      if (isThrough && behind != 0u && isOutline(at, behind)) colour = overOutline(colour, behind);
    }
  }
  vec4 cover = frame.lines.w > 0.5 ? texelFetch(edgeCover, at, 0) : vec4(0.0);
  if (cover.y > 0.0 || cover.w > 0.0) {
    uint owner = texelFetch(edgeElement, at, 0).r;
    if (cover.w > 0.0) colour = overHiddenEdge(colour, cover.zw, owner);
    if (cover.y > 0.0) colour = overEdge(colour, cover.xy, owner);
    if (element == 0u && styles[owner - 1u].flags.y != 0u) {
      element = owner;
      depth = texelFetch(edgeDepth, at, 0).r;
      state = stateOf(depth, texelFetch(scanDepth, at, 0).r);
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

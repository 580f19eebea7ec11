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

// Drivers on the CPU run both sides of every branch, for several pixels at a time, but leave a loop that no
// pixel needs: rare work stands in loops with a bound of zero where it is not wanted.

// Adds what the scan says of the same element at the corners and sides of squares 2, 6 and 10 pixels wide.
uvec4 votesAround(ivec2 at, uint mine, int first, int end) {
  ivec2 last = ivec2(frame.lens.domain.zw) - 1;
  uvec4 votes = uvec4(0u);
  for (int i = first; i < end; ++i) {
    int k = i & 7;
    k += k >> 2;  // 0 to 8 without the middle
    ivec2 side = (2 * (i >> 3) + 1) * ivec2(k % 3 - 1, k / 3 - 1);
    uint other = texelFetch(faceKey, clamp(at + side, ivec2(0), last), 0).r;
    if ((other >> 2) == mine) votes += uvec4(equal(uvec4(0u, 1u, 2u, 3u), uvec4(other & 3u)));
  }
  return votes;
}

// What a pixel of the front layer is drawn as: its own state, but for specks, where the scan's noise spoke.
// They follow what most of the same element is around them. What is seen or hidden in more than a speck
// stays, so that thin things stay in front; what is unknown or barely hidden always follows.
uint drawnState(ivec2 at, uint key) {
  uint own = key & 3u, mine = key >> 2;
  ivec2 last = ivec2(frame.lens.domain.zw) - 1;
  bool isCalm = own == stateVisible || own == stateHidden;
  for (int i = 0; i < 2; ++i) {
    ivec2 side = i != 0 ? ivec2(1, 0) : ivec2(0, 1);
    uint before = texelFetch(faceKey, clamp(at - side, ivec2(0), last), 0).r;
    uint after = texelFetch(faceKey, clamp(at + side, ivec2(0), last), 0).r;
    isCalm = isCalm && (before == key || (before >> 2) != mine) && (after == key || (after >> 2) != mine);
  }
  bool isOpen = !isCalm && key != 0u && frame.scan.x > 0.5;
  uvec4 votes = votesAround(at, mine, 0, isOpen ? 8 : 0);
  if (own == stateVisible && votes.x > 2u) isOpen = false;
  if (own == stateHidden && votes.y + votes.w > 3u) isOpen = false;
  votes += votesAround(at, mine, 8, isOpen ? 24 : 8);
  uint count = votes.x + votes.y + votes.z;
  uint drawn = own == barelyHidden ? stateHidden : own;
  if (isOpen && 2u * votes.x > count) drawn = stateVisible;
  if (isOpen && 2u * votes.y > count) drawn = stateHidden;
  if (isOpen && 2u * votes.z > count) drawn = stateUnknown;
  return drawn;
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
vec3 overHidden(vec3 under, ElementStyle style, bool isThrough) {
  if (frame.scan.z == hiddenHide) return under;
  vec3 c = style.flags.x != 0u ? selectionColour : designColour(style.colour.rgb);
  float opacity = style.flags.x != 0u ? 0.3 : 0.12;
  // Through a visible face the outline speaks; the hatch only tells which side of it is meant.
  if (frame.scan.z == hiddenDash)
    opacity *= isThrough ? 1.2 * hatch(gl_FragCoord.xy, 14.0, 0.12) : 3.0 * hatch(gl_FragCoord.xy, 9.0, 0.22);
  return mix(under, c, opacity * style.colour.a);
}

// Where the hidden layer's element ends, not counting ends that the front layer makes. Of two elements
// that meet there, the one of higher rank is outlined.
bool isOutline(ivec2 at, uint element, uint rank) {
  ivec2 last = ivec2(frame.lens.domain.zw) - 1;
  bool isInside = true;
  for (int i = element != 0u ? 0 : 4; i < 4; ++i) {
    ivec2 side = ((i & 2) != 0 ? 1 : -1) * ivec2(i & 1, ~i & 1);
    isInside = isInside && texelFetch(hiddenElement, clamp(at + side, ivec2(0), last), 0).r == element;
  }
  bool isOutside = false;
  for (int i = isInside ? 4 : 0; i < 4; ++i) {
    ivec2 near = clamp(at + ((i & 2) != 0 ? 1 : -1) * ivec2(i & 1, ~i & 1), ivec2(0), last);
    uint other = texelFetch(hiddenElement, near, 0).r;
    bool endsHere = other == 0u || styles[max(other, 1u) - 1u].flags.w < rank;
    endsHere = endsHere && stateOfKey(texelFetch(faceKey, near, 0).r) == stateVisible;
    isOutside = isOutside || (endsHere && other != element && texelFetch(faceElement, near, 0).r != element);
  }
  return isOutside;
}

// 1 on the drawn part of an outline: cells of a chequerboard, which dash a line of any direction.
float chequer(float size) {
  vec2 cell = floor(gl_FragCoord.xy / (size * frame.lines.z));
  return mod(cell.x + cell.y, 2.0);
}

vec3 overOutline(vec3 under, ElementStyle style) {
  if (frame.scan.z == hiddenHide || frame.lines.w < 0.5) return under;
  vec3 c = style.flags.x != 0u ? selectionColour : designColour(style.colour.rgb);
  return mix(under, c, frame.scan.z == hiddenDash ? 0.8 * chequer(6.0) : 0.5);
}

vec3 overEdge(vec3 under, vec2 cover, ElementStyle style) {
  bool selected = style.flags.x != 0u;
  vec3 line = selected ? selectionColour : designColour(0.42 * style.colour.rgb);
  vec3 c = mix(under, vec3(selected ? 1.0 : 0.93), cover.y);
  return mix(c, line, cover.x);
}

vec3 overHiddenEdge(vec3 under, vec2 cover, ElementStyle style) {
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
      uint drawn = drawnState(at, key);
      uint behind = drawn == stateHidden ? element : 0u;
      if (drawn != stateHidden) colour = overFace(colour, texelFetch(faceColour, at, 0), drawn);
      bool isThrough = frame.hidden.x > 0.5 && state == stateVisible;
      if (isThrough) behind = texelFetch(hiddenElement, at, 0).r;
      for (int i = behind != 0u ? 0 : 1; i < 1; ++i) {
        ElementStyle style = styles[behind - 1u];
        colour = overHidden(colour, style, isThrough);
        if (isOutline(at, isThrough ? behind : 0u, style.flags.w)) colour = overOutline(colour, style);
      }
    }
  }
  vec4 cover = frame.lines.w > 0.5 ? texelFetch(edgeCover, at, 0) : vec4(0.0);
  for (int i = cover.y > 0.0 || cover.w > 0.0 ? 0 : 1; i < 1; ++i) {
    uint owner = texelFetch(edgeElement, at, 0).r;
    ElementStyle style = styles[owner - 1u];
    if (cover.w > 0.0) colour = overHiddenEdge(colour, cover.zw, style);
    if (cover.y > 0.0) colour = overEdge(colour, cover.xy, style);
    if (element == 0u && style.flags.y != 0u) {
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

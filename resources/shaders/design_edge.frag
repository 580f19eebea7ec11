#version 460
// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// How much of a pixel an edge's line and its casing cover, by state: what is seen or unknown apart from
// what is hidden. Blended by maximum, so that the pieces of a bent edge join without a seam.

#extension GL_GOOGLE_include_directive : require
#include "overlay_frame.glsl"

// 0: edges in front of all faces. 1: edges of the hidden layer.
layout(constant_id = 0) const uint isBehindLayer = 0u;

layout(set = 0, binding = 3) uniform sampler2D scanDepth;
layout(set = 0, binding = 4) uniform sampler2D faceDepth;
layout(set = 0, binding = 5) uniform usampler2D faceKey;
layout(set = 0, binding = 6) uniform usampler2D faceElement;
layout(set = 0, binding = 7) uniform sampler2D hiddenDepth;
layout(set = 0, binding = 8) uniform usampler2D hiddenElement;

layout(location = 0) noperspective in float across;
layout(location = 1) in float along;
layout(location = 2) in float depth;
layout(location = 3) flat in uint element;
layout(location = 4) flat in vec2 sideways;

layout(location = 0) out vec4 outCover;  // line and casing where visible or unknown, then where hidden
layout(location = 1) out uint outElement;
layout(location = 2) out float outDepth;

// 1 on the drawn part of a dash of about `pixels`: metres doubled or halved to fit the distance, so that
// dashes stay tied to the edge while the camera moves.
float dashed(float pixels, float drawn) {
  float metres = pixels * depth / frame.view.w;
  float period = exp2(round(log2(max(metres, 1e-6))));
  return fract(along / period) < drawn ? 1.0 : 0.0;
}

ivec2 clampedToPicture(ivec2 at) { return clamp(at, ivec2(0), ivec2(frame.lens.domain.zw) - 1); }

// An edge is in front where one of the four pixels about the line itself shows a face that is not nearer.
// On the face that it bounds, however steep, one of them always is; a bias that did the same would
// push that face behind others.
bool isBehindFaces() {
  vec2 line = gl_FragCoord.xy - across * sideways - 0.5;
  ivec2 low = ivec2(floor(line));
  float farthest = 0.0;
  for (int i = 0; i < 4; ++i)
    farthest = max(farthest, texelFetch(faceDepth, clampedToPicture(low + ivec2(i & 1, i >> 1)), 0).r);
  return depth > farthest * frame.view.z;
}

// An edge is where the scan's depth jumps and its noise decides: what is drawn follows the faces that it
// bounds, judged aside of the line and along it, in doubt for what is seen. Only an edge of no face asks
// the scan itself.
uint smoothState(bool isWanted) {
  vec2 line = gl_FragCoord.xy - across * sideways;
  vec2 forwards = vec2(sideways.y, -sideways.x);
  uint mine = 1u + element % 63u;
  uvec4 votes = uvec4(0u);
  // The four nearest pixels mostly agree; no pixel of this run needs more then. See composite.frag on loops.
  for (int i = isWanted && frame.scan.x > 0.5 ? 0 : 8; i < 8; ++i) {
    bool isSettled = votes.w == 0u && max(max(votes.x, votes.y), votes.z) == votes.x + votes.y + votes.z;
    if (i == 4 && isSettled && votes.x + votes.y + votes.z >= 2u) break;
    float side = ((i & 1) != 0 ? 1.0 : -1.0) * (i < 4 ? 2.0 : 5.0);
    float ahead = ((i & 2) != 0 ? 1.0 : -1.0) * (i < 4 ? 1.0 : 3.0);
    vec2 at = line + frame.lines.z * (side * sideways + 3.0 * ahead * forwards);
    uint key = texelFetch(faceKey, clampedToPicture(ivec2(at)), 0).r;
    if ((key >> 2) == mine) votes += uvec4(equal(uvec4(0u, 1u, 2u, 3u), uvec4(key & 3u)));
  }
  uint count = votes.x + votes.y + votes.z;
  if (count + votes.w == 0u)
    return stateOf(depth - frame.scan.y, texelFetch(scanDepth, clampedToPicture(ivec2(line)), 0).r);
  if (count == 0u) return stateHidden;
  if (3u * votes.x >= count) return stateVisible;
  return votes.y >= votes.z ? stateHidden : stateUnknown;
}

// Where the hidden layer shows the edge's own element, and none of its faces before the edge.
bool boundsHiddenLayer() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  bool isThrough = stateOfKey(texelFetch(faceKey, at, 0).r) == stateVisible;
  ivec2 low = ivec2(floor(gl_FragCoord.xy - across * sideways - 0.5));
  float farthest = 0.0;
  for (int i = isThrough ? 0 : 4; i < 4; ++i) {
    ivec2 near = clampedToPicture(low + ivec2(i & 1, i >> 1));
    if (texelFetch(hiddenElement, near, 0).r == element)
      farthest = max(farthest, texelFetch(hiddenDepth, near, 0).r);
  }
  return depth <= farthest * frame.view.z && texelFetch(faceElement, at, 0).r != element;
}

void main() {
  uint state = stateHidden;
  if (isBehindLayer != 0u) {
    if (!boundsHiddenLayer()) discard;
  } else {
    bool isBehind = isBehindFaces();
    if (isBehind) discard;
    state = smoothState(!isBehind);
  }
  float strength = 1.0, casing = 0.5;
  float halfWidth = frame.lines.x, halfCasing = frame.lines.y;
  if (state == stateUnknown) {
    strength = 0.6 * dashed(6.0 * frame.lines.z, 0.45);
    casing = 0.3 * strength;
  } else if (state == stateHidden) {
    if (frame.scan.z == hiddenDash) strength = 0.8 * dashed(16.0 * frame.lines.z, 0.55);
    if (frame.scan.z == hiddenGhost) strength = 0.6;
    if (frame.scan.z == hiddenHide) strength = 0.0;
    casing = 0.35 * strength;
    halfWidth *= 0.75;
    halfCasing *= 0.85;
  }
  float distance = abs(across);
  // A trace stays where nothing is drawn, so that what has edges alone can still be picked and counted.
  casing = max(casing, 0.005);
  vec2 cover = vec2(strength * clamp(halfWidth + 0.5 - distance, 0.0, 1.0),
                    casing * clamp(halfCasing + 0.5 - distance, 0.0, 1.0));
  if (cover.y <= 0.0) discard;
  outCover = state == stateHidden ? vec4(0.0, 0.0, cover) : vec4(cover, 0.0, 0.0);
  outElement = element;
  outDepth = depth;
}

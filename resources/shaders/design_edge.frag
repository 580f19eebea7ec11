#version 460
// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Coverage of design edges: the line in one channel, its light casing in the other, cut into dashes or
// dots where the scan hides the edge or does not know. Blended by maximum, so that the
// pieces of a bent edge join without a seam.

#extension GL_GOOGLE_include_directive : require
#include "overlay_frame.glsl"

layout(set = 0, binding = 3) uniform sampler2D scanDepth;
layout(set = 0, binding = 4) uniform sampler2D faceDepth;

layout(location = 0) noperspective in float across;
layout(location = 1) in float along;
layout(location = 2) in float depth;
layout(location = 3) flat in uint element;
layout(location = 4) flat in vec2 sideways;

layout(location = 0) out vec2 outCover;
layout(location = 1) out uint outElement;
layout(location = 2) out float outDepth;

// 1 on the drawn part of a dash of about `pixels`: metres doubled or halved to fit the distance, so that
// dashes stay tied to the edge while the camera moves.
float dashed(float pixels, float drawn) {
  float metres = pixels * depth / frame.view.w;
  float period = exp2(round(log2(max(metres, 1e-6))));
  return fract(along / period) < drawn ? 1.0 : 0.0;
}

// An edge is in front where one of the four pixels about the line itself shows a face that is not nearer.
// On the face that it bounds, however steep, one of them always is; a bias that did the same would
// push that face behind others.
bool isBehindFaces() {
  vec2 line = gl_FragCoord.xy - across * sideways - 0.5;
  ivec2 low = ivec2(floor(line)), last = ivec2(frame.lens.domain.zw) - 1;
  float farthest = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 at = clamp(low + ivec2(i & 1, i >> 1), ivec2(0), last);
    farthest = max(farthest, texelFetch(faceDepth, at, 0).r);
  }
  return depth > farthest * frame.view.z;
}

void main() {
  if (isBehindFaces()) discard;
  uint state = stateOf(depth, texelFetch(scanDepth, ivec2(gl_FragCoord.xy), 0).r);
  float strength = 1.0, casing = 0.55;
  if (state == stateUnknown) {
    strength = 0.9 * dashed(5.0 * frame.lines.z, 0.4);
    casing = 0.5 * strength;
  } else if (state == stateHidden) {
    if (frame.scan.z == hiddenDash) strength = dashed(16.0 * frame.lines.z, 0.55);
    if (frame.scan.z == hiddenGhost) strength = 0.3;
    if (frame.scan.z == hiddenHide) strength = 0.0;
    casing = 0.5 * strength;
  }
  float distance = abs(across);
  // A trace stays where nothing is drawn, so that what has edges alone can still be picked and counted.
  casing = max(casing, 0.005);
  outCover = vec2(strength * clamp(frame.lines.x + 0.5 - distance, 0.0, 1.0),
                  casing * clamp(frame.lines.y + 0.5 - distance, 0.0, 1.0));
  if (outCover.y <= 0.0) discard;
  outElement = element;
  outDepth = depth;
}

#version 460
// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The hidden layer: what lies behind a visible face of another element, and is hidden by it or by the scan.
// Where the front layer itself is hidden, it already shows what is wanted here.

#extension GL_GOOGLE_include_directive : require
#include "overlay_frame.glsl"

layout(constant_id = 0) const uint masked = 0u;

layout(set = 0, binding = 2) uniform sampler2D scanDepth;
layout(set = 0, binding = 3) uniform usampler2D faceKey;
layout(set = 0, binding = 4) uniform usampler2D faceElement;

layout(location = 0) in vec3 position;
layout(location = 1) flat in uint element;

layout(location = 0) out uint outElement;
layout(location = 1) out float outDepth;

void main() {
  if (masked != 0u && !insideLens(position.xy / position.z, frame.lens)) discard;
  ivec2 at = ivec2(gl_FragCoord.xy);
  if (stateOfKey(texelFetch(faceKey, at, 0).r) != stateVisible) discard;
  if (texelFetch(faceElement, at, 0).r == element) discard;
  outElement = element;
  outDepth = position.z;
}

#version 460
// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The front layer: the nearest design face of each pixel, whatever the scan says of it. Lit colour with the
// opacity that a visible face has, element, depth, and what the scan says.

#extension GL_GOOGLE_include_directive : require
#include "overlay_frame.glsl"

// 1 where the lens folds back inside the picture's reach: then every fragment is held to its domain.
layout(constant_id = 0) const uint masked = 0u;

layout(set = 0, binding = 2) uniform sampler2D scanDepth;

layout(location = 0) in vec3 position;
layout(location = 1) flat in vec3 normal;
layout(location = 2) flat in vec4 colour;
layout(location = 3) flat in uint element;

layout(location = 0) out vec4 outColour;
layout(location = 1) out uint outElement;
layout(location = 2) out float outDepth;
layout(location = 3) out uint outKey;

void main() {
  if (masked != 0u && !insideLens(position.xy / position.z, frame.lens)) discard;
  // Blinn-Phong: the highlight about the half-way vector.
  vec3 halfway = normalize(-frame.light.xyz - normalize(position));
  float highlight = frame.shading.y * pow(max(dot(normal, halfway), 0.0), frame.shading.z);
  if (dot(normal, frame.light.xyz) >= 0.0) highlight = 0.0;
  outColour = vec4(min(colour.rgb + highlight, vec3(1.0)), colour.a);
  outElement = element;
  outDepth = position.z;
  outKey = keyOf(element, position.z, texelFetch(scanDepth, ivec2(gl_FragCoord.xy), 0).r);
}

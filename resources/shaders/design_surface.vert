#version 460
// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Design faces: bends each vertex and lights the face with what does not depend on the pixel. The faces
// are planar and the light directional, so that only the highlight is left to the fragment.

#extension GL_GOOGLE_include_directive : require
#include "overlay_frame.glsl"

layout(location = 0) in vec3 pInCamera;
layout(location = 1) in vec3 normal;
layout(location = 2) in uint element;

layout(location = 0) out vec3 outPosition;
layout(location = 1) flat out vec3 outNormal;
layout(location = 2) flat out vec4 outColour;
layout(location = 3) flat out uint outElement;

void main() {
  gl_Position = clipPosition(pixelOf(pInCamera), pInCamera.z);
  // Two-sided: the side that is seen is the side that is lit.
  vec3 n = dot(normal, pInCamera) > 0.0 ? -normal : normal;
  ElementStyle style = styles[element - 1u];
  float lit = frame.light.w + frame.shading.x * max(dot(n, -frame.light.xyz), 0.0);
  vec3 colour = style.flags.x != 0u ? mix(style.colour.rgb, selectionColour, 0.6) : style.colour.rgb;
  float opacity = frame.shading.w * style.colour.a;
  if (style.flags.x != 0u) opacity = max(opacity, 0.7);
  outPosition = pInCamera;
  outNormal = n;
  outColour = vec4(colour * lit, opacity);
  outElement = element;
}

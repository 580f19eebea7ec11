#version 460
// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Pixels of points in camera axes, through the lens alone: what the vertex stages do, for checking them.

#extension GL_GOOGLE_include_directive : require
#include "distortion.glsl"

layout(local_size_x = 64) in;
layout(std140, set = 0, binding = 0) uniform LensBlock { LensUniform lens; };
layout(std430, set = 0, binding = 1) readonly buffer PointBlock { vec4 points[]; };
layout(std430, set = 0, binding = 2) writeonly buffer PixelBlock { vec2 pixels[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= points.length()) return;
  vec3 p = points[i].xyz;
  pixels[i] = pixelOfDistorted(distortPoint(p.xy / p.z, lens), lens);
}

#version 460
// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Points by their depth alone; then, where 64-bit atomics are missing, what they carry in a second pass over the same
// points: the smallest payload of those at the pixel's depth.

#extension GL_GOOGLE_include_directive : require
#include "splat_points.glsl"

layout(constant_id = 0) const uint secondPass = 0;
layout(std430, set = 0, binding = 5) buffer DepthBlock { uint depths[]; };
layout(std430, set = 0, binding = 6) buffer PayloadBlock { uint payloads[]; };

void put(uint at, float depth, uint payload) {
  uint bits = floatBitsToUint(depth);
  if (secondPass == 0u)
    atomicMin(depths[at], bits);
  else if (depths[at] == bits)
    atomicMin(payloads[at], payload);
}

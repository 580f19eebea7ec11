#version 460
// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Points with what they carry, in one pass: depth above payload in 64 bits, so that the nearest wins and equal depths are
// settled by the payload.

#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#extension GL_GOOGLE_include_directive : require
#include "splat_points.glsl"

layout(std430, set = 0, binding = 5) buffer PixelBlock { uint64_t pixels[]; };

void put(uint at, float depth, uint payload) {
  atomicMin(pixels[at], (uint64_t(floatBitsToUint(depth)) << 32) | uint64_t(payload));
}

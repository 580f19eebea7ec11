#version 460
// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Design edges as quads of constant width on screen, four vertices an edge (bit 0: which end, bit 1:
// which side), fetched by index.

#extension GL_GOOGLE_include_directive : require
#include "overlay_frame.glsl"

// EdgeVertex of overlay/draw_list.h, five words: position, element, metres along.
layout(std430, set = 0, binding = 2) readonly buffer EdgeBlock { uint words[]; };

layout(constant_id = 0) const uint isBehindLayer = 0u;

layout(location = 0) noperspective out float outAcross;
layout(location = 1) out float outAlong;
layout(location = 2) out float outDepth;
layout(location = 3) flat out uint outElement;
layout(location = 4) flat out vec2 outSideways;

vec3 positionOf(uint vertex) {
  return vec3(uintBitsToFloat(words[5u * vertex]), uintBitsToFloat(words[5u * vertex + 1u]),
              uintBitsToFloat(words[5u * vertex + 2u]));
}

void main() {
  uint edge = uint(gl_VertexIndex) >> 2;
  uint end = uint(gl_VertexIndex) & 1u;
  float side = (gl_VertexIndex & 2) != 0 ? 1.0 : -1.0;
  vec3 a = positionOf(2u * edge), b = positionOf(2u * edge + 1u);
  vec2 pixelA = pixelOf(a), pixelB = pixelOf(b);
  vec2 towards = pixelB - pixelA;
  float length2 = dot(towards, towards);
  towards = length2 > 1e-8 ? towards * inversesqrt(length2) : vec2(1.0, 0.0);

  uint vertex = 2u * edge + end;
  vec3 p = end == 0u ? a : b;
  float reach = frame.lines.y + 0.5;
  outSideways = vec2(-towards.y, towards.x);
  gl_Position = clipPosition((end == 0u ? pixelA : pixelB) + side * reach * outSideways, p.z);
  // The depth test only spares the work for what is well behind; the fragment judges exactly.
  gl_Position.z *= 1.06;
  // The hidden layer's depth has the element's rank before it, see hidden_surface.vert.
  if (isBehindLayer != 0u) {
    float rank = float(styles[words[5u * vertex + 3u] - 1u].flags.w);
    gl_Position.z = (gl_Position.z + rank * gl_Position.w) / 64.0;
  }
  outAcross = side * reach;
  outAlong = uintBitsToFloat(words[5u * vertex + 4u]);
  outDepth = p.z;
  outElement = words[5u * vertex + 3u];
}

#version 460
// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Design faces for the hidden layer: bends each vertex; drops what a closed solid shows from its inside.
// Depth is the element's rank first and the distance within a rank: what is small shows through what is
// large.

#extension GL_GOOGLE_include_directive : require
#include "overlay_frame.glsl"

layout(location = 0) in vec3 pInCamera;
layout(location = 1) in vec3 normal;
layout(location = 2) in uint element;

layout(location = 0) out vec3 outPosition;
layout(location = 1) flat out uint outElement;

void main() {
  uint winding = styles[element - 1u].flags.z;
  // The same for every corner of a face, since a plane has one side towards the camera.
  bool facesAway = dot(normal, pInCamera) > 0.0;
  bool isBack = winding == 1u ? facesAway : (winding == 2u ? !facesAway : false);
  gl_Position = clipPosition(pixelOf(pInCamera), pInCamera.z);
  gl_Position.z = (gl_Position.z + float(styles[element - 1u].flags.w) * gl_Position.w) / 64.0;
  if (isBack) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  outPosition = pInCamera;
  outElement = element;
}

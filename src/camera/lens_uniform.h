// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>

#include <glm/glm.hpp>

#include "camera/camera.h"

namespace alidade {

/// A camera's lens as shaders read it: the std140 block of resources/shaders/distortion.glsl, member
/// by member. Everything is a vec4, so that the rules for C++ and std140 agree.
struct LensUniform {
  glm::vec4 radial;       ///< k1 k2 k3 k4
  glm::vec4 radialHigh;   ///< k5 k6, then p1 p2
  glm::vec4 denominator;  ///< q1 q2 q3, then the LensKind as a number
  glm::vec4 growth;       ///< t3 t4 t5 t6
  glm::vec4 prism;        ///< s1 s2 s3 s4
  glm::vec4 shear;        ///< shear, skew, 1 where the sensor is tilted, unused
  glm::vec4 tilt0;        ///< rows of the tilt, w unused
  glm::vec4 tilt1;
  glm::vec4 tilt2;
  glm::vec4 focal;        ///< fx fy cx cy, pixels, (0,0) the centre of the top-left pixel
  glm::vec4 domain;       ///< radius to draw within, fold-back radius (at most 1e30), width, height
};

static_assert(offsetof(LensUniform, radial) == 0);
static_assert(offsetof(LensUniform, radialHigh) == 16);
static_assert(offsetof(LensUniform, denominator) == 32);
static_assert(offsetof(LensUniform, growth) == 48);
static_assert(offsetof(LensUniform, prism) == 64);
static_assert(offsetof(LensUniform, shear) == 80);
static_assert(offsetof(LensUniform, tilt0) == 96);
static_assert(offsetof(LensUniform, tilt1) == 112);
static_assert(offsetof(LensUniform, tilt2) == 128);
static_assert(offsetof(LensUniform, focal) == 144);
static_assert(offsetof(LensUniform, domain) == 160);
static_assert(sizeof(LensUniform) == 176);

/// Floats of the camera's lens; infinite radii become 1e30.
LensUniform lensUniform(const Camera& camera);

}  // namespace alidade

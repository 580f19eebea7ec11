// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The lens in GLSL: the twin of src/camera/lens_kernel.h, held to it by a test. The formulas and their
// sources stand in src/camera/distortion.h.
//
// LensUniform is src/camera/lens_uniform.h member by member. In a std140 block all members are vec4, so
// member i stands at byte 16 i and the whole takes 176 bytes:
//
//     layout(std140, set = 0, binding = 0) uniform LensBlock { LensUniform lens; };

#ifndef ALIDADE_DISTORTION_GLSL
#define ALIDADE_DISTORTION_GLSL

struct LensUniform {
  vec4 radial;       //   0: k1 k2 k3 k4
  vec4 radialHigh;   //  16: k5 k6, then p1 p2
  vec4 denominator;  //  32: q1 q2 q3, then the lens kind as a number
  vec4 growth;       //  48: t3 t4 t5 t6
  vec4 prism;        //  64: s1 s2 s3 s4
  vec4 shear;        //  80: shear, skew, 1 where the sensor is tilted, unused
  vec4 tilt0;        //  96: rows of the tilt, w unused
  vec4 tilt1;        // 112
  vec4 tilt2;        // 128
  vec4 focal;        // 144: fx fy cx cy, pixels, (0,0) the centre of the top-left pixel
  vec4 domain;       // 160: radius to draw within, fold-back radius, width, height
};

// LensKind of lens_kernel.h.
const float lensKindNone = 0.0;
const float lensKindRadial = 1.0;
const float lensKindBrown = 2.0;
const float lensKindFull = 3.0;
const float lensKindFisheye = 4.0;

// atan(r) for r >= 0. Vulkan allows the built-in an error of 4096 units in the last place, which is a
// quarter of a pixel on a large picture; this is Cephes' atanf (Moshier), as in lens_kernel.h.
float arcTangent(float r) {
  bool far = r > 2.414213562373095;
  bool middle = !far && r > 0.4142135623730950;
  float z = far ? -1.0 / r : (middle ? (r - 1.0) / (r + 1.0) : r);
  float start = far ? 1.5707963267948966 : (middle ? 0.7853981633974483 : 0.0);
  float z2 = z * z;
  float poly = ((8.05374449538e-2 * z2 - 1.38776856032e-1) * z2 + 1.99777106478e-1) * z2 - 3.33329491539e-1;
  return start + (poly * z2 * z + z);
}

// atan(r)/r from r²; smooth through r = 0.
float atanOverRadius(float r2) {
  if (r2 < 1e-4) return 1.0 + r2 * (-1.0 / 3.0 + r2 * (1.0 / 5.0 - r2 / 7.0));
  float r = sqrt(r2);
  return arcTangent(r) / r;
}

vec2 distortFisheye(vec2 xy, LensUniform lens) {
  float r2 = dot(xy, xy);
  float ratio = atanOverRadius(r2);
  float theta2 = ratio * ratio * r2;
  vec4 k = lens.radial;
  return xy * (ratio * (1.0 + theta2 * (k.x + theta2 * (k.y + theta2 * (k.z + theta2 * k.w)))));
}

vec2 distortBrown(vec2 xy, LensUniform lens) {
  vec2 p = lens.radialHigh.zw;
  float r2 = dot(xy, xy);
  vec4 k = lens.radial;
  float radial = 1.0 + r2 * (k.x + r2 * (k.y + r2 * k.z));
  float xy2 = 2.0 * xy.x * xy.y;
  return xy * radial + vec2(p.x * xy2 + p.y * (r2 + 2.0 * xy.x * xy.x), p.x * (r2 + 2.0 * xy.y * xy.y) + p.y * xy2);
}

vec2 distortFull(vec2 xy, LensUniform lens) {
  vec2 p = lens.radialHigh.zw;
  float r2 = dot(xy, xy);
  vec4 k = lens.radial;
  float high = k.z + r2 * (k.w + r2 * (lens.radialHigh.x + r2 * lens.radialHigh.y));
  float numerator = 1.0 + r2 * (k.x + r2 * (k.y + r2 * high));
  vec3 q = lens.denominator.xyz;
  float radial = numerator / (1.0 + r2 * (q.x + r2 * (q.y + r2 * q.z)));
  vec4 t = lens.growth;
  float growth = 1.0 + r2 * (t.x + r2 * (t.y + r2 * (t.z + r2 * t.w)));
  float xy2 = 2.0 * xy.x * xy.y;
  vec2 decentred = vec2(p.x * xy2 + p.y * (r2 + 2.0 * xy.x * xy.x), p.x * (r2 + 2.0 * xy.y * xy.y) + p.y * xy2);
  vec4 s = lens.prism;
  vec2 prism = r2 * vec2(s.x + r2 * s.y, s.z + r2 * s.w);
  vec2 d = xy * radial + decentred * growth + prism + vec2(dot(lens.shear.xy, xy), 0.0);
  if (lens.shear.z > 0.5) {
    vec3 h = vec3(d, 1.0);
    d = vec2(dot(lens.tilt0.xyz, h), dot(lens.tilt1.xyz, h)) / dot(lens.tilt2.xyz, h);
  }
  return d;
}

// (X/Z, Y/Z) -> (x'', y'') through the lens. No domain check: see insideLens().
vec2 distortPoint(vec2 xy, LensUniform lens) {
  float kind = lens.denominator.w;
  if (kind < lensKindRadial) return xy;
  if (kind < lensKindFull) return distortBrown(xy, lens);
  if (kind < lensKindFisheye) return distortFull(xy, lens);
  return distortFisheye(xy, lens);
}

// (x'', y'') -> pixel; (0,0) is the centre of the top-left pixel.
vec2 pixelOfDistorted(vec2 distorted, LensUniform lens) {
  return lens.focal.xy * distorted + lens.focal.zw;
}

// True where the picture can see the direction (x, y, 1): nothing beyond may be drawn, because the
// model returns into the picture there.
bool insideLens(vec2 xy, LensUniform lens) {
  return dot(xy, xy) <= lens.domain.x * lens.domain.x;
}

#endif

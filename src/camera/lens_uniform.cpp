// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "camera/lens_uniform.h"

#include <algorithm>

namespace alidade {

LensUniform lensUniform(const Camera& camera) {
  const Lens<double>& lens = camera.lens();
  const Distortion& d = lens.d;
  const Intrinsics& in = camera.intrinsics();
  const auto finite = [](double radius) { return std::min(radius, 1e30); };
  LensUniform u{};
  u.radial = {d.k[0], d.k[1], d.k[2], d.k[3]};
  u.radialHigh = {d.k[4], d.k[5], d.p1, d.p2};
  u.denominator = {d.q[0], d.q[1], d.q[2], static_cast<double>(lens.kind)};
  u.growth = {d.t[0], d.t[1], d.t[2], d.t[3]};
  u.prism = {d.s[0], d.s[1], d.s[2], d.s[3]};
  u.shear = {d.shear, d.skew, lens.tilted ? 1.0 : 0.0, 0.0};
  u.tilt0 = {lens.tilt[0], lens.tilt[1], lens.tilt[2], 0.0};
  u.tilt1 = {lens.tilt[3], lens.tilt[4], lens.tilt[5], 0.0};
  u.tilt2 = {lens.tilt[6], lens.tilt[7], lens.tilt[8], 0.0};
  u.focal = {in.fx, in.fy, in.cx, in.cy};
  u.domain = {finite(camera.imageRadius()), finite(camera.foldBackRadius()), in.width, in.height};
  return u;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/lens_derivatives.h"

#include <ceres/jet.h>

#include "camera/dual.h"

namespace alidade {

namespace {

using Jet4 = ceres::Jet<double, 4>;

/// The sensor's tilt alone, with its derivatives by the flat position and by tauX, tauY.
void tilted(const Distortion& d, const glm::dvec2& flat, Jet4& u, Jet4& v) {
  BasicDistortion<Jet4> tilt;
  tilt.tauX = Jet4(d.tauX, 2);
  tilt.tauY = Jet4(d.tauY, 3);
  const Lens<Jet4> lens(tilt, true);
  distort<LensKind::Full>(lens, Jet4(flat.x, 0), Jet4(flat.y, 1), u, v);
}

}  // namespace

VaryingCamera::VaryingCamera(const Intrinsics& intrinsics)
    : m_intrinsics(intrinsics), m_lens(intrinsics.distortion), m_count(alidade::parameterCount(intrinsics.model)) {
  const CameraModel model = intrinsics.model;
  m_focalCount = model == CameraModel::SimplePinhole || model == CameraModel::SimpleRadial || model == CameraModel::Radial
                     ? 1 : 2;
}

VaryingCamera VaryingCamera::moved(const double* step) const {
  std::vector<double> parameters = m_intrinsics.parameters();
  for (int i = 0; i < m_count; ++i) parameters[i] += step[i];
  // A calibration that cannot be (a negative focal length) stays as it was: the projection then refuses the step.
  const auto made = Intrinsics::fromParameters(m_intrinsics.model, m_intrinsics.width, m_intrinsics.height, parameters);
  if (made) return VaryingCamera(*made);
  VaryingCamera invalid = *this;
  invalid.m_intrinsics.fx = invalid.m_intrinsics.fy = std::numeric_limits<double>::quiet_NaN();
  return invalid;
}

glm::dvec2 VaryingCamera::project(const glm::dvec3& p) const {
  double xd = 0, yd = 0;
  distort(m_lens, p.x / p.z, p.y / p.z, xd, yd);
  return {m_intrinsics.fx * xd + m_intrinsics.cx, m_intrinsics.fy * yd + m_intrinsics.cy};
}

void VaryingCamera::project(const glm::dvec3& p, bool byParameters, Projection& to) const {
  const double inverse = 1 / p.z, x = p.x * inverse, y = p.y * inverse;
  Dual2 u, v;
  distort(m_lens, Dual2{x, 1, 0}, Dual2{y, 0, 1}, u, v);
  const double fx = m_intrinsics.fx, fy = m_intrinsics.fy;
  to.pixel = {fx * u.value + m_intrinsics.cx, fy * v.value + m_intrinsics.cy};
  to.du = fx * inverse * glm::dvec3(u.dx, u.dy, -(u.dx * x + u.dy * y));
  to.dv = fy * inverse * glm::dvec3(v.dx, v.dy, -(v.dx * x + v.dy * y));
  if (!byParameters) return;
  int at = 0;
  to.byParameter[at++] = m_focalCount == 1 ? glm::dvec2(u.value, v.value) : glm::dvec2(u.value, 0);
  if (m_focalCount == 2) to.byParameter[at++] = {0, v.value};
  to.byParameter[at++] = {1, 0};
  to.byParameter[at++] = {0, 1};
  if (at == m_count) return;
  glm::dvec2* columns = to.byParameter.data() + at;
  distortionColumns(x, y, columns);
  for (int i = 0; i < m_count - at; ++i) columns[i] *= glm::dvec2(fx, fy);
}

glm::dvec2 VaryingCamera::flat(double x, double y) const {
  Lens<double> lens = m_lens;
  lens.tilted = false;
  double xd = 0, yd = 0;
  distort<LensKind::Full>(lens, x, y, xd, yd);
  return {xd, yd};
}

/// The formulas of distortion.h, differentiated by each coefficient in the model's own order.
void VaryingCamera::distortionColumns(double x, double y, glm::dvec2* columns) const {
  const Distortion& d = m_intrinsics.distortion;
  const double r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
  const glm::dvec2 p(x, y);
  if (d.fisheye) {
    const double ratio = lens_detail::atanOverRadius<double>(r2), theta2 = ratio * ratio * r2;
    double power = ratio;
    for (int i = 0; i < 4; ++i) columns[i] = p * (power *= theta2);
    return;
  }
  const double numerator = 1 + r2 * (d.k[0] + r2 * (d.k[1] + r2 * (d.k[2] + r2 * (d.k[3] + r2 * (d.k[4] + r2 * d.k[5])))));
  const double denominator = 1 + r2 * (d.q[0] + r2 * (d.q[1] + r2 * d.q[2]));
  const double growth = 1 + r2 * (d.t[0] + r2 * (d.t[1] + r2 * (d.t[2] + r2 * d.t[3])));
  const auto byK = [&](double power) { return p * (power / denominator); };
  const auto byQ = [&](double power) { return p * (-numerator / (denominator * denominator) * power); };
  const glm::dvec2 byP1(2 * x * y, r2 + 2 * y * y), byP2(r2 + 2 * x * x, 2 * x * y);
  switch (m_intrinsics.model) {
    case CameraModel::SimplePinhole:
    case CameraModel::Pinhole:
    case CameraModel::OpenCvFisheye: return;
    case CameraModel::SimpleRadial: columns[0] = byK(r2); return;
    case CameraModel::Radial: columns[0] = byK(r2), columns[1] = byK(r4); return;
    case CameraModel::BrownHighOrder: {
      double power = 1;
      for (int i = 0; i < 6; ++i) columns[i] = byK(power *= r2);
      for (int i = 0; i < 3; ++i) columns[6 + i] = byQ(i == 0 ? r2 : i == 1 ? r4 : r6);
      columns[9] = byP1 * growth, columns[10] = byP2 * growth;
      const glm::dvec2 decentred = d.p1 * byP1 + d.p2 * byP2;
      power = 1;
      for (int i = 0; i < 4; ++i) columns[11 + i] = decentred * (power *= r2);
      columns[15] = {x, 0}, columns[16] = {y, 0};
      return;
    }
    case CameraModel::BrownSkewed: {
      double power = 1;
      for (int i = 0; i < 4; ++i) columns[i] = byK(power *= r2);
      columns[4] = byP1 * growth, columns[5] = byP2 * growth;
      const glm::dvec2 decentred = d.p1 * byP1 + d.p2 * byP2;
      columns[6] = decentred * r2, columns[7] = decentred * r4;
      for (int i = 0; i < 8; ++i) columns[i].x += d.imageSkew * columns[i].y;
      columns[8] = {flat(x, y).y, 0};
      return;
    }
    default: break;
  }
  const int count = m_count - 4;
  columns[0] = byK(r2), columns[1] = byK(r4), columns[2] = byP1, columns[3] = byP2;
  if (count > 4) columns[4] = byK(r6);
  if (count > 5) columns[5] = byQ(r2), columns[6] = byQ(r4), columns[7] = byQ(r6);
  if (count > 8) columns[8] = {r2, 0}, columns[9] = {r4, 0}, columns[10] = {0, r2}, columns[11] = {0, r4};
  if (count <= 12) return;
  Jet4 u, v;
  tilted(d, flat(x, y), u, v);
  for (int i = 0; i < 12; ++i)
    columns[i] = {u.v[0] * columns[i].x + u.v[1] * columns[i].y, v.v[0] * columns[i].x + v.v[1] * columns[i].y};
  columns[12] = {u.v[2], v.v[2]}, columns[13] = {u.v[3], v.v[3]};
}

}  // namespace alidade

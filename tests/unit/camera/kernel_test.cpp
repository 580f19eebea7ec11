// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One kernel, many number types: scalar, vector of floats, automatic derivatives.

#include <random>

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "camera/lens_uniform.h"
#include "lenses.h"

namespace alidade {
namespace {

class Kernel : public testing::TestWithParam<NamedCamera> {
 protected:
  /// A coordinate inside the domain, within 60 degrees of the axis.
  glm::dvec2 inDomain() {
    std::uniform_real_distribution<double> unit(0, 1);
    const double angle = 6.283185307179586 * unit(m_random);
    const double r = 0.98 * std::min(m_camera.domain().limitAlong(angle), 1.7) * std::sqrt(unit(m_random));
    return {r * std::cos(angle), r * std::sin(angle)};
  }

  Camera m_camera{GetParam().intrinsics};
  std::mt19937_64 m_random{5};
};

template <class V>
void expectVectorEqualsScalar(const Camera& camera, const std::vector<glm::dvec2>& points) {
  constexpr int lanes = sizeof(V) / sizeof(float);
  const Lens<double>& exact = camera.lens();
  const Lens<float> lens(camera.intrinsics().distortion.cast<float>());
  EXPECT_EQ(lens.kind, exact.kind);
  for (std::size_t i = 0; i + lanes <= points.size(); i += lanes) {
    V x{}, y{}, xd{}, yd{};
    for (int j = 0; j < lanes; ++j) x[j] = static_cast<float>(points[i + j].x), y[j] = static_cast<float>(points[i + j].y);
    distort(lens, x, y, xd, yd);
    for (int j = 0; j < lanes; ++j) {
      double ex = 0, ey = 0;
      distort(exact, static_cast<double>(x[j]), static_cast<double>(y[j]), ex, ey);
      // Terms cancel: the error is of the largest term, not of the sum.
      const double scale = 2e-6 * (1 + std::hypot(ex, ey) + std::hypot(x[j], y[j]));
      EXPECT_NEAR(xd[j], ex, scale) << x[j] << " " << y[j];
      EXPECT_NEAR(yd[j], ey, scale) << x[j] << " " << y[j];
    }
  }
}

TEST_P(Kernel, VectorsOfFloatsEqualTheScalarWithinFloatPrecision) {
  std::vector<glm::dvec2> points{{0, 0}, {1e-20, 0}, {1e-3, 1e-3}, {0.00999, 0}, {0.01001, 0}, {0.4142, 0}};
  // A pole or a vanishing line magnifies a float's last bit beyond bounds; a picture stays clear of them.
  while (points.size() < 1600) {
    const glm::dvec2 p = inDomain();
    if (const DistortedPoint at = m_camera.domain().distortedWithJacobian(p.x, p.y); at.determinant() < 20)
      points.push_back(p);
  }
  using Four = float __attribute__((vector_size(16)));
  using Eight = float __attribute__((vector_size(32)));
  using Sixteen = float __attribute__((vector_size(64)));
  expectVectorEqualsScalar<Four>(m_camera, points);
  expectVectorEqualsScalar<Eight>(m_camera, points);
  expectVectorEqualsScalar<Sixteen>(m_camera, points);
}

TEST_P(Kernel, ThePrunedKindEqualsTheFullFormula) {
  const Lens<double>& lens = m_camera.lens();
  if (lens.kind == LensKind::Fisheye) return;
  for (int i = 0; i < 200; ++i) {
    const glm::dvec2 p = inDomain();
    glm::dvec2 pruned, full;
    distort(lens, p.x, p.y, pruned.x, pruned.y);
    distort<LensKind::Full>(lens, p.x, p.y, full.x, full.y);
    EXPECT_LT(glm::length(pruned - full), 1e-14 * (1 + glm::length(full)));
  }
}

TEST_P(Kernel, JacobianOfTheProjectionEqualsDifferences) {
  for (int i = 0; i < 200; ++i) {
    const double depth = 1 + 20.0 * i / 200;
    const glm::dvec3 p = depth * glm::dvec3(0.98 * inDomain(), 1);
    ProjectionJacobian jacobian{};
    const auto pixel = m_camera.project(p, jacobian);
    ASSERT_TRUE(pixel);
    EXPECT_EQ(*pixel, *m_camera.project(p));
    for (int axis = 0; axis < 3; ++axis) {
      // Richardson's extrapolation of the central difference.
      const auto slope = [&](double h) {
        glm::dvec3 step(0);
        step[axis] = h;
        return (m_camera.projectUnchecked(p + step) - m_camera.projectUnchecked(p - step)) / (2 * h);
      };
      const double h = 1e-4 * depth;
      const glm::dvec2 wanted = (4.0 * slope(h / 2) - slope(h)) / 3.0;
      const double size = 1e-6 * (glm::length(jacobian.du) + glm::length(jacobian.dv));
      EXPECT_NEAR(jacobian.du[axis], wanted.x, size);
      EXPECT_NEAR(jacobian.dv[axis], wanted.y, size);
    }
  }
}

TEST_P(Kernel, TheSolversDerivativesEqualTheCamerasOwn) {
  using Jet = ceres::Jet<double, 2>;
  for (int i = 0; i < 200; ++i) {
    const glm::dvec2 p = i == 0 ? glm::dvec2(0) : inDomain();
    Jet xd, yd;
    distort(m_camera.lens(), Jet(p.x, 0), Jet(p.y, 1), xd, yd);
    const DistortedPoint at = m_camera.domain().distortedWithJacobian(p.x, p.y);
    const double size = 1e-12 * (1 + glm::length(at.position) + glm::length(at.dx) + glm::length(at.dy));
    EXPECT_NEAR(xd.a, at.position.x, size);
    EXPECT_NEAR(yd.a, at.position.y, size);
    EXPECT_NEAR(xd.v[0], at.dx.x, size);
    EXPECT_NEAR(xd.v[1], at.dy.x, size);
    EXPECT_NEAR(yd.v[0], at.dx.y, size);
    EXPECT_NEAR(yd.v[1], at.dy.y, size);
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, Kernel, testing::ValuesIn(lensCatalogue()), TestNamer());

TEST(KernelOfUnknownCoefficients, HasDerivativesByCoefficientsThatAreZero) {
  using Jet = ceres::Jet<double, 2>;
  BasicDistortion<Jet> d;
  d.k[0] = Jet(0.0, 0);
  d.tauX = Jet(0.0, 1);
  const Lens<Jet> lens(d, true);
  Jet xd, yd;
  distort(lens, Jet(0.5), Jet(0.25), xd, yd);
  const auto at = [](double k1, double tauX) {
    Distortion plain;
    plain.k[0] = k1;
    plain.tauX = tauX;
    glm::dvec2 to;
    distort(Lens<double>(plain), 0.5, 0.25, to.x, to.y);
    return to;
  };
  const double h = 1e-6;
  const glm::dvec2 byK1 = (at(h, 0) - at(-h, 0)) / (2 * h), byTau = (at(0, h) - at(0, -h)) / (2 * h);
  EXPECT_NEAR(xd.v[0], byK1.x, 1e-9);
  EXPECT_NEAR(yd.v[0], byK1.y, 1e-9);
  EXPECT_NEAR(xd.v[1], byTau.x, 1e-9);
  EXPECT_NEAR(yd.v[1], byTau.y, 1e-9);
}

TEST(LensUniform, HoldsTheCoefficientsWhereTheShaderReadsThem) {
  const Camera camera(droneCamera());
  const LensUniform u = lensUniform(camera);
  const auto* floats = reinterpret_cast<const float*>(&u);
  EXPECT_FLOAT_EQ(floats[0], -0.26439037908330026f);   // k1
  EXPECT_FLOAT_EQ(floats[6], -0.000503346062832222f);  // p1
  EXPECT_FLOAT_EQ(floats[11], static_cast<float>(LensKind::Brown));
  EXPECT_FLOAT_EQ(floats[36], 3693.15694758f);         // fx
  EXPECT_FLOAT_EQ(floats[41], 1.369f * (camera.foldBackRadius() / 1.369));
  EXPECT_FLOAT_EQ(floats[42], 5472);
  EXPECT_EQ(lensUniform(Camera(made(CameraModel::Pinhole, 64, 48, {50, 50, 32, 24}))).domain.y, 1e30f);
}

}  // namespace
}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "geometry/twist.h"

#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <unsupported/Eigen/MatrixFunctions>

namespace alidade {

namespace {

Eigen::Matrix4d matrixOf(const Twist& twist) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  const glm::dvec3 w = twist.rotation, v = twist.translation;
  m << 0, -w.z, w.y, v.x, w.z, 0, -w.x, v.y, -w.y, w.x, 0, v.z, 0, 0, 0, 0;
  return m;
}

Eigen::Matrix4d matrixOf(const RigidTransform& pose) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  const glm::dmat3 r = pose.rotationMatrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) m(row, column) = r[column][row];
    m(row, 3) = pose.translation[row];
  }
  return m;
}

Twist randomTwist(std::mt19937& random, double largestAngle) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(0, 1);
  const glm::dvec3 axis = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
  return {axis * largestAngle * share(random), glm::dvec3(normal(random), normal(random), normal(random))};
}

/// The pose on a screw about a vertical axis through `centre`: turned by `angle`, risen by `rise`.
RigidTransform onHelix(const glm::dvec3& centre, double radius, double angle, double rise) {
  const glm::dvec3 eye = centre + glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), rise);
  // Looks at the axis, at its own height.
  return RigidTransform::cameraLookingAt(eye, {centre.x, centre.y, eye.z});
}

}  // namespace

TEST(Twist, ItsExponentialIsTheMatrixExponential) {
  std::mt19937 random(3);
  for (const double largest : {1e-9, 1e-5, 2e-4, 0.1, 3.0}) {
    for (int i = 0; i < 50; ++i) {
      const Twist twist = randomTwist(random, largest);
      const Eigen::Matrix4d expected = matrixOf(twist).exp();
      EXPECT_LT((matrixOf(exponential(twist)) - expected).cwiseAbs().maxCoeff(), 1e-12) << largest;
    }
  }
}

TEST(Twist, TheLogarithmUndoesTheExponential) {
  std::mt19937 random(4);
  for (const double largest : {0.0, 1e-9, 1e-5, 2e-4, 0.1, 3.0, std::numbers::pi}) {
    for (int i = 0; i < 50; ++i) {
      const Twist twist = randomTwist(random, largest), again = logarithm(exponential(twist));
      EXPECT_LT(glm::length(again.rotation - twist.rotation), 1e-9) << largest;
      EXPECT_LT(glm::length(again.translation - twist.translation), 1e-9) << largest;
    }
  }
}

/// Closed form: a camera that circles an axis and rises with the angle. Slerp with a straight line between the
/// centres is off by the arc's sagitta, 0.38 m here.
TEST(Twist, APoseBetweenTwoOnAHelixIsOnTheHelix) {
  for (const glm::dvec3 centre : {glm::dvec3(0), glm::dvec3(2'683'500, 1'247'800, 412)}) {
    const RigidTransform a = onHelix(centre, 5, 0.3, 0), b = onHelix(centre, 5, 1.1, 1.6);
    for (const double t : {0.0, 0.25, 0.5, 0.9, 1.0, 1.5}) {
      const RigidTransform pose = interpolateOnScrew(a, b, t), truth = onHelix(centre, 5, 0.3 + 0.8 * t, 1.6 * t);
      EXPECT_LT(glm::length(pose.centre() - truth.centre()), 1e-8) << t;
      // The closed form itself is only as good as what cameraLookingAt keeps of 2.7 million metres.
      EXPECT_LT(rotationAngleBetween(pose, truth), 1e-9) << t;
      // Inverted poses take the same way.
      const RigidTransform inverted = interpolateOnScrew(a.inverse(), b.inverse(), t).inverse();
      EXPECT_LT(glm::length(inverted.centre() - truth.centre()), 1e-7) << t;
    }
  }
}

TEST(Twist, AVelocityIsTheDerivativeOfTheMotion) {
  std::mt19937 random(5);
  const Twist twist = randomTwist(random, 1.0);
  const glm::dvec3 p(0.3, -2, 7);
  const double h = 1e-6;
  const glm::dvec3 difference = (exponential(twist * h) * p - exponential(twist * -h) * p) / (2 * h);
  EXPECT_LT(glm::length(difference - twist.velocityOf(p)), 1e-8);
}

}  // namespace alidade

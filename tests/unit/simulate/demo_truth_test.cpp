// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <limits>

#include "camera/camera.h"
#include "demo_fixture.h"

namespace alidade {
namespace {

using namespace demo_test;

Camera cameraOf(const nlohmann::json& json) {
  Intrinsics in;
  in.model = CameraModel::OpenCv5;
  in.width = json.at("width");
  in.height = json.at("height");
  in.fx = json.at("fx");
  in.fy = json.at("fy");
  in.cx = json.at("cx");
  in.cy = json.at("cy");
  in.distortion.k = {json.at("k1"), json.at("k2"), json.at("k3"), 0, 0, 0};
  in.distortion.p1 = json.at("p1");
  in.distortion.p2 = json.at("p2");
  return Camera(in);
}

/// Slab test against a box in its own frame: depth along a ray whose z is 1, or infinity.
double boxDepth(const glm::dvec3& eye, const glm::dvec3& ray, const nlohmann::json& prism) {
  const glm::dvec3 origin = vectorOf(prism.at("origin_m"));
  const glm::dvec3 axes[3] = {vectorOf(prism.at("x_axis")), vectorOf(prism.at("y_axis")),
                              vectorOf(prism.at("z_axis"))};
  const auto& low2 = prism.at("outline").at("low_m");
  const auto& high2 = prism.at("outline").at("high_m");
  const double low[3] = {low2.at(0), low2.at(1), 0.0};
  const double high[3] = {high2.at(0), high2.at(1), prism.at("depth_m")};
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double o = glm::dot(eye - origin, axes[i]), d = glm::dot(ray, axes[i]);
    const double a = (low[i] - o) / d, b = (high[i] - o) / d;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

class DemoTruth : public DemoSiteTest {
 protected:
  struct Ray {
    glm::dvec3 eye, direction;
  };
  Ray ray(int frame, int x, int y) const {
    static const Camera camera = cameraOf(truth().at("camera"));
    const RigidTransform worldFromCamera =
        transformOf(truth().at("frames").at(frame).at("camera_from_world")).inverse();
    return {worldFromCamera.translation, worldFromCamera.rotation * *camera.unproject({x, y})};
  }
  const int width = 320, height = 240;
};

TEST_F(DemoTruth, DesignDepthIsThatOfTheNearestBoxInClosedForm) {
  const auto depth = arrayOf<float>(site().truth + "/designdepth.0000.f32");
  ASSERT_EQ(depth.size(), static_cast<std::size_t>(width) * height);
  int compared = 0;
  for (int y = 3; y < height; y += 7)
    for (int x = 3; x < width; x += 7) {
      const Ray r = ray(0, x, y);
      // Elements without openings that are boxes; where one of them is the nearest, the depth must be its
      // own. Those with openings or round ones may stand before it, never behind.
      double solid = std::numeric_limits<double>::infinity(), other = solid;
      for (const auto& one : truth().at("elements")) {
        const auto& prism = one.at("prism");
        if (!prism.contains("outline")) continue;
        const double d = boxDepth(r.eye, r.direction, prism);
        (prism.contains("openings") ? other : solid) =
            std::min(prism.contains("openings") ? other : solid, d);
      }
      const double found = depth[static_cast<std::size_t>(y) * width + x];
      if (!(solid < other) || found < solid - 0.001) continue;
      if (std::isinf(solid)) continue;
      EXPECT_NEAR(found, solid, 2e-5 * solid) << x << ' ' << y;
      ++compared;
    }
  EXPECT_GT(compared, 150);
}

TEST_F(DemoTruth, AsBuiltDepthOfTheSlabIsThatOfItsPlane) {
  const auto& slab = element("Slab ground floor").at("prism");
  const double top = vectorOf(slab.at("origin_m")).z + slab.at("depth_m").get<double>();
  const auto depth = arrayOf<float>(site().truth + "/depth.0001.f32");
  const auto designed = arrayOf<float>(site().truth + "/designdepth.0001.f32");
  int onSlab = 0, before = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Ray r = ray(1, x, y);
      const double plane = (top - r.eye.z) / r.direction.z;
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      if (!(plane > 0) || std::abs(designed[i] - plane) > 1e-3) continue;
      // Things stand before the slab, nothing lies behind its plane where the design shows its top.
      ASSERT_LT(depth[i], plane + 1e-3 * plane);
      (std::abs(depth[i] - plane) < 2e-5 * plane ? onSlab : before) += 1;
    }
  EXPECT_GT(onSlab, 50);
  EXPECT_GT(before, 0);
}

TEST_F(DemoTruth, VisibilityFollowsFromTheTwoDepthsByTheWrittenRule) {
  const auto depth = arrayOf<float>(site().truth + "/depth.0000.f32");
  const auto designed = arrayOf<float>(site().truth + "/designdepth.0000.f32");
  const auto visibility = arrayOf<std::uint8_t>(site().truth + "/visibility.0000.u8");
  const double tolerance = truth().at("hidden_tolerance_m");
  ASSERT_EQ(visibility.size(), depth.size());
  int count[3] = {0, 0, 0};
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const int expected = std::isinf(designed[i]) ? 0 : depth[i] < designed[i] - tolerance ? 2 : 1;
    // The depths are stored as float: at the tolerance itself either answer is right.
    if (std::abs(depth[i] - (designed[i] - tolerance)) > 1e-5) {
      EXPECT_EQ(visibility[i], expected);
    }
    ++count[visibility[i]];
  }
  for (const int n : count) EXPECT_GT(n, 500);
}

TEST_F(DemoTruth, SkyIsInfinitelyFar) {
  const auto depth = arrayOf<float>(site().truth + "/depth.0000.f32");
  int sky = 0;
  for (const float d : depth) {
    EXPECT_FALSE(std::isnan(d));
    EXPECT_GT(d, 0.0f);
    sky += std::isinf(d);
  }
  EXPECT_GT(sky, 2000);
}

}  // namespace
}  // namespace alidade

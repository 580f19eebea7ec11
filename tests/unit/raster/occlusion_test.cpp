// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/occlusion.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "unit/cloud/test_clouds.h"
#include "unit/raster/street_scene.h"

namespace alidade {
namespace {

using test::storeFrom;
using test::StreetScene;

Camera streetCamera(int width, int height) {
  const double f = 0.62 * width;
  return Camera(
      *Intrinsics::fromParameters(CameraModel::OpenCv5, width, height,
                                  {f, f, width / 2.0, height / 2.0 - 3, -0.12, 0.03, 0.0004, -0.0003, 0.0}));
}

const RigidTransform kStreetView = RigidTransform::cameraLookingAt({-1.0, 0.5, 1.7}, {12, 1.5, 1.2});

/// Exact depth a pixel, infinity for sky.
DepthImage truthOf(const StreetScene& scene, const Camera& camera, const RigidTransform& pose) {
  DepthImage truth(camera.width(), camera.height());
  const RigidTransform worldFromCamera = pose.inverse();
  for (int y = 0; y < truth.height(); ++y) {
    for (int x = 0; x < truth.width(); ++x) {
      const auto ray = camera.unproject(glm::dvec2(x, y));
      // The ray's z is 1, so the distance in its lengths is the depth.
      truth.at(x, y) =
          ray ? static_cast<float>(scene.cast(worldFromCamera.translation, worldFromCamera.rotation * *ray))
              : std::numeric_limits<float>::infinity();
    }
  }
  return truth;
}

/// Farther than two pixels from where the depth jumps by more than 5 cm and 3 %.
bool isInterior(const DepthImage& truth, int cx, int cy) {
  const float z = truth.at(cx, cy);
  for (int y = cy - 2; y <= cy + 2; ++y) {
    for (int x = cx - 2; x <= cx + 2; ++x) {
      if (!truth.contains(x, y)) continue;
      if (std::isinf(z) != std::isinf(truth.at(x, y))) return false;
      // A pixel of slope for each pixel between: a plane is no edge, however steep.
      if (std::abs(1 / truth.at(x, y) - 1 / z) > (0.05f / z + 0.03f) / z) return false;
    }
  }
  return true;
}

/// What the overlay asks: within its own tolerance (2 cm and 0.2 %) and what the surface itself changes over
/// a pixel.
bool agrees(const DepthImage& truth, int x, int y, float z) {
  const float t = truth.at(x, y);
  if (std::isinf(t)) return false;
  float slope = 0;
  for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    if (truth.contains(x + dx, y + dy)) slope = std::max(slope, std::abs(truth.at(x + dx, y + dy) - t));
  }
  return std::abs(z - t) <= 0.02f + 0.002f * t + std::min(slope, 0.03f * t + 0.05f);
}

struct Score {
  double precision, recall, unknown;
};

Score scoreOf(const DepthImage& truth, const DepthImage& depth, bool interior) {
  std::size_t surface = 0, known = 0, right = 0;
  for (int y = 0; y < truth.height(); ++y) {
    for (int x = 0; x < truth.width(); ++x) {
      if (isInterior(truth, x, y) != interior) continue;
      const bool isKnown = !std::isnan(depth.at(x, y));
      surface += std::isfinite(truth.at(x, y));
      known += isKnown;
      right += isKnown && agrees(truth, x, y, depth.at(x, y));
    }
  }
  return {100.0 * right / known, 100.0 * right / surface,
          100.0 * (1.0 - static_cast<double>(known) / surface)};
}

/// Four panels for the eye, where ALIDADE_TEST_PICTURES names a folder: dots, occlusion, truth, faults.
void savePicture(const std::string& name, const DepthImage& truth, const DepthImage& dots,
                 const DepthImage& depth) {
  const char* folder = std::getenv("ALIDADE_TEST_PICTURES");
  if (!folder) return;
  const int w = truth.width(), h = truth.height();
  std::vector<unsigned char> rgb(static_cast<std::size_t>(w) * h * 12, 0);
  const auto set = [&](int x, int y, unsigned char r, unsigned char g, unsigned char b) {
    unsigned char* p = &rgb[(static_cast<std::size_t>(y) * 2 * w + x) * 3];
    p[0] = r, p[1] = g, p[2] = b;
  };
  const auto gray = [](float z) {
    return static_cast<unsigned char>(std::isfinite(z) ? 255 / (1 + 0.15f * z) + 20 : 0);
  };
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const unsigned char d = gray(dots.at(x, y)), o = gray(depth.at(x, y)), t = gray(truth.at(x, y));
      set(x, y, d, d, d);
      if (std::isnan(depth.at(x, y)))
        set(x + w, y, 60, 0, 90);
      else
        set(x + w, y, o, o, o);
      set(x, y + h, t, t, t);
      const bool known = !std::isnan(depth.at(x, y)), right = known && agrees(truth, x, y, depth.at(x, y));
      const unsigned char dim = isInterior(truth, x, y) ? 255 : 110;
      if (!known)
        set(x + w, y + h, 0, 0, std::isinf(truth.at(x, y)) ? 40 : dim);
      else if (right)
        set(x + w, y + h, 30, 60, 30);
      else
        set(x + w, y + h, dim, depth.at(x, y) < truth.at(x, y) ? 0 : dim, 0);
    }
  }
  std::ofstream file(std::string(folder) + "/" + name + ".ppm", std::ios::binary);
  file << "P6\n" << 2 * w << " " << 2 * h << "\n255\n";
  file.write(reinterpret_cast<const char*>(rgb.data()), static_cast<std::streamsize>(rgb.size()));
}

std::shared_ptr<const PointStore> scanned(const StreetScene& scene, std::size_t points) {
  PointBatch batch;
  scene.scan({0.5, -1.0, 1.8}, points / 2, 0.003, 1, batch);
  scene.scan({18, 2.5, 1.8}, points / 2, 0.003, 2, batch);
  return storeFrom(batch);
}

Score scoreStreet(std::size_t points, int width, int height) {
  const StreetScene scene;
  const Camera camera = streetCamera(width, height);
  const auto store = scanned(scene, points);
  const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, kStreetView)}};
  const DepthImage truth = truthOf(scene, camera, kStreetView);
  const OcclusionDepth occlusion = occlusionDepth(layers, camera, kStreetView);
  const DepthImage dots = splat(layers, camera, kStreetView, {.maximumSizePx = 1.0}).depth;
  savePicture("street_" + std::to_string(points / 1000) + "k", truth, dots, occlusion.depth);
  const Score score = scoreOf(truth, occlusion.depth, true), edges = scoreOf(truth, occlusion.depth, false);
  std::printf(
      "%8zu points %dx%d: precision %.2f recall %.2f unknown %.2f | within 2 px of edges %.2f %.2f %.2f\n",
      points, width, height, score.precision, score.recall, score.unknown, edges.precision, edges.recall,
      edges.unknown);
  return score;
}

TEST(Occlusion, KnowsAStreetFromItsScanAndSaysWhatItDoesNotKnow) {
  // Bounds a little below what is reached (98.4/88.7, 99.1/93.3, 99.3/96.6 when written).
  const Score sparse = scoreStreet(100'000, 640, 360);
  EXPECT_GT(sparse.precision, 98.0);
  EXPECT_GT(sparse.recall, 87.0);
  const Score medium = scoreStreet(400'000, 640, 360);
  EXPECT_GT(medium.precision, 98.5);
  EXPECT_GT(medium.recall, 92.0);
  const Score dense = scoreStreet(1'500'000, 640, 360);
  EXPECT_GT(dense.precision, 98.5);
  EXPECT_GT(dense.recall, 95.5);
}

TEST(Occlusion, AWallHidesWhatShinesThroughItsDots) {
  // Two walls, 5 and 8 m away, both dotted 4 px apart on screen: between the near dots the far ones
  // show, and every one of them must go.
  PointBatch batch;
  std::mt19937 random(8);
  std::uniform_real_distribution<double> side(-3.0, 3.0);
  for (int i = 0; i < 9000; ++i) batch.position.push_back({side(random), side(random), 5.0});
  for (int i = 0; i < 20000; ++i) batch.position.push_back({2 * side(random), 2 * side(random), 8.0});
  const auto store = storeFrom(batch);
  const Camera camera = test::pinhole(400, 400, 320);
  const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, {})}};
  const SplatImages dots = splat(layers, camera, {}, {.maximumSizePx = 1.0});
  const DepthImage depth = occlusionDepth(layers, camera, {}).depth;
  std::size_t shining = 0, through = 0, unknown = 0;
  for (int y = 40; y < 360; ++y) {
    for (int x = 40; x < 360; ++x) {
      shining += dots.depth.at(x, y) > 6.0f && std::isfinite(dots.depth.at(x, y));
      through += depth.at(x, y) > 6.0f;
      unknown += std::isnan(depth.at(x, y));
    }
  }
  ASSERT_GT(shining, 5000u);
  EXPECT_LT(through, shining / 100);
  EXPECT_LT(unknown, 320u * 320u / 20);
}

TEST(Occlusion, AHoleInADenseSurfaceStaysUnknown) {
  // A wall dotted 0.5 px apart with a square opening of 40 px and nothing behind it.
  PointBatch batch;
  std::mt19937 random(8);
  std::uniform_real_distribution<double> side(-2.0, 2.0);
  for (int i = 0; i < 640'000; ++i) {
    const glm::dvec3 p(side(random), side(random), 4.0);
    if (std::max(std::abs(p.x), std::abs(p.y)) > 0.2) batch.position.push_back(p);
  }
  const auto store = storeFrom(batch);
  const Camera camera = test::pinhole(300, 300, 400);
  const DepthImage depth = occlusionDepth({{store, selectAll(*store, camera, {})}}, camera, {}).depth;
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 300; ++x) {
      const double away = std::max(std::abs(x - 149.5), std::abs(y - 149.5));
      const float z = depth.at(x, y);
      ASSERT_TRUE(away >= 17 || std::isnan(z)) << x << " " << y;
      ASSERT_TRUE(away <= 23 || std::abs(z - 4.0f) < 0.01f) << x << " " << y << " " << z;
    }
  }
}

TEST(Occlusion, NothingScannedIsUnknownEverywhere) {
  const Camera camera = test::pinhole(64, 48, 50);
  const DepthImage depth = occlusionDepth({}, camera, {}).depth;
  for (std::size_t i = 0; i < depth.size(); ++i) EXPECT_TRUE(std::isnan(depth.data()[i]));
}

TEST(Visibility, ComparesDepthWithToleranceAndKeepsItsFourAnswersApart) {
  DepthImage depth(4, 3, 10.0f);
  depth.at(1, 1) = std::numeric_limits<float>::quiet_NaN();
  depth.at(2, 1) = std::numeric_limits<float>::infinity();
  EXPECT_EQ(visibilityAt(depth, {0, 0}, 9.0, 0.02), Visibility::Visible);
  EXPECT_EQ(visibilityAt(depth, {0, 0}, 10.0249, 0.02), Visibility::Visible);
  EXPECT_EQ(visibilityAt(depth, {0, 0}, 10.0251, 0.02), Visibility::Hidden);
  EXPECT_EQ(visibilityAt(depth, {1.4, 0.6}, 5.0, 0.02), Visibility::Unknown);
  EXPECT_EQ(visibilityAt(depth, {2, 1}, 1e9, 0.02), Visibility::Visible);
  EXPECT_EQ(visibilityAt(depth, {-0.51, 0}, 5.0, 0.02), Visibility::Outside);
  EXPECT_EQ(visibilityAt(depth, {-0.49, 0}, 5.0, 0.02), Visibility::Visible);
  EXPECT_EQ(visibilityAt(depth, {3.5, 0}, 5.0, 0.02), Visibility::Outside);
  EXPECT_EQ(visibilityAt(depth, {0, 0}, -1.0, 0.02), Visibility::Outside);
  EXPECT_EQ(visibilityAt(depth, {std::nan(""), 0}, 5.0, 0.02), Visibility::Outside);
}

}  // namespace
}  // namespace alidade

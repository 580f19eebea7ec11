// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/draw_list.h"

#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "overlay/lens_error.h"
#include "unit/gpu/test_cameras.h"
#include "unit/overlay/scenes.h"

namespace alidade {

namespace {

const glm::dvec3 kFarAway(1.0e7 + 0.123, 9.87e6 - 0.321, 512.5);

FrameDescription frameOf(const Camera& camera, const glm::dvec3& origin,
                         std::shared_ptr<const DesignModel> model) {
  FrameDescription frame;
  frame.camera = camera;
  frame.cameraFromWorld = poseBefore(origin);
  frame.designs.push_back({std::move(model), {}, {}, {}});
  return frame;
}

/// Long and short members all over the picture, one box around the camera.
std::shared_ptr<const DesignModel> yard(const glm::dvec3& origin) {
  BoxModel model(origin);
  model.box({0, 0, 0}, {2, 1, 3}, {200, 80, 60, 255});
  model.box({-6, 3, 0}, {8, 0.3f, 4}, {90, 160, 220, 255});
  model.box({5, 8, 1}, {9, 6, 5}, {120, 200, 120, 255});
  model.box({0, -9, -1}, {30, 40, 0.2f}, {180, 180, 180, 255});
  model.box({0, 0, 6}, {24, 30, 0.3f}, {220, 200, 140, 255});
  return model.made();
}

double distanceToPolyline(const glm::dvec2& p, const std::vector<glm::dvec2>& line) {
  double best = 1e300;
  for (std::size_t i = 0; i + 1 < line.size(); i += 2) {
    const glm::dvec2 d = line[i + 1] - line[i];
    const double length2 = glm::dot(d, d);
    const double t = length2 > 0 ? std::clamp(glm::dot(p - line[i], d) / length2, 0.0, 1.0) : 0.0;
    best = std::min(best, glm::length(p - line[i] - t * d));
  }
  return best;
}

/// Largest distance from exact, double-precision points on the design's edges inside the picture to what is
/// drawn of that element, as straight lines between the drawn vertices' exact pixels.
double worstEdgeError(const FrameDescription& frame, const DrawList& list, int& checked) {
  const DesignModel& model = *frame.designs[0].model;
  const Camera& camera = list.camera;
  std::map<std::uint32_t, std::vector<glm::dvec2>> drawn;
  for (const EdgeVertex& v : list.edges)
    drawn[v.element].push_back(camera.projectUnchecked(glm::dvec3(v.pInCamera)));
  double worst = 0;
  for (std::size_t e = 0; e < model.elements.size(); ++e) {
    for (std::uint32_t i = 0; i < model.elements[e].edgeCount; ++i) {
      const auto& edge = model.edges[model.elements[e].firstEdge + i];
      const glm::dvec3 a = frame.cameraFromWorld * model.world(edge[0]);
      const glm::dvec3 b = frame.cameraFromWorld * model.world(edge[1]);
      for (int s = 0; s <= 60; ++s) {
        const glm::dvec3 p = a + (b - a) * (s / 60.0);
        const auto pixel = camera.project(p);
        if (p.z < LensError::kNearM || !pixel || !camera.inPicture(*pixel)) continue;
        worst = std::max(worst, distanceToPolyline(*pixel, drawn[static_cast<std::uint32_t>(e + 1)]));
        ++checked;
      }
    }
  }
  return worst;
}

using Position = std::tuple<float, float, float>;
Position key(const glm::vec3& p) {
  return {p.x, p.y, p.z};
}

}  // namespace

TEST(DrawList, EdgesLieWithinATenthOfAPixelOfTheirExactProjectionForEveryModelNearAndFarFromTheOrigin) {
  for (const Camera& camera : camerasOfEveryModel()) {
    for (const glm::dvec3& origin : {glm::dvec3(0), kFarAway}) {
      const FrameDescription frame = frameOf(camera, origin, yard(origin));
      const DrawList list = buildDrawList(frame, camera);
      int checked = 0;
      const double worst = worstEdgeError(frame, list, checked);
      EXPECT_GT(checked, 450) << nameOf(camera);
      EXPECT_LT(worst, 0.1) << nameOf(camera) << " at " << origin.x;
      EXPECT_LE(list.worstErrorPx, frame.display.subdivisionErrorPx) << nameOf(camera);
      // What the list says of itself is what an independent measure finds.
      EXPECT_LT(worst, list.worstErrorPx + 0.01) << nameOf(camera);
    }
  }
}

TEST(DrawList, ACoarserBoundGivesFewerPiecesAndALargerError) {
  const Camera camera = wideAngleCamera(1920, 1080);
  FrameDescription frame = frameOf(camera, glm::dvec3(0), yard(glm::dvec3(0)));
  const DrawList fine = buildDrawList(frame, camera);
  frame.display.subdivisionErrorPx = 3;
  const DrawList coarse = buildDrawList(frame, camera);
  EXPECT_LT(coarse.triangles.size(), fine.triangles.size());
  EXPECT_GT(coarse.worstErrorPx, fine.worstErrorPx);
  int checked = 0;
  EXPECT_GT(worstEdgeError(frame, coarse, checked), 0.1) << "the measure must see a coarse list";
}

TEST(DrawList, APinholeNeedsNoSplits) {
  Intrinsics in = wideAngleCamera(1920, 1080).intrinsics();
  in.model = CameraModel::Pinhole;
  in.distortion = {};
  const Camera camera(in);
  BoxModel box(glm::dvec3(0));
  box.box({0, 0, 0}, {2, 2, 2}, {});
  const DrawList list = buildDrawList(frameOf(camera, glm::dvec3(0), box.made()), camera);
  EXPECT_EQ(list.triangles.size(), 36u);
  EXPECT_EQ(list.edges.size(), 24u);
  EXPECT_EQ(list.worstErrorPx, 0);
}

TEST(DrawList, NeighboursSplitTheirSharedEdgesIdentically) {
  for (const Camera& camera : camerasOfEveryModel()) {
    // A slab that fills the picture and stays inside of it: every inner edge must be met from both sides.
    BoxModel model(glm::dvec3(0));
    model.box({0, 0, 0}, {5, 3, 4}, {});
    const DrawList list = buildDrawList(frameOf(camera, glm::dvec3(0), model.made()), camera);
    const bool bends = camera.intrinsics().distortion.k[0] != 0;
    EXPECT_EQ(list.triangles.size() > 36, bends) << nameOf(camera);
    std::map<std::pair<Position, Position>, int> edges;
    for (std::size_t i = 0; i < list.triangles.size(); i += 3)
      for (int k = 0; k < 3; ++k)
        ++edges[{key(list.surface[list.triangles[i + k]].pInCamera),
                 key(list.surface[list.triangles[i + (k + 1) % 3]].pInCamera)}];
    int open = 0;
    for (const auto& [edge, count] : edges)
      if (const auto back = edges.find({edge.second, edge.first});
          back == edges.end() || back->second != count)
        ++open;
    EXPECT_EQ(open, 0) << nameOf(camera) << ": cracks in a closed box";
  }
}

TEST(DrawList, NothingIsDrawnBeyondTheFoldBackRadius) {
  // A strong barrel that turns back at r = 1.22, before the picture's corners.
  const auto in = Intrinsics::fromParameters(CameraModel::Radial, 1368, 912, {915, 684, 456, -0.26, 0.015});
  ASSERT_TRUE(in);
  const Camera camera(*in);
  ASSERT_NEAR(camera.foldBackRadius(), 1.22, 0.01);
  BoxModel model(glm::dvec3(0));
  model.box({0, 40, 0}, {400, 1, 400}, {200, 0, 0, 255});      // a wall across the whole view and far beyond
  model.box({0, -8, -2}, {200, 200, 0.1f}, {0, 200, 0, 255});  // a floor that passes under the camera
  const FrameDescription frame = frameOf(camera, glm::dvec3(0), model.made());
  const DrawList list = buildDrawList(frame, camera);
  ASSERT_GT(list.triangles.size(), 36u);
  const auto check = [&](const glm::vec3& p) {
    EXPECT_GT(p.z, 0);
    EXPECT_LE(std::hypot(p.x, p.y) / p.z, camera.foldBackRadius() * (1 + 1e-6));
  };
  for (const SurfaceVertex& v : list.surface) check(v.pInCamera);
  for (const EdgeVertex& v : list.edges) check(v.pInCamera);
}

TEST(DrawList, WhatStandsBehindOrBesideTheViewIsLeftOut) {
  const Camera camera = wideAngleCamera(640, 480);
  BoxModel model(glm::dvec3(0));
  model.box({0, -30, 0}, {2, 2, 2}, {}).box({200, 0, 0}, {2, 2, 2}, {}).box({0, 0, 0}, {1, 1, 1}, {});
  const DrawList list = buildDrawList(frameOf(camera, glm::dvec3(0), model.made()), camera);
  std::set<std::uint32_t> seen;
  for (const SurfaceVertex& v : list.surface) seen.insert(v.element);
  for (const EdgeVertex& v : list.edges) seen.insert(v.element);
  EXPECT_EQ(seen, std::set<std::uint32_t>{3});
}

TEST(DrawList, HiddenElementsAreLeftOutAndColoursAndSelectionReachTheStyles) {
  const Camera camera = wideAngleCamera(640, 480);
  BoxModel model(glm::dvec3(0));
  model.box({-1, 0, 0}, {1, 1, 1}, {10, 20, 30, 255}).box({1, 0, 0}, {1, 1, 1}, {40, 50, 60, 255});
  FrameDescription frame = frameOf(camera, glm::dvec3(0), model.made());
  frame.designs[0].elementVisible = {0, 1};
  frame.designs[0].elementColour = {{1, 2, 3, 255}, {255, 0, 0, 128}};
  frame.designs[0].selected = {1, 77};
  const DrawList list = buildDrawList(frame, camera);
  for (const SurfaceVertex& v : list.surface) EXPECT_EQ(v.element, 2u);
  ASSERT_EQ(list.styles.size(), 2u);
  EXPECT_FLOAT_EQ(list.styles[1].colour.r, 1.0f);
  EXPECT_NEAR(list.styles[1].colour.a, 0.5, 0.01);
  EXPECT_EQ(list.styles[0].selected, 0u);
  EXPECT_EQ(list.styles[1].selected, 1u);
}

TEST(DrawList, BrokenModelsAreDrawnWithoutTheirBrokenParts) {
  const Camera camera = wideAngleCamera(640, 480);
  auto model = std::make_shared<DesignModel>(*BoxModel(glm::dvec3(0)).box({0, 0, 0}, {1, 1, 1}, {}).made());
  model->triangles[0] = 4'000'000'000u;
  model->vertices[7].x = std::numeric_limits<float>::quiet_NaN();
  model->edges[0][1] = 99;
  model->elements.push_back(model->elements[0]);
  model->elements[1].indexCount = 4'000'000'000u;
  const DrawList list = buildDrawList(frameOf(camera, glm::dvec3(0), model), camera);
  for (const SurfaceVertex& v : list.surface) EXPECT_TRUE(std::isfinite(v.pInCamera.x));
  EXPECT_GT(list.triangles.size(), 0u);
  EXPECT_LT(list.triangles.size(), 72u * 1000);
}

TEST(DrawList, HostileSubdivisionStaysWithinItsBudget) {
  const Camera camera = camerasOfEveryModel().back();
  BoxModel model(glm::dvec3(0));
  for (int i = 0; i < 300; ++i) model.box({0, 20, 0}, {60, 0.1f, 60}, {});
  FrameDescription frame = frameOf(camera, glm::dvec3(0), model.made());
  frame.display.subdivisionErrorPx = 0;
  const DrawList list = buildDrawList(frame, camera);
  EXPECT_LT(list.triangles.size() / 3, 5'000'000u);
  EXPECT_GT(list.triangles.size() / 3, 10'000u);
}

}  // namespace alidade

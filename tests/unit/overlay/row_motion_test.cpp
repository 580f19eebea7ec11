// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "overlay/draw_list.h"
#include "unit/gpu/test_cameras.h"
#include "unit/overlay/scenes.h"

namespace alidade {

namespace {

const glm::dvec3 kOrigin(2'683'500.123, 1'247'800.321, 412.5);

Camera hdCamera() {
  return Camera(*Intrinsics::fromParameters(CameraModel::OpenCv5, 1920, 1080,
                                            {1150, 1150, 959.5, 539.5, -0.12, 0.03, 0.0005, -0.0004, -0.002}));
}

/// Turning by 60 degrees a second while walking, rows read for 30 ms: a picture sheared by dozens of pixels.
RollingShutter strong() { return {0.03, {{0.2, 1.0, 0.4}, {1.2, 0.1, 0.8}}}; }

FrameDescription frameOf(const RollingShutter& shutter) {
  BoxModel model(kOrigin);
  model.box({0, 0, 0}, {2, 1, 3}, {200, 80, 60, 255});
  model.box({-6, 3, 0}, {8, 0.3f, 4}, {90, 160, 220, 255});
  model.box({5, 8, 1}, {9, 6, 5}, {120, 200, 120, 255});
  model.box({0, -9, -1}, {30, 40, 0.2f}, {180, 180, 180, 255});  // reaches behind the camera
  FrameDescription frame;
  frame.camera = hdCamera();
  frame.cameraFromWorld = poseBefore(kOrigin);
  frame.designs.push_back({model.made(), {}, {}, {}});
  frame.shutter = shutter;
  return frame;
}

/// By brute force: walks over the rows and takes the one in which the point is seen when it is read.
std::optional<glm::dvec2> bruteForce(const FrameDescription& frame, const glm::dvec3& world) {
  double best = 0.02;
  std::optional<glm::dvec2> seen;
  double at = 0;
  const auto look = [&](double from, double to, double step) {
    double nearest = 1e9;
    at = from;
    for (double row = from; row <= to; row += step) {
      const auto pixel = frame.camera.project(frame.shutter.poseAtRow(frame.cameraFromWorld, row, 1080) * world);
      if (!pixel || std::abs(pixel->y - row) >= nearest) continue;
      nearest = std::abs(pixel->y - row);
      at = row;
      if (nearest < best) best = nearest, seen = pixel;
    }
  };
  look(-0.5, 1079.5, 12);
  for (const double step : {1.0, 0.1, 0.01}) look(at - 12 * step, at + 12 * step, step);
  return seen;
}

double distanceToSegment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 d = b - a;
  const double length2 = glm::dot(d, d);
  const double t = length2 > 0 ? std::clamp(glm::dot(p - a, d) / length2, 0.0, 1.0) : 0;
  return glm::length(p - (a + t * d));
}

}  // namespace

/// Points along every design edge, where each is seen by brute force, against the segments that a device is given.
TEST(RowMotion, DesignEdgesLieWhereTheirRowsSeeThem) {
  const FrameDescription frame = frameOf(strong());
  const DrawList list = buildDrawList(frame, frame.camera);
  std::vector<std::pair<glm::dvec2, glm::dvec2>> segments;
  for (std::size_t i = 0; i + 1 < list.edges.size(); i += 2) {
    const auto a = frame.camera.project(list.edges[i].pInCamera), b = frame.camera.project(list.edges[i + 1].pInCamera);
    if (a && b) segments.emplace_back(*a, *b);
  }
  const DesignModel& model = *frame.designs[0].model;
  double worst = 0, sheared = 0;
  int compared = 0;
  for (const auto& edge : model.edges) {
    const glm::dvec3 a = model.origin + glm::dvec3(model.vertices[edge[0]]), b = model.origin + glm::dvec3(model.vertices[edge[1]]);
    for (const double t : {0.0, 0.13, 0.37, 0.5, 0.71, 1.0}) {
      const glm::dvec3 world = a + t * (b - a);
      const auto truth = bruteForce(frame, world);
      if (!truth || !frame.camera.inPicture(*truth)) continue;
      double nearest = 1e9;
      for (const auto& [from, to] : segments) nearest = std::min(nearest, distanceToSegment(*truth, from, to));
      worst = std::max(worst, nearest);
      if (const auto still = frame.camera.project(frame.cameraFromWorld * world)) sheared = std::max(sheared, glm::length(*still - *truth));
      ++compared;
    }
  }
  EXPECT_GT(compared, 60);
  EXPECT_GT(sheared, 15) << "else the test would pass without a shutter";
  EXPECT_LT(worst, 0.1);
}

/// Every vertex of the model that is in the picture is a vertex of the list, within a tenth of a pixel of the truth.
TEST(RowMotion, DesignVerticesLieWhereTheirRowsSeeThem) {
  const FrameDescription frame = frameOf(strong());
  const DrawList list = buildDrawList(frame, frame.camera);
  std::vector<glm::dvec2> drawn;
  for (const SurfaceVertex& vertex : list.surface)
    if (const auto pixel = frame.camera.project(vertex.pInCamera)) drawn.push_back(*pixel);
  EXPECT_LT(drawn.size(), 60000u) << "cut without end";
  const DesignModel& model = *frame.designs[0].model;
  int compared = 0;
  for (const glm::vec3& vertex : model.vertices) {
    const auto truth = bruteForce(frame, model.origin + glm::dvec3(vertex));
    if (!truth || !frame.camera.inPicture(*truth)) continue;
    double nearest = 1e9;
    for (const glm::dvec2& pixel : drawn) nearest = std::min(nearest, glm::length(pixel - *truth));
    EXPECT_LT(nearest, 0.1);
    ++compared;
  }
  EXPECT_GT(compared, 8);
}

TEST(RowMotion, AGlobalShutterDrawsTheSameListAsBefore) {
  FrameDescription still = frameOf({}), standing = frameOf({0.03, {}});
  const DrawList a = buildDrawList(still, still.camera), b = buildDrawList(standing, standing.camera);
  ASSERT_EQ(a.surface.size(), b.surface.size());
  for (std::size_t i = 0; i < a.surface.size(); ++i) EXPECT_EQ(a.surface[i].pInCamera, b.surface[i].pInCamera);
  EXPECT_EQ(a.triangles, b.triangles);
}

/// Neighbours stay joined: the surface of a box has as many open edges as without a shutter, none inside the picture.
TEST(RowMotion, PiecesStayJoined) {
  BoxModel model(kOrigin);
  model.box({0, 2, 0}, {5, 5, 3}, {200, 80, 60, 255});
  FrameDescription frame = frameOf(strong());
  frame.designs = {{model.made(), {}, {}, {}}};
  const DrawList list = buildDrawList(frame, frame.camera);
  ASSERT_GT(list.triangles.size() / 3, 12u);
  // By place, because corners of different faces are vertices of their own.
  using Place = std::tuple<float, float, float>;
  const auto place = [&](std::uint32_t i) {
    const glm::vec3& p = list.surface[i].pInCamera;
    return Place{p.x, p.y, p.z};
  };
  std::multiset<std::pair<Place, Place>> open;
  for (std::size_t i = 0; i < list.triangles.size(); i += 3)
    for (int k = 0; k < 3; ++k) {
      const Place a = place(list.triangles[i + static_cast<std::size_t>(k)]), b = place(list.triangles[i + static_cast<std::size_t>((k + 1) % 3)]);
      if (const auto opposite = open.find({b, a}); opposite != open.end()) open.erase(opposite);
      else open.insert({a, b});
    }
  int inside = 0;
  for (const auto& [a, b] : open) {
    const glm::dvec3 middle = 0.5 * (glm::dvec3(std::get<0>(a), std::get<1>(a), std::get<2>(a)) + glm::dvec3(std::get<0>(b), std::get<1>(b), std::get<2>(b)));
    const auto pixel = frame.camera.project(middle);
    inside += pixel && pixel->x > 5 && pixel->y > 5 && pixel->x < 1914 && pixel->y < 1074;
  }
  EXPECT_EQ(inside, 0);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Real photographs with a published reconstruction (gtsfm's lund_door, COLMAP text model).

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <sstream>

#include <gtest/gtest.h>

#include "geometry/rigid_transform.h"
#include "lenses.h"

namespace alidade {
namespace {

std::vector<std::string> linesOf(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);)
    if (line.empty() || line[0] != '#') lines.push_back(line);
  return lines;
}

TEST(LundDoor, PointsLandOnTheirObservationsWithThePublishedResidual) {
  const std::filesystem::path folder = std::filesystem::path(ALIDADE_SHARED_DATA_DIR) / "lund_door/colmap_ground_truth";
  if (!std::filesystem::exists(folder / "images.txt")) GTEST_SKIP() << "needs the lund_door data at " << folder;

  std::istringstream cameraLine(linesOf(folder / "cameras.txt").front());
  std::string id, model;
  int width = 0, height = 0;
  double f = 0, cx = 0, cy = 0, k = 0;
  cameraLine >> id >> model >> width >> height >> f >> cx >> cy >> k;
  ASSERT_EQ(model, "SIMPLE_RADIAL");
  // COLMAP counts pixels from the picture's corner, OpenCV from the first pixel's centre.
  const Camera camera(made(CameraModel::SimpleRadial, width, height, {f, cx - 0.5, cy - 0.5, k}));

  // COLMAP keeps the mean reprojection error of every point beside it.
  std::map<long, glm::dvec3> points;
  std::map<long, double> published;
  for (const std::string& line : linesOf(folder / "points3D.txt")) {
    std::istringstream in(line);
    long point = 0;
    glm::dvec3 p;
    int red = 0, green = 0, blue = 0;
    double error = 0;
    if (!(in >> point >> p.x >> p.y >> p.z >> red >> green >> blue >> error)) continue;
    points[point] = p;
    published[point] = error;
  }
  ASSERT_EQ(points.size(), 11384u);

  std::map<long, std::vector<double>> residuals;
  int observations = 0;
  const std::vector<std::string> images = linesOf(folder / "images.txt");
  for (std::size_t i = 0; i + 1 < images.size(); i += 2) {
    std::istringstream pose(images[i]), tracks(images[i + 1]);
    RigidTransform cameraFromWorld;
    glm::dquat& q = cameraFromWorld.rotation;
    glm::dvec3& t = cameraFromWorld.translation;
    pose >> id >> q.w >> q.x >> q.y >> q.z >> t.x >> t.y >> t.z;
    double u = 0, v = 0;
    for (long point = 0; tracks >> u >> v >> point;) {
      const auto found = points.find(point);
      if (found == points.end()) continue;
      const auto pixel = camera.project(cameraFromWorld * found->second);
      ASSERT_TRUE(pixel);
      residuals[point].push_back(glm::length(*pixel - glm::dvec2(u - 0.5, v - 0.5)));
      ++observations;
    }
  }
  ASSERT_GT(observations, 70000);

  std::vector<double> means;
  for (const auto& [point, errors] : residuals) {
    const double mean = std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
    // The file rounds its focal length to six digits: 0.003 px at the picture's border.
    EXPECT_NEAR(mean, published[point], 0.005) << "point " << point;
    means.push_back(mean);
  }
  std::nth_element(means.begin(), means.begin() + means.size() / 2, means.end());
  const double median = means[means.size() / 2];
  EXPECT_GE(median, 0.23);
  EXPECT_LE(median, 0.25);
}

}  // namespace
}  // namespace alidade

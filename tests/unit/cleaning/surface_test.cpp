// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cleaning/surface.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <unistd.h>

using namespace alidade;
using ::testing::HasSubstr;

namespace {

const glm::dvec3 kSurvey(2683500, 1247800, 412);

struct Ball {
  std::vector<glm::dvec3> points;
  std::vector<glm::vec3> normals;
};

/// A sphere of 2 m radius, its points even (Fibonacci's spiral).
Ball ball(int count) {
  Ball made;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, angle = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
    const glm::dvec3 n(r * std::cos(angle), r * std::sin(angle), z);
    made.points.push_back(kSurvey + 2.0 * n);
    made.normals.push_back(glm::vec3(n));
  }
  return made;
}

double area(const SurfaceMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += 0.5 * glm::length(glm::cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]));
  return sum;
}

}  // namespace

TEST(Surface, GreedyAndPoissonCoverASphere) {
  const Ball b = ball(8000);
  const double truth = 4 * M_PI * 4;
  const auto greedy = meshGreedily(b.points, b.normals, {0.3}, Progress());
  ASSERT_TRUE(greedy) << greedy.error().text();
  EXPECT_EQ(greedy->vertices, b.points);  // joins the points themselves
  EXPECT_NEAR(area(*greedy) / truth, 1, 0.03);
  const auto poisson = meshByPoisson(b.points, b.normals, {6}, Progress());
  ASSERT_TRUE(poisson) << poisson.error().text();
  EXPECT_NEAR(area(*poisson) / truth, 1, 0.03);
  for (const auto& p : poisson->vertices) EXPECT_NEAR(glm::distance(p, kSurvey), 2, 0.02);
}

TEST(Surface, FilesKeepSurveyCoordinates) {
  SurfaceMesh mesh{{kSurvey, kSurvey + glm::dvec3(1.00001, 0, 0), kSurvey + glm::dvec3(0, 1, 0)}, {{0, 1, 2}}};
  const std::string stem = (std::filesystem::temp_directory_path() / ("alidade_surface_" + std::to_string(::getpid()))).string();
  const auto read = [](const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    std::filesystem::remove(path);
    return text.str();
  };
  ASSERT_TRUE(writeSurface(mesh, stem + ".obj"));
  EXPECT_EQ(read(stem + ".obj"), "v 2683500.00000 1247800.00000 412.00000\nv 2683501.00001 1247800.00000 412.00000\n"
                                 "v 2683500.00000 1247801.00000 412.00000\nf 1 2 3\n");
  ASSERT_TRUE(writeSurface(mesh, stem + ".ply"));
  const std::string ply = read(stem + ".ply");
  const auto body = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size() - body, 3 * 24 + 13u);
  double x = 0;
  std::memcpy(&x, &ply[body + 24], 8);
  EXPECT_EQ(x, 2683501.00001);
  EXPECT_THAT(writeSurface(mesh, "/nowhere/at/all.ply").error().what, HasSubstr("cannot be written"));
  EXPECT_THAT(writeSurface(mesh, "x.stl").error().what, HasSubstr(".ply or .obj"));
}

TEST(Surface, WhatCannotBeMeshedIsRefused) {
  const Ball b = ball(50);
  EXPECT_FALSE(meshGreedily(b.points, {}, {}, Progress()));
  EXPECT_FALSE(meshGreedily(b.points, b.normals, {0}, Progress()));
  EXPECT_FALSE(meshByPoisson(b.points, b.normals, {40}, Progress()));
  EXPECT_FALSE(meshByPoisson({}, {}, {}, Progress()));
}

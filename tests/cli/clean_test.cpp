// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Cleaning, registering and meshing scans of known shape.

#include <cmath>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command_line.h"

namespace alidade::test {

namespace {

constexpr double kEast = 2683500, kNorth = 1247800, kHeight = 412;

/// A floor and two walls of a room with 1 mm of noise, then ten points in the air; turned by `angle` about the room's
/// corner and shifted.
std::filesystem::path writeRoom(const std::string& name, unsigned seed, double angle, double shift) {
  const auto path = scratch() / name;
  std::ofstream out(path);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> along(0, 8), up(0, 3);
  std::normal_distribution<double> noise(0, 0.001);
  const auto put = [&](double x, double y, double z) {
    char line[100];
    std::snprintf(line, sizeof line, "%.4f %.4f %.4f\n", kEast + std::cos(angle) * x - std::sin(angle) * y + shift,
                  kNorth + std::sin(angle) * x + std::cos(angle) * y, kHeight + z);
    out << line;
  };
  for (int i = 0; i < 12000; ++i) put(along(random), along(random), noise(random));
  for (int i = 0; i < 6000; ++i) put(along(random), noise(random), up(random));
  for (int i = 0; i < 6000; ++i) put(noise(random), along(random), up(random));
  for (int i = 0; i < 10; ++i) put(4 + 0.3 * i, 4, 9 + i);
  return path;
}

}  // namespace

TEST(Clean, DropsThePointsInTheAirAndWritesLas) {
  const auto room = writeRoom("clean_room.xyz", 1, 0, 0);
  const auto target = scratch() / "cleaned.las";
  const auto cleaned = alidadeCli("clean --json " + quoted(room) + " -o " + quoted(target) + " --radius 1,3 --voxel 0.25 --ground --normals");
  ASSERT_EQ(cleaned.exitCode, 0) << cleaned.errors;
  const auto json = cleaned.json();
  EXPECT_EQ(json["points_read"], 24010);
  EXPECT_EQ(json["lonely"], 10);
  // 32 × 32 cubes of floor, 32 × 12 of each wall; noise about a cube's border doubles some.
  const int written = json["points_written"];
  EXPECT_GT(written, 32 * 32 + 2 * 32 * 12 - 100);
  EXPECT_LT(written, 2 * (32 * 32 + 2 * 32 * 12));
  EXPECT_GT(json["ground"], 32 * 32 / 2);
  const auto info = alidadeCli("info --json " + quoted(target));
  ASSERT_EQ(info.exitCode, 0) << info.errors;
  const auto file = info.json()["files"][0];
  EXPECT_EQ(file["points"], written);
  EXPECT_LT(file["bounds_m"]["max"][2], kHeight + 3.01);
  EXPECT_NEAR(file["bounds_m"]["min"][0], kEast, 0.3);
  // Nothing is replaced unasked, nor in place.
  EXPECT_EQ(alidadeCli("clean " + quoted(room) + " -o " + quoted(target) + " --voxel 1").exitCode, 1);
  EXPECT_EQ(alidadeCli("clean --overwrite " + quoted(target) + " -o " + quoted(target) + " --voxel 1").exitCode, 1);
  EXPECT_EQ(alidadeCli("clean " + quoted(room) + " -o x.las --outliers eight").exitCode, 2);
}

TEST(Register, FindsTheTurnBetweenTwoScans) {
  const auto fixed = writeRoom("fixed.xyz", 2, 0, 0), moving = writeRoom("moving.xyz", 3, -0.01, 0.05);
  const auto found = alidadeCli("register --json " + quoted(moving) + " " + quoted(fixed));
  ASSERT_EQ(found.exitCode, 0) << found.errors;
  const auto json = found.json();
  const double w = json["fixed_from_moving_wxyz"][0], z = json["fixed_from_moving_wxyz"][3];
  EXPECT_NEAR(2 * std::atan2(z, w), 0.01, 2e-5);
  EXPECT_LT(json["rms_plane_m"], 0.005);
  EXPECT_NEAR(json["shift_m"][0], -0.05 - 4 * 0.01, 0.005);  // of the middle, 4 m off the corner it turns about
  EXPECT_GT(json["share"], 0.9);
  const auto far = writeRoom("far.xyz", 4, 0, 50);
  const auto refused = alidadeCli("register --json " + quoted(far) + " " + quoted(fixed));
  EXPECT_EQ(refused.exitCode, 1);
  EXPECT_THAT(std::string(refused.json()["error"]["what"]), testing::HasSubstr("find a partner"));
}

TEST(Mesh, GreedyAndPoissonWriteSurfaces) {
  const auto room = writeRoom("mesh_room.xyz", 5, 0, 0);
  const auto greedy = alidadeCli("mesh --json " + quoted(room) + " -o " + quoted(scratch() / "room.ply") + " --voxel 0.2 --greedy 0.6");
  ASSERT_EQ(greedy.exitCode, 0) << greedy.errors;
  EXPECT_GT(greedy.json()["triangles"], 1000);
  const auto poisson = alidadeCli("mesh --json " + quoted(room) + " -o " + quoted(scratch() / "room.obj") + " --poisson 6");
  ASSERT_EQ(poisson.exitCode, 0) << poisson.errors;
  EXPECT_GT(poisson.json()["triangles"], 500);
  EXPECT_EQ(alidadeCli("mesh " + quoted(room) + " -o " + quoted(scratch() / "none.ply")).exitCode, 1);
}

}  // namespace alidade::test

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>

#include "demo_fixture.h"

namespace alidade {
namespace {

using namespace demo_test;
using nlohmann::json;

struct ScanPoint {
  glm::dvec3 position;
  std::uint16_t station;
  std::uint8_t classification;
  std::uint32_t row, column;
};

std::vector<ScanPoint> readScan(const std::string& las) {
  const auto offset = valueAt<std::uint32_t>(las, 96);
  const auto size = valueAt<std::uint16_t>(las, 105);
  const auto count = valueAt<std::uint64_t>(las, 247);
  std::vector<ScanPoint> points;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::size_t at = offset + i * size;
    ScanPoint p;
    for (int axis = 0; axis < 3; ++axis)
      p.position[axis] = valueAt<std::int32_t>(las, at + 4 * axis) * valueAt<double>(las, 131 + 8 * axis) +
                         valueAt<double>(las, 155 + 8 * axis);
    p.classification = valueAt<std::uint8_t>(las, at + 16);
    p.station = valueAt<std::uint16_t>(las, at + 20);
    p.row = valueAt<std::uint32_t>(las, at + 36);
    p.column = valueAt<std::uint32_t>(las, at + 40);
    points.push_back(p);
  }
  return points;
}

/// A prism of truth.json: its frame and its outline.
struct Box {
  glm::dvec3 origin, x, y, z, low, high;
  explicit Box(const json& prism)
      : origin(vectorOf(prism.at("origin_m"))),
        x(vectorOf(prism.at("x_axis"))),
        y(vectorOf(prism.at("y_axis"))),
        z(vectorOf(prism.at("z_axis"))) {
    const auto& low2 = prism.at("outline").at("low_m");
    const auto& high2 = prism.at("outline").at("high_m");
    low = {low2.at(0), low2.at(1), 0.0};
    high = {high2.at(0), high2.at(1), prism.at("depth_m").get<double>()};
  }
  glm::dvec3 local(const glm::dvec3& p) const {
    return {glm::dot(p - origin, x), glm::dot(p - origin, y), glm::dot(p - origin, z)};
  }
  /// Signed distance to the surface, negative inside.
  double distance(const glm::dvec3& p) const {
    const glm::dvec3 d = glm::max(low - local(p), local(p) - high);
    return glm::length(glm::max(d, 0.0)) + std::min(0.0, std::max({d.x, d.y, d.z}));
  }
};

TEST_F(DemoSiteTest, ScanIsValidLas14OfPointFormat7) {
  const std::string las = bytesOf(site().scan);
  ASSERT_GT(las.size(), 375u);
  EXPECT_EQ(las.substr(0, 4), "LASF");
  EXPECT_EQ(las[24], 1);
  EXPECT_EQ(las[25], 4);
  EXPECT_EQ(valueAt<std::uint16_t>(las, 6) & 0x11, 0x11) << "GPS time and WKT bits";
  EXPECT_EQ(valueAt<std::uint16_t>(las, 94), 375);
  EXPECT_EQ(las[104], 7);
  EXPECT_EQ(valueAt<std::uint16_t>(las, 105), 44);
  EXPECT_EQ(valueAt<std::uint32_t>(las, 107), 0u) << "legacy count";
  EXPECT_EQ(valueAt<std::uint64_t>(las, 247), site().pointCount);
  EXPECT_EQ(valueAt<std::uint64_t>(las, 255), site().pointCount) << "first returns";
  const auto offset = valueAt<std::uint32_t>(las, 96);
  EXPECT_EQ(las.size(), offset + 44 * site().pointCount);
  // The VLRs fill the space between header and points exactly.
  std::size_t at = 375;
  for (std::uint32_t i = 0; i < valueAt<std::uint32_t>(las, 100); ++i)
    at += 54 + valueAt<std::uint16_t>(las, at + 20);
  EXPECT_EQ(at, offset);
  EXPECT_NE(las.find("CH1903+ / LV95"), std::string::npos);
  EXPECT_NE(las.substr(0, offset).find("\"world_from_scanner\""), std::string::npos);
}

TEST_F(DemoSiteTest, ScanHeaderBoundsHoldEveryPointTightly) {
  const std::string las = bytesOf(site().scan);
  glm::dvec3 low(1e300), high(-1e300);
  for (const auto& p : readScan(las)) {
    low = glm::min(low, p.position);
    high = glm::max(high, p.position);
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(valueAt<double>(las, 179 + 16 * axis), high[axis], 1e-6);
    EXPECT_NEAR(valueAt<double>(las, 187 + 16 * axis), low[axis], 1e-6);
  }
}

TEST_F(DemoSiteTest, ScanHasAboutAsManyPointsAsAskedFor) {
  EXPECT_NEAR(static_cast<double>(site().pointCount), 10'000.0, 800.0);
}

TEST_F(DemoSiteTest, EveryPointLiesOnTheRayOfItsRowAndColumn) {
  const auto points = readScan(bytesOf(site().scan));
  const auto& scan = truth().at("scan");
  const double high = scan.at("highest_elevation_rad"), low = scan.at("lowest_elevation_rad");
  for (const auto& p : points) {
    const auto& station = scan.at("stations").at(p.station - 1);
    const double rows = station.at("rows"), columns = station.at("columns");
    const glm::dvec3 local = transformOf(station.at("world_from_scanner")).inverse() * p.position;
    const double elevation = high - (p.row + 0.5) * (high - low) / rows;
    const double azimuth = 2 * M_PI * (p.column + 0.5) / columns;
    const glm::dvec3 direction(std::cos(elevation) * std::cos(azimuth),
                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    // Only the rounding to 0.1 mm takes a point off its ray.
    ASSERT_LT(glm::length(local - glm::dot(local, direction) * direction), 1.2e-4);
  }
}

TEST_F(DemoSiteTest, PointsOnTheSlabLieOnItsPlaneWithinTheRangeNoise) {
  const Box slab(element("Slab ground floor").at("prism"));
  double sum = 0, squares = 0;
  int count = 0;
  for (const auto& p : readScan(bytesOf(site().scan))) {
    const glm::dvec3 local = slab.local(p.position);
    // A mixed pixel carries class 1; props, walls and bars stand on the slab: only what is near its top
    // counts.
    if (p.classification != 6 || std::abs(local.z - slab.high.z) > 0.03) continue;
    if (glm::any(glm::lessThan(glm::dvec2(local), glm::dvec2(slab.low) + 0.3)) ||
        glm::any(glm::greaterThan(glm::dvec2(local), glm::dvec2(slab.high) - 0.3)))
      continue;
    sum += local.z - slab.high.z;
    squares += (local.z - slab.high.z) * (local.z - slab.high.z);
    ++count;
  }
  ASSERT_GT(count, 200);
  EXPECT_NEAR(sum / count, 0.0, 0.0006);
  EXPECT_LT(std::sqrt(squares / count), 0.004);
  EXPECT_GT(std::sqrt(squares / count), 0.0002) << "a scan without noise is no scan";
}

TEST_F(DemoSiteTest, PointsClassedAsBuildingLieOnTheDesignButForTheDefects) {
  std::vector<std::string> defective;
  for (const auto& defect : truth().at("defects")) defective.push_back(defect.at("element"));
  std::vector<Box> sound, all;
  for (const auto& one : truth().at("elements")) {
    if (!one.at("prism").contains("outline")) continue;
    all.emplace_back(one.at("prism"));
    if (std::find(defective.begin(), defective.end(), one.at("name")) == defective.end())
      sound.emplace_back(one.at("prism"));
  }
  int off = 0, count = 0;
  for (const auto& p : readScan(bytesOf(site().scan))) {
    if (p.classification != 6) continue;
    double nearest = 1e9;
    for (const Box& box : all) nearest = std::min(nearest, std::abs(box.distance(p.position)));
    ++count;
    // Reveals of openings, manholes and pipes have no box of their own here.
    off += nearest > 0.012;
  }
  ASSERT_GT(count, 2000);
  EXPECT_LT(off, 0.06 * count);
}

TEST_F(DemoSiteTest, TheShiftedColumnStandsWhereTruthSaysAndNotWhereTheDesignSays) {
  DemoOptions options = smallOptions();
  options.points = 300'000;
  options.frames = 0;
  const std::string folder = freshFolder("dense");
  const auto dense = writeDemoSite(folder, options, Progress());
  ASSERT_TRUE(dense) << dense.error().text();
  json shifted, tilted;
  for (const auto& defect : truth().at("defects")) {
    if (defect.at("kind") == "shifted") shifted = defect;
    if (defect.at("kind") == "tilted") tilted = defect;
  }
  const glm::dvec3 shift = vectorOf(shifted.at("shift_world_m"));
  const Box designed(element(shifted.at("element")).at("prism"));
  Box built = designed;
  built.origin += shift;
  const Box wall(element(tilted.at("element")).at("prism"));
  const glm::dvec3 axisPoint = vectorOf(tilted.at("axis_point_m")),
                   axis = vectorOf(tilted.at("axis_direction"));
  const glm::dquat untilt = glm::angleAxis(-tilted.at("tilt_rad").get<double>(), axis);
  int near = 0, onBuilt = 0, onDesigned = 0, onTilted = 0, nearWall = 0;
  for (const auto& p : readScan(bytesOf(dense->scan))) {
    if (p.classification != 6) continue;
    const double height = built.local(p.position).z;
    if (height > 0.9 && height < 2.7 && built.distance(p.position) < 0.012 &&
        built.distance(p.position) > -0.15) {
      ++near;
      onBuilt += std::abs(built.distance(p.position)) < 0.008;
      onDesigned += std::abs(designed.distance(p.position)) < 0.008;
    }
    const glm::dvec3 upright = axisPoint + untilt * (p.position - axisPoint);
    const glm::dvec3 local = wall.local(upright);
    if (local.x < 0.3 || local.x > wall.high.x - 0.3 || local.y < 0.6 * wall.high.y ||
        local.y > wall.high.y - 0.05 || std::abs(local.z - 0.5 * wall.high.z) > 0.5 * wall.high.z + 0.02)
      continue;
    if (std::abs(local.z - 0.5 * wall.high.z) < 0.5 * wall.high.z - 0.02) continue;  // a reveal
    ++nearWall;
    onTilted += std::min(std::abs(local.z), std::abs(local.z - wall.high.z)) < 0.008;
  }
  ASSERT_GT(near, 100);
  EXPECT_GT(onBuilt, 0.95 * near);
  EXPECT_LT(onDesigned, 0.5 * near);
  ASSERT_GT(nearWall, 30);
  EXPECT_GT(onTilted, 0.95 * nearWall);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace alidade

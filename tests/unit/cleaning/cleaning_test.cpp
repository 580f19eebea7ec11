// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cleaning/cleaning.h"

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_types.h>

#include "cleaning/point_tiles.h"

using namespace alidade;
using ::testing::HasSubstr;

namespace {

const glm::dvec3 kSurvey(2683500, 1247800, 412);  // LV95: where float has 0.25 m steps

std::vector<glm::dvec3> cube(std::size_t count, double edge, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> at(0, edge);
  std::vector<glm::dvec3> points(count);
  for (auto& p : points) p = {at(random), at(random), at(random)};
  return points;
}

std::vector<glm::dvec3> plane(std::size_t count, double edge, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> at(0, edge);
  std::normal_distribution<double> up(0, noise);
  std::vector<glm::dvec3> points(count);
  for (auto& p : points) p = {at(random), at(random), noise > 0 ? up(random) : 0.0};
  return points;
}

std::vector<glm::dvec3> moved(std::vector<glm::dvec3> points, const glm::dvec3& by) {
  for (auto& p : points) p += by;
  return points;
}

std::size_t sum(const KeepMask& mask) {
  std::size_t kept = 0;
  for (const auto each : mask) kept += each;
  return kept;
}

}  // namespace

TEST(PointTiles, HoldEveryPointOnceAndAllNeighboursWithinTheMargin) {
  const auto points = cube(5000, 10, 1);
  for (const bool planar : {false, true}) {
    const PointTiles tiles(points, 300, planar);
    std::vector<int> seen(points.size());
    for (std::size_t t = 0; t < tiles.count(); ++t) {
      EXPECT_LE(tiles.own(t).size(), 300u);
      const auto around = tiles.around(t, 0.7);
      std::vector<int> here(points.size());
      for (const auto index : around) ++here[index];
      for (const auto index : tiles.own(t)) {
        ++seen[index];
        if (index % 7 != 0) continue;
        for (std::size_t other = 0; other < points.size(); ++other) {
          const glm::dvec3 gap = points[other] - points[index];
          const double distance = planar ? std::hypot(gap.x, gap.y) : glm::length(gap);
          EXPECT_TRUE(distance > 0.7 || here[other] == 1);
        }
      }
    }
    EXPECT_THAT(seen, ::testing::Each(1));
  }
}

TEST(Thinning, KeepsOnePointOfEachVoxelTheOneNearestToItsMean) {
  const auto points = moved(cube(3000, 2, 2), kSurvey);
  const auto keep = thinByVoxel(points, 0.25, Progress());
  ASSERT_TRUE(keep);
  glm::dvec3 low(1e99);
  for (const auto& p : points) low = glm::min(low, p);
  std::map<std::array<int, 3>, std::vector<std::size_t>> voxels;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 cell = glm::floor((points[i] - low) / 0.25);
    voxels[{int(cell.x), int(cell.y), int(cell.z)}].push_back(i);
  }
  EXPECT_EQ(sum(*keep), voxels.size());
  for (const auto& [voxel, members] : voxels) {
    glm::dvec3 mean(0);
    for (const auto i : members) mean += (points[i] - kSurvey) / double(members.size());
    std::size_t kept = members.size();
    double least = 1e99;
    for (const auto i : members) {
      least = std::min(least, glm::distance(points[i] - kSurvey, mean));
      if ((*keep)[i]) kept = i;
    }
    ASSERT_LT(kept, points.size());
    EXPECT_NEAR(glm::distance(points[kept] - kSurvey, mean), least, 1e-8);
  }
}

TEST(Outliers, StatisticalRemovalAgreesWithPclsOwnFilter) {
  auto points = plane(20000, 20, 0.005, 3);
  const auto loose = cube(300, 20, 4);
  points.insert(points.end(), loose.begin(), loose.end());
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const auto& p : points) cloud->points.emplace_back(float(p.x), float(p.y), float(p.z));
  cloud->width = std::uint32_t(points.size());
  cloud->height = 1;
  pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
  filter.setInputCloud(cloud);
  filter.setMeanK(8);
  filter.setStddevMulThresh(1.0);
  pcl::Indices kept;
  filter.filter(kept);
  const auto keep = removeStatisticalOutliers(points, {8, 1.0}, Progress());
  ASSERT_TRUE(keep);
  KeepMask theirs(points.size(), 0);
  for (const int i : kept) theirs[std::size_t(i)] = 1;
  std::size_t differences = 0;
  for (std::size_t i = 0; i < points.size(); ++i) differences += (*keep)[i] != theirs[i];
  EXPECT_LE(differences, 3u);  // float sums against double ones, at the threshold itself
  // Survey coordinates change nothing.
  const auto far = removeStatisticalOutliers(moved(points, kSurvey), {8, 1.0}, Progress());
  ASSERT_TRUE(far);
  differences = 0;
  for (std::size_t i = 0; i < points.size(); ++i) differences += (*keep)[i] != (*far)[i];
  EXPECT_LE(differences, 3u);
}

TEST(Outliers, PointsOffAPlaneGoAndThePlaneStaysOverManyTiles) {
  auto points = plane(450000, 60, 0.002, 5);
  const std::size_t good = points.size();
  for (int i = 0; i < 400; ++i) points.push_back({0.15 * i, 30, 2 + 0.01 * (i % 50)});
  const auto keep = removeStatisticalOutliers(moved(points, kSurvey), {8, 3.0}, Progress());
  ASSERT_TRUE(keep);
  std::size_t lost = 0, left = 0;
  for (std::size_t i = 0; i < points.size(); ++i) (i < good ? lost : left) += i < good ? !(*keep)[i] : (*keep)[i];
  EXPECT_EQ(left, 0u);
  EXPECT_LT(lost, good / 50);
}

TEST(Outliers, TheRadiusCountsTheOthersWithinIt) {
  const auto points = cube(3000, 3, 6);
  const auto keep = removeRadiusOutliers(moved(points, kSurvey), {0.3, 9}, Progress());
  ASSERT_TRUE(keep);
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    int others = 0;
    bool close = false;  // to the radius itself: float may say either
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double d = glm::distance(points[i], points[k]);
      others += k != i && d <= 0.3;
      close = close || std::abs(d - 0.3) < 1e-5;
    }
    EXPECT_TRUE(close || bool((*keep)[i]) == (others >= 9)) << i;
    dropped += !(*keep)[i];
  }
  EXPECT_GT(dropped, 100u);
  EXPECT_LT(dropped, 2900u);
}

TEST(Normals, OfATiltedPlaneAndASphereLookToTheirStation) {
  std::vector<glm::dvec3> points = plane(250000, 50, 0, 7);  // two tiles
  const glm::dvec3 up = glm::normalize(glm::dvec3(-0.3, 0.2, 1));
  for (auto& p : points) p.z = 0.3 * p.x - 0.2 * p.y;
  const std::vector<glm::dvec3> stations = {kSurvey + glm::dvec3(25, 25, 100), kSurvey + glm::dvec3(25, 25, -100)};
  std::vector<std::uint16_t> seenFrom(points.size());
  for (std::size_t i = 0; i < seenFrom.size(); ++i) seenFrom[i] = i % 2;
  const auto normals = estimateNormals(moved(points, kSurvey), stations, seenFrom, {}, Progress());
  ASSERT_TRUE(normals);
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_GT(glm::dot(glm::dvec3((*normals)[i]), i % 2 == 0 ? up : -up), 0.9999) << i;

  std::mt19937_64 random(8);
  std::normal_distribution<double> any;
  std::vector<glm::dvec3> ball(20000);
  for (auto& p : ball) p = 5.0 * glm::normalize(glm::dvec3(any(random), any(random), any(random)));
  const auto out = estimateNormals(ball, std::vector<glm::dvec3>{glm::dvec3(0)}, {}, {}, Progress());
  ASSERT_TRUE(out);
  for (std::size_t i = 0; i < ball.size(); ++i) ASSERT_LT(glm::dot(glm::dvec3((*out)[i]), ball[i] / 5.0), -0.99);
}

TEST(Ground, ASlopeStaysAndItsHousesGo) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> at(0, 60);
  std::normal_distribution<double> noise(0, 0.01);
  std::vector<glm::dvec3> points;
  std::vector<bool> house;
  const auto ground = [](double x, double y) { return 0.1 * x + 0.3 * std::sin(y / 10); };
  for (int i = 0; i < 120000; ++i) {
    const double x = at(random), y = at(random);
    const bool roof = (x > 10 && x < 20 && y > 10 && y < 22) || (x > 35 && x < 44 && y > 30 && y < 40);
    points.push_back(kSurvey + glm::dvec3(x, y, ground(x, y) + (roof ? 5 : 0) + noise(random)));
    house.push_back(roof);
  }
  const auto mask = classifyGround(points, {}, Progress());
  ASSERT_TRUE(mask);
  double found = 0, all = 0, wrong = 0, roofs = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    (house[i] ? roofs : all) += 1;
    (house[i] ? wrong : found) += (*mask)[i];
  }
  EXPECT_GT(found / all, 0.97);
  EXPECT_EQ(wrong, 0) << "of " << roofs;
}

TEST(Cleaning, OptionsThatMakeNoSenseAreRefused) {
  const std::vector<glm::dvec3> points = {{0, 0, 0}, {1, 0, 0}, {1e7, 0, 0}};
  EXPECT_THAT(thinByVoxel(points, 0, Progress()).error().what, HasSubstr("edge of 0 m"));
  EXPECT_THAT(thinByVoxel(points, NAN, Progress()).error().what, HasSubstr("edge"));
  EXPECT_THAT(thinByVoxel(points, 0.001, Progress()).error().what, HasSubstr("too small"));
  EXPECT_FALSE(removeStatisticalOutliers(points, {0, 1}, Progress()));
  EXPECT_FALSE(removeRadiusOutliers(points, {-1, 1}, Progress()));
  EXPECT_FALSE(estimateNormals(points, {}, {}, {2}, Progress()));
  EXPECT_THAT(classifyGround(points, {.cellMeters = 1e-4}, Progress()).error().what, HasSubstr("too small"));
  EXPECT_FALSE(classifyGround(points, {.cellMeters = 1, .largestWindowMeters = 0.5}, Progress()));
}

TEST(Cleaning, NothingAndOnePointAreNoFault) {
  for (const std::vector<glm::dvec3>& points : {std::vector<glm::dvec3>{}, std::vector<glm::dvec3>{{1, 2, 3}}, std::vector<glm::dvec3>(500, {1, 2, 3})}) {
    EXPECT_EQ(sum(*thinByVoxel(points, 1, Progress())), points.empty() ? 0u : 1u);
    EXPECT_TRUE(removeStatisticalOutliers(points, {}, Progress()));
    EXPECT_TRUE(removeRadiusOutliers(points, {}, Progress()));
    EXPECT_TRUE(estimateNormals(points, {}, {}, {}, Progress()));
    EXPECT_TRUE(classifyGround(points, {}, Progress()));
  }
  Progress cancelled;
  cancelled.cancel();
  EXPECT_TRUE(isCancelled(removeRadiusOutliers(plane(10, 1, 0, 1), {}, cancelled).error()));
}

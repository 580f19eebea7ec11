// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bundler/bundler_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {

namespace fs = std::filesystem;
using testing::HasSubstr;

namespace {

std::string contents(const fs::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string corpus(const std::string& name) { return contents(std::string(ALIDADE_SOURCE_DIR) + "/tests/fuzz/corpus/bundler/" + name); }
std::string shared(const std::string& name) { return std::string(ALIDADE_SHARED_DATA_DIR) + "/bundle/examples/Data/" + name; }

Result<CameraSet> bundler(const std::string& text) { return parseBundler(text, "bundle.out", Progress()); }
Result<CameraSet> bal(const std::string& text) { return parseBal(text, "problem.txt", Progress()); }

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::vector<double> residualsOf(const CameraSet& set) {
  std::vector<double> residuals;
  for (const TiePoint& point : set.tiePoints)
    for (const auto& [picture, pixel] : point.seenIn) {
      const PosedPicture& posed = set.pictures[std::size_t(picture)];
      const auto projected = Camera(set.cameras[std::size_t(posed.camera)]).project(*posed.cameraFromWorld * point.world);
      residuals.push_back(projected ? glm::length(*projected - pixel) : 1e9);
    }
  std::sort(residuals.begin(), residuals.end());
  return residuals;
}

}  // namespace

TEST(Bundler, TheCameraLooksAlongMinusZWithYUpFromThePicturesMiddle) {
  const auto set = bundler(corpus("small.out"));
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->pictures.size(), 2u);
  const RigidTransform pose = *set->pictures[0].cameraFromWorld;
  // R is the identity, t = (1,2,3): P = (2,4,-6), p = -P / P.z = (1/3, 2/3), y up.
  EXPECT_LT(glm::length(pose * glm::dvec3(1, 2, -9) - glm::dvec3(2, -4, 6)), 1e-12);
  const Intrinsics& in = set->cameras.at(0);
  EXPECT_EQ(set->camerasWithoutSize, std::vector<int>{0});
  EXPECT_EQ(in.width, 96);
  EXPECT_EQ(in.height, 78);
  EXPECT_EQ(set->tiePoints.at(0).seenIn.at(0).second, glm::dvec2(47.5 + 48, 38.5 + 38.5));
  const double r2 = 5.0 / 9, bent = 500 * (1 - 0.1 * r2 + 0.02 * r2 * r2);
  const auto pixel = Camera(in).project(pose * glm::dvec3(1, 2, -9));
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x, 47.5 + bent / 3, 1e-10);
  EXPECT_NEAR(pixel->y, 38.5 - bent * 2 / 3, 1e-10);
}

TEST(Bundler, AnUnregisteredCameraKeepsItsPlaceWithoutAPose) {
  const auto set = bundler(corpus("small.out"));
  ASSERT_TRUE(set);
  EXPECT_FALSE(set->pictures[1].cameraFromWorld);
  EXPECT_EQ(set->pictures[1].camera, -1);
  EXPECT_EQ(set->tiePoints[0].seenIn.size(), 1u);
  ASSERT_EQ(set->warnings.size(), 1u);
  EXPECT_THAT(set->warnings[0].what, HasSubstr("not registered"));
}

TEST(Bundler, NamesAndSizesComeFromTheListAndItsPictures) {
  std::string pattern = (fs::temp_directory_path() / "alidade-bundler-XXXXXX").string();
  const fs::path folder = mkdtemp(pattern.data());
  std::ofstream(folder / "bundle.out") << corpus("small.out");
  std::ofstream(folder / "list.txt") << "left.bmp 0 500\nright.bmp\n";
  // A BMP's header alone: 200 × 100 pixels of 1 bit.
  std::string bmp("BM\x3e\x0c\0\0\0\0\0\0\x3e\0\0\0\x28\0\0\0\xc8\0\0\0\x64\0\0\0\1\0\1\0", 30);
  bmp.resize(62 + 100 * 28, '\0');
  std::ofstream(folder / "left.bmp", std::ios::binary).write(bmp.data(), std::streamsize(bmp.size()));
  const auto set = BundlerReader().read((folder / "bundle.out").string(), Progress());
  std::ofstream(folder / "list.txt") << "left.bmp\n";
  const auto shortList = BundlerReader().read((folder / "bundle.out").string(), Progress());
  fs::remove_all(folder);
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->pictures[1].name, "right.bmp");
  EXPECT_TRUE(set->camerasWithoutSize.empty());
  EXPECT_EQ(set->cameras[0].width, 200);
  EXPECT_EQ(set->cameras[0].cx, 99.5);
  EXPECT_EQ(set->tiePoints[0].seenIn[0].second, glm::dvec2(99.5 + 48, 49.5 + 38.5));
  ASSERT_TRUE(shortList);
  EXPECT_TRUE(shortList->pictures[0].name.empty());
  EXPECT_THAT(shortList->warnings.at(1).what, HasSubstr("names 1 pictures for 2 cameras"));
}

TEST(Bundler, BrokenFilesAreRefusedByLine) {
  const std::string good = corpus("small.out");
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"v0.3", "v0.2", "0.2"},
      {"# Bundle", "# Bungle", "does not begin"},
      {"2 1\n", "0 1\n", "no cameras"},
      {"2 1\n", "-1 1\n", "not below"},
      {"2 1\n", "2 9999999999\n", "not below"},
      {"2 1\n", "2 20\n", "promise more"},
      {"500 -0.1", "nan -0.1", "not finite"},
      {"500 -0.1", "-500 -0.1", "not positive"},
      {"500 -0.1", "wide -0.1", "'wide'"},
      {"1 0 0\n", "1 0 1\n", "no rotation"},
      {"10 20 30", "10 20 300", "colour"},
      {"2 0 7 48.0", "2 5 7 48.0", "camera of a view"},
      {"2 0 7 48.0", "99999 0 7 48.0", "not below"},
      {"48.0 -38.5", "1e300 -38.5", "impossibly far"},
      {" 1 3 0 0\n", "\n", "ends too early"},
  };
  for (const auto& [from, to, words] : cases) {
    const auto set = bundler(replaced(good, from, to));
    ASSERT_FALSE(set) << to;
    EXPECT_THAT(set.error().text(), HasSubstr(words));
    EXPECT_THAT(set.error().where, HasSubstr("bundle.out"));
  }
  for (std::size_t n = 0; n + 2 < good.size(); ++n) EXPECT_FALSE(bundler(good.substr(0, n))) << n;
}

TEST(Bundler, SurvivesRandomDamage) {
  std::mt19937 random(6);
  for (int i = 0; i < 5000; ++i) {
    std::string text = i % 2 ? corpus("small.out") : corpus("small_bal.txt");
    for (int k = 0; k < 3; ++k) text[random() % text.size()] = "0123456789 .-+e\n#x\xff"[random() % 19];
    (void)bundler(text);
    (void)bal(text);
  }
}

// Published by its authors as an adjusted model: the residuals are of adjusted feature points. Any axis, sign or order
// taken wrongly is off by tens of pixels.
TEST(Bundler, BalbianellosPointsLandOnTheirObservations) {
  const std::string path = shared("Balbianello.out");
  if (!fs::exists(path)) GTEST_SKIP() << "needs " << path;
  const auto set = BundlerReader().read(path, Progress());
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->pictures.size(), 5u);
  EXPECT_EQ(set->tiePoints.size(), 544u);
  const auto residuals = residualsOf(*set);
  EXPECT_GT(residuals.size(), 1400u);
  const double median = residuals[residuals.size() / 2];
  RecordProperty("median_px", std::to_string(median));
  EXPECT_LT(median, 0.5);
  EXPECT_LT(residuals[residuals.size() * 9 / 10], 2.0);
}

TEST(Bal, FollowsItsFormulaAndItsRotationVector) {
  const auto set = bal(corpus("small_bal.txt"));
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->tiePoints.size(), 2u);
  // The second camera does not turn: P = X + t = (4, 5, -2) for the second point.
  EXPECT_LT(glm::length(*set->pictures[1].cameraFromWorld * glm::dvec3(4, 5, 6) - glm::dvec3(4, -5, 2)), 1e-12);
  // The first turns by |w| about w = (0.1, -0.2, 0.3): Rodrigues' formula by hand for (1, 2, 3).
  const glm::dvec3 w(0.1, -0.2, 0.3), x(1, 2, 3);
  const double angle = glm::length(w);
  const glm::dvec3 axis = w / angle;
  const glm::dvec3 turned = x * std::cos(angle) + glm::cross(axis, x) * std::sin(angle) + axis * glm::dot(axis, x) * (1 - std::cos(angle));
  const glm::dvec3 p = turned + glm::dvec3(1, 2, -9);
  EXPECT_LT(glm::length(*set->pictures[0].cameraFromWorld * x - glm::dvec3(p.x, -p.y, -p.z)), 1e-12);
}

TEST(Bal, BrokenProblemsAreRefused) {
  const std::string good = corpus("small_bal.txt");
  ASSERT_TRUE(bal(good));
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"2 2 3\n", "0 2 3\n", "no cameras"},       {"2 2 3\n", "2 2 30\n", "promise more"}, {"2 2 3\n", "2 2\n", "counts are wrong"},
      {"0 1 10 20", "0 2 10 20", "point 2"},      {"0 1 10 20", "2 1 10 20", "camera 2"}, {"0 1 10 20", "0 1 inf 20", "not finite"},
      {"\n500\n", "\n0\n", "not positive"},       {"\n0.1\n", "\n1e999\n", "not finite"},  {"\n0.1\n", "\n0x1\n", "'0x1'"},
  };
  for (const auto& [from, to, words] : cases) {
    const auto set = bal(replaced(good, from, to));
    ASSERT_FALSE(set) << to;
    EXPECT_THAT(set.error().text(), HasSubstr(words));
  }
  for (std::size_t n = 0; n + 2 < good.size(); ++n) EXPECT_FALSE(bal(good.substr(0, n))) << n;
}

TEST(Bal, IsKnownByItsFirstLines) {
  const auto score = [](const std::string& text) {
    FileProbe probe;
    probe.path = "x.txt";
    probe.extension = "txt";
    probe.head = {reinterpret_cast<const std::byte*>(text.data()), text.size()};
    return BalReader().sniff(probe);
  };
  EXPECT_GT(score(corpus("small_bal.txt")), 70);
  EXPECT_EQ(score("1 2 3\n4 5 6\n"), 0) << "a list of points";
  EXPECT_EQ(score("0.1 2 3\n0 0 6 7\n"), 0);
  EXPECT_EQ(score(""), 0);
}

/// The mean squared residual by BAL's own formula, in its own axes, numbers straight from the file.
double costByTheFormula(const std::string& path) {
  std::ifstream in(path);
  std::size_t cameras, points, count;
  in >> cameras >> points >> count;
  struct Sighting {
    std::size_t camera, point;
    double x, y;
  };
  std::vector<Sighting> sightings(count);
  for (auto& s : sightings) in >> s.camera >> s.point >> s.x >> s.y;
  std::vector<std::array<double, 9>> lens(cameras);
  for (auto& l : lens)
    for (double& v : l) in >> v;
  std::vector<glm::dvec3> world(points);
  for (auto& p : world) in >> p.x >> p.y >> p.z;
  double sum = 0;
  for (const auto& s : sightings) {
    const auto& l = lens[s.camera];
    const glm::dvec3 w(l[0], l[1], l[2]), x = world[s.point];
    const double angle = glm::length(w);
    const glm::dvec3 a = w / angle;
    const glm::dvec3 p = x * std::cos(angle) + glm::cross(a, x) * std::sin(angle) + a * glm::dot(a, x) * (1 - std::cos(angle)) + glm::dvec3(l[3], l[4], l[5]);
    const double u = -p.x / p.z, v = -p.y / p.z, r2 = u * u + v * v, radial = l[6] * (1 + l[7] * r2 + l[8] * r2 * r2);
    sum += std::pow(radial * u - s.x, 2) + std::pow(radial * v - s.y, 2);
  }
  return sum;
}

TEST(Bal, DubrovniksCostIsThatOfTheFormula) {
  for (const char* name : {"dubrovnik-3-7-pre.txt", "dubrovnik-3-7-18-pre.txt"}) {
    if (!fs::exists(shared(name))) GTEST_SKIP() << "needs " << shared(name);
    const auto set = BalReader().read(shared(name), Progress());
    ASSERT_TRUE(set) << set.error().text();
    double sum = 0;
    for (const double r : residualsOf(*set)) sum += r * r;
    const double expected = costByTheFormula(shared(name));
    EXPECT_GT(expected, 0);
    EXPECT_NEAR(sum, expected, 1e-9 * expected) << name;
  }
}

}  // namespace alidade

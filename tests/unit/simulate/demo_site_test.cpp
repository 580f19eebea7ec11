// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "base/error.h"
#include "demo_fixture.h"

namespace alidade {
namespace {

using namespace demo_test;
namespace fs = std::filesystem;

std::map<std::string, std::string> contentsOf(const std::string& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      contents[fs::relative(entry.path(), folder).generic_string()] = bytesOf(entry.path().string());
  return contents;
}

TEST(DemoSite, SameOptionsGiveTheSameBytesAndAnotherSeedDoesNot) {
  DemoOptions options = smallOptions();
  options.width = 160;
  options.height = 120;
  options.frames = 1;
  const std::string first = freshFolder("a"), second = freshFolder("b"), third = freshFolder("c");
  ASSERT_TRUE(writeDemoSite(first, options, Progress()));
  ASSERT_TRUE(writeDemoSite(second, options, Progress()));
  options.seed = 2;
  ASSERT_TRUE(writeDemoSite(third, options, Progress()));
  const auto a = contentsOf(first), b = contentsOf(second), c = contentsOf(third);
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, content] : a) EXPECT_TRUE(b.count(name) && b.at(name) == content) << name;
  for (const char* name :
       {"scan.las", "images/frame_0000.png", "design.ifc", "sparse/images.txt", "truth/truth.json"})
    EXPECT_NE(a.at(name), c.at(name)) << name;
  for (const auto& folder : {first, second, third}) fs::remove_all(folder);
}

TEST(DemoSite, RefusesOptionsThatCannotBe) {
  for (const auto& spoil : std::vector<void (*)(DemoOptions&)>{
           [](DemoOptions& o) { o.points = 0; }, [](DemoOptions& o) { o.frames = -1; },
           [](DemoOptions& o) { o.width = 0; }, [](DemoOptions& o) { o.siteOrigin.x = std::nan(""); }}) {
    DemoOptions options = smallOptions();
    spoil(options);
    const auto refused = writeDemoSite(freshFolder("refused"), options, Progress());
    ASSERT_FALSE(refused);
    EXPECT_FALSE(refused.error().advice.empty());
  }
}

TEST(DemoSite, NamesTheFolderThatCannotBeMade) {
  const std::string file = freshFolder("file");
  std::ofstream(file) << "in the way";
  const auto refused = writeDemoSite(file + "/demo", smallOptions(), Progress());
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().where.find(file), std::string::npos);
  fs::remove(file);
}

TEST(DemoSite, SaysThatTheDiskIsFull) {
  // /dev/full takes no byte: a scan that is written there fails as on a full disk.
  const std::string folder = freshFolder("full");
  fs::create_directories(folder);
  fs::create_symlink("/dev/full", folder + "/design.ifc");
  const auto refused = writeDemoSite(folder, smallOptions(), Progress());
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().text().find("design.ifc"), std::string::npos);
  EXPECT_NE(refused.error().advice.find("space"), std::string::npos);
  fs::remove_all(folder);
}

TEST(DemoSite, StopsWhenCancelled) {
  const std::string folder = freshFolder("cancelled");
  const Progress progress;
  progress.cancel();
  const auto stopped = writeDemoSite(folder, smallOptions(), progress);
  ASSERT_FALSE(stopped);
  EXPECT_TRUE(isCancelled(stopped.error()));
  fs::remove_all(folder);
}

TEST(DemoSite, LeavesForeignFilesInTheFolderAlone) {
  const std::string folder = freshFolder("kept");
  fs::create_directories(folder + "/images");
  std::ofstream(folder + "/images/notes.txt") << "mine";
  DemoOptions options = smallOptions();
  options.frames = 0;
  options.points = 500;
  ASSERT_TRUE(writeDemoSite(folder, options, Progress()));
  EXPECT_EQ(bytesOf(folder + "/images/notes.txt"), "mine");
  fs::remove_all(folder);
}

TEST_F(DemoSiteTest, PosesInTheColmapModelAreTheTrueOnes) {
  std::istringstream lines(bytesOf(site().cameras + "/images.txt"));
  std::string line;
  std::size_t seen = 0;
  while (std::getline(lines, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    int id = 0, camera = 0;
    double w, x, y, z;
    glm::dvec3 t;
    std::string name;
    words >> id >> w >> x >> y >> z >> t.x >> t.y >> t.z >> camera >> name;
    const auto& frame = truth().at("frames").at(seen++);
    const RigidTransform exact = transformOf(frame.at("camera_from_world"));
    const RigidTransform read{glm::dquat(w, x, y, z), t};
    EXPECT_EQ(name, frame.at("name"));
    EXPECT_LT(rotationAngleBetween(read, exact), 1e-12);
    EXPECT_LT(glm::length(read.centre() - exact.centre()), 1e-6);
  }
  EXPECT_EQ(seen, 2u);
}

TEST_F(DemoSiteTest, PerturbedPosesAreOffByCentimetresAndTenthsOfADegree) {
  std::istringstream lines(bytesOf(site().perturbedCameras + "/images.txt"));
  std::string line;
  std::size_t seen = 0;
  while (std::getline(lines, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    int id = 0;
    double w, x, y, z;
    glm::dvec3 t;
    words >> id >> w >> x >> y >> z >> t.x >> t.y >> t.z;
    const RigidTransform exact = transformOf(truth().at("frames").at(seen++).at("camera_from_world"));
    const RigidTransform read{glm::dquat(w, x, y, z), t};
    const double distance = glm::length(read.centre() - exact.centre());
    EXPECT_GT(distance, 0.001);
    EXPECT_LT(distance, 0.06);
    EXPECT_LT(rotationAngleBetween(read, exact), 0.6 * 3.1416 / 180);
  }
  EXPECT_EQ(seen, 2u);
}

TEST_F(DemoSiteTest, RecordsOneShiftedColumnOneTiltedWallAndOneMissingOpening) {
  std::map<std::string, nlohmann::json> byKind;
  for (const auto& defect : truth().at("defects")) byKind[defect.at("kind")] = defect;
  ASSERT_EQ(byKind.size(), 3u);
  EXPECT_GT(byKind["shifted"].at("amount_m").get<double>(), 0.03);
  EXPECT_LT(byKind["shifted"].at("amount_m").get<double>(), 0.10);
  EXPECT_EQ(element(byKind["shifted"].at("element")).at("type"), "IfcColumn");
  EXPECT_EQ(element(byKind["tilted"].at("element")).at("type"), "IfcWall");
  EXPECT_EQ(element(byKind["missing_opening"].at("element")).at("type"), "IfcWall");
}

TEST_F(DemoSiteTest, ObservationsOfControlPointsLieNearTheirTrueProjection) {
  std::map<std::string, glm::dvec2> exact;
  for (const auto& one : truth().at("control_points_in_first_frame"))
    exact[one.at("name")] = {one.at("pixel").at(0), one.at("pixel").at(1)};
  std::istringstream lines(bytesOf(site().observations));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "u,v,e,n,h,sigma_px,name");
  std::size_t count = 0;
  while (std::getline(lines, line)) {
    double u = 0, v = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf", &u, &v), 2);
    const std::string name = line.substr(line.find_last_of(',') + 1);
    ASSERT_TRUE(exact.count(name)) << name;
    EXPECT_LT(glm::length(exact[name] - glm::dvec2(u, v)), 0.3 * 5) << name;
    ++count;
  }
  EXPECT_EQ(count, exact.size());
  EXPECT_GE(count, 6u) << "a resection wants more than the least number of points";
}

}  // namespace
}  // namespace alidade

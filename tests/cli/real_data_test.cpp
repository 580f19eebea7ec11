// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Real data with known truth; skipped where it is not there.

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "command_line.h"

namespace alidade::test {

namespace {

std::vector<std::array<double, 3>> meshVertices(const std::filesystem::path& ply, int every) {
  std::ifstream file(ply, std::ios::binary);
  std::string line;
  std::size_t count = 0;
  while (std::getline(file, line) && line != "end_header")
    if (line.starts_with("element vertex ")) count = std::stoul(line.substr(15));
  constexpr std::size_t kRecord = 6 * sizeof(float) + 4;  // x y z nx ny nz, rgba
  std::vector<std::array<double, 3>> vertices;
  std::vector<char> record(kRecord);
  for (std::size_t i = 0; i < count && file.read(record.data(), kRecord); ++i) {
    if (i % every != 0) continue;
    float xyz[3];
    std::memcpy(xyz, record.data(), sizeof xyz);
    vertices.push_back({xyz[0], xyz[1], xyz[2]});
  }
  return vertices;
}

}  // namespace

TEST(Road, ProjectPointsAgreesWithOpenCvInDouble) {
  const auto road = sharedData("road");
  if (road.empty()) GTEST_SKIP() << "the road data set is not here";
  const auto project = scratch() / "road.alidade";
  const auto made = alidadeCli("new --json " + quoted(project) + " --scan " + quoted(road / "road_mesh_sampled.las") +
                               " --design " + quoted(road / "road.ifc") + " --images " + quoted(road / "101_0367_0007.JPG") +
                               " --cameras " + quoted(road / "sparse"));
  ASSERT_EQ(made.exitCode, 0) << made.errors;
  EXPECT_EQ(made.json()["frames_with_pose"], 1);

  // The pose and the lens, straight from the COLMAP files.
  std::ifstream images(road / "sparse" / "images.txt");
  cv::Matx33d rotation;
  cv::Vec3d translation;
  for (std::string line; std::getline(images, line);) {
    if (line.find("101_0367_0007.JPG") == std::string::npos) continue;
    double id, w, x, y, z;
    std::istringstream(line) >> id >> w >> x >> y >> z >> translation[0] >> translation[1] >> translation[2];
    const double n = std::sqrt(w * w + x * x + y * y + z * z);
    w /= n, x /= n, y /= n, z /= n;
    rotation = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
  }
  const cv::Matx33d K(3693.1569475809993, 0, 2731.4405032761174, 0, 3693.1569475809993, 1846.493249050933, 0, 0, 1);
  const cv::Vec<double, 5> lens(-0.26439037908330026, 0.10751677446162797, -0.000503346062832222, -0.0005062622264917514,
                                -0.030410562029402437);

  const auto vertices = meshVertices(road / "road.ply", 40);
  ASSERT_GT(vertices.size(), 500u);
  std::ostringstream input;
  input.precision(12);
  for (const auto& p : vertices) input << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  const auto outcome = alidadeCli("project-points " + quoted(project) + " --frame 101_0367_0007", input.str());
  ASSERT_EQ(outcome.exitCode, 0) << outcome.errors;

  std::istringstream lines(outcome.output);
  int compared = 0, inPicture = 0;
  for (const auto& p : vertices) {
    std::string u, v, z, state;
    ASSERT_TRUE(lines >> u >> v >> z >> state);
    const cv::Vec3d inCamera = rotation * cv::Vec3d(p[0], p[1], p[2]) + translation;
    const double depth = inCamera[2];
    const double radius = std::hypot(inCamera[0], inCamera[1]) / depth;
    if (depth <= 0 || radius > 1.369) {
      EXPECT_EQ(state, "outside") << "a point beyond the fold-back radius came back";
      continue;
    }
    // Decentring moves the fold by a per cent with the direction; far outside the picture either way.
    if (radius > 1.34) continue;
    std::vector<cv::Point2d> expected;
    cv::projectPoints(std::vector<cv::Point3d>{{inCamera[0], inCamera[1], inCamera[2]}}, cv::Vec3d(), cv::Vec3d(), K, lens, expected);
    ASSERT_NE(u, "nan");
    EXPECT_NEAR(std::stod(u), expected[0].x, 0.01);
    EXPECT_NEAR(std::stod(v), expected[0].y, 0.01);
    EXPECT_NEAR(std::stod(z), depth, 1e-5);
    ++compared;
    inPicture += state != "outside";
  }
  EXPECT_GT(compared, 400);
  EXPECT_GT(inPicture, 100);
}

// By the scanned ground or, where the pipe lies above it, by the pavement that is designed over it.
TEST(Road, TheSewerUnderThePavementIsReportedAsHidden) {
  const auto road = sharedData("road");
  if (road.empty()) GTEST_SKIP() << "the road data set is not here";
  const auto project = scratch() / "road_overlay.alidade";
  ASSERT_EQ(alidadeCli("new " + quoted(project) + " --scan " + quoted(road / "road_mesh_sampled.las") + " --design " +
                       quoted(road / "road.ifc") + " --images " + quoted(road / "101_0367_0007.JPG") + " --cameras " +
                       quoted(road / "sparse")).exitCode, 0);
  const auto outcome = alidadeCli("overlay --json " + quoted(project) + " --frame 0 --size 1368x912 -o " +
                                  quoted(scratch() / "road.png"));
  ASSERT_EQ(outcome.exitCode, 0) << outcome.errors;
  std::uint64_t hidden = 0, all = 0;
  const auto json = outcome.json();
  for (const auto& element : json["elements"]) {
    if (element["name"].get<std::string>().find("Rioolpijp") == std::string::npos) continue;  // sewer pipe
    hidden += element["hidden_px"].get<std::uint64_t>();
    all += element["hidden_px"].get<std::uint64_t>() + element["visible_px"].get<std::uint64_t>();
  }
  ASSERT_GT(all, 1000u) << outcome.output.substr(0, 2000);
  EXPECT_GT(static_cast<double>(hidden) / static_cast<double>(all), 0.8);
}

TEST(Info, ReadsTheHeadersOfEveryKind) {
  const auto data = sharedData("las");
  if (data.empty()) GTEST_SKIP() << "the data sets are not here";
  const auto root = data.parent_path();
  const auto outcome = alidadeCli("info --json " + quoted(root / "road/road_mesh_sampled.las") + " " + quoted(root / "road/road.ifc") +
                                  " " + quoted(root / "road/sparse") + " " + quoted(root / "indoor_video/images") + " " +
                                  quoted(root / "text_and_ply/box.obj"));
  ASSERT_EQ(outcome.exitCode, 0) << outcome.output;
  const auto files = outcome.json()["files"];
  EXPECT_EQ(files[0]["kind"], "scan");
  EXPECT_EQ(files[1]["kind"], "design");
  EXPECT_EQ(files[1]["schema"], "IFC2X3");
  EXPECT_EQ(files[2]["kind"], "cameras");
  EXPECT_NEAR(files[2]["cameras"][0]["fold_back_radius"].get<double>(), 1.369, 5e-4);
  EXPECT_EQ(files[3]["pictures"], 24);
  EXPECT_EQ(files[4]["kind"], "design");
}

TEST(Info, RefusesAnUnreadSchemaByName) {
  const auto data = sharedData("ifc");
  if (data.empty()) GTEST_SKIP() << "the data sets are not here";
  const auto outcome = alidadeCli("info " + quoted(data / "KIT-Simple-Road-Test-Web-IFC4x3_RC2.ifc"));
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_NE(outcome.output.find("IFC4X3"), std::string::npos) << outcome.output;
}

// A file that anyone drops in brings all that it holds.
TEST(E57, ItsPicturesAndTheirCamerasComeWithTheFile) {
  const auto e57 = sharedData("e57");
  if (e57.empty()) GTEST_SKIP() << "the E57 files are not here";
  const auto made = alidadeCli("new --json " + quoted(scratch() / "e57.alidade") + " --files " +
                               quoted(e57 / "self" / "PinholeImageWithDistortionParameters.e57"));
  ASSERT_EQ(made.exitCode, 0) << made.errors << made.output;
  EXPECT_EQ(made.json()["scans"], 1);
  EXPECT_EQ(made.json()["frames"], 3);
  EXPECT_EQ(made.json()["cameras"], 1);
}

TEST(E57, AScanBringsItsPicturesUnlessItIsWantedAlone) {
  const auto e57 = sharedData("e57");
  if (e57.empty()) GTEST_SKIP() << "the E57 files are not here";
  const std::string scan = " --scan " + quoted(e57 / "self" / "PinholeImageWithDistortionParameters.e57");
  const std::string base = "new --json --overwrite " + quoted(scratch() / "e57_scan.alidade") + scan;
  const auto whole = alidadeCli(base);
  ASSERT_EQ(whole.exitCode, 0) << whole.errors << whole.output;
  EXPECT_EQ(whole.json()["scans"], 1);
  EXPECT_EQ(whole.json()["frames"], 3);
  EXPECT_EQ(whole.json()["cameras"], 1);
  const auto alone = alidadeCli(base + " --scan-alone");
  ASSERT_EQ(alone.exitCode, 0) << alone.errors << alone.output;
  EXPECT_EQ(alone.json()["scans"], 1);
  EXPECT_EQ(alone.json()["frames"], 0);
}

// Metashape's own export in place of the COLMAP model: the same pose, the same lens, so the same pixels.
TEST(Road, MetashapesXmlAndItsColmapModelSeeTheSamePixels) {
  const auto road = sharedData("road");
  if (road.empty()) GTEST_SKIP() << "the road data set is not here";
  std::array<nlohmann::json, 2> points;
  for (int i = 0; i < 2; ++i) {
    const auto project = scratch() / (i == 0 ? "road_xml.alidade" : "road_sparse.alidade");
    const auto made = alidadeCli("new --json " + quoted(project) + " --images " + quoted(road / "101_0367_0007.JPG") + " --cameras " +
                                 quoted(road / (i == 0 ? "road.xml" : "sparse")));
    ASSERT_EQ(made.exitCode, 0) << made.errors << made.output;
    EXPECT_EQ(made.json()["frames_with_pose"], 1);
    const auto projected = alidadeCli("project-points --json " + quoted(project) + " --frame 0",
                                      "100590 196280 6\n100593 196285 6.2\n100600 196290 6\n100588 196275 5\n");
    ASSERT_EQ(projected.exitCode, 0) << projected.errors;
    points[std::size_t(i)] = projected.json()["points"];
  }
  std::size_t seen = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (points[0][i]["u_px"].is_null() || points[1][i]["u_px"].is_null()) continue;
    ++seen;
    EXPECT_NEAR(points[0][i]["u_px"], points[1][i]["u_px"], 2e-3);
    EXPECT_NEAR(points[0][i]["v_px"], points[1][i]["v_px"], 2e-3);
  }
  EXPECT_GE(seen, 2u);
}

TEST(Road, ExportedCamerasMakeTheSameProjectAgain) {
  const auto road = sharedData("road");
  if (road.empty()) GTEST_SKIP() << "the road data set is not here";
  const auto project = scratch() / "road_export.alidade";
  const std::string images = " --images " + quoted(road / "101_0367_0007.JPG") + " --cameras ";
  ASSERT_EQ(alidadeCli("new " + quoted(project) + images + quoted(road / "road.xml")).exitCode, 0);
  const std::string input = "100590 196280 6\n100593 196285 6.2\n";
  const auto expected = alidadeCli("project-points --json " + quoted(project) + " --frame 0", input).json()["points"];
  for (const char* target : {"exported_sparse", "exported.json"}) {
    const auto done = alidadeCli("export-cameras --json " + quoted(project) + " -o " + quoted(scratch() / target));
    ASSERT_EQ(done.exitCode, 0) << done.output;
    EXPECT_EQ(done.json()["frames"], 1);
    EXPECT_EQ(alidadeCli("export-cameras " + quoted(project) + " -o " + quoted(scratch() / target)).exitCode, 1) << "nothing is overwritten unasked";
    const auto again = scratch() / (std::string(target) + ".alidade");
    ASSERT_EQ(alidadeCli("new " + quoted(again) + images + quoted(scratch() / target)).exitCode, 0);
    const auto points = alidadeCli("project-points --json " + quoted(again) + " --frame 0", input).json()["points"];
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(points[i]["u_px"], expected[i]["u_px"], 1e-5) << target;
  }
  const auto table = alidadeCli("export-cameras " + quoted(project) + " -o " + quoted(scratch() / "exported.csv"));
  EXPECT_EQ(table.exitCode, 0);
}

}  // namespace alidade::test

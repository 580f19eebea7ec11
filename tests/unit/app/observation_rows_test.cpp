// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/observing.h"
#include "app/refine_network.h"

namespace alidade {
namespace {

using testing::HasSubstr;

std::string write(const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / "alidade_observation_rows_test.csv";
  std::ofstream(path) << text;
  return path.string();
}

constexpr const char* header = "u,v,e,n,h,name,frame,kind,use,sigma_m,e2,n2,h2,depth_m\n";

/// The header and these rows, each filled up with empty cells.
std::string withHeader(const std::string& rows) {
  const std::string first = header;
  const auto columns = std::count(first.begin(), first.end(), ',');
  std::string all = first, line;
  for (std::istringstream lines(rows); std::getline(lines, line);)
    all += line + std::string(columns - std::count(line.begin(), line.end(), ','), ',') + '\n';
  return all;
}

TEST(ObservationRows, EveryKindIsRead) {
  const auto rows = readObservationRows(write(withHeader("10,20,1,2,3,C1,A,control,1,0.01\n11,21,4,5,6,S1,A,scan\n"
                                              "12,22,,,,T1,A,tie\n13,23,,,,T1,B,tie,check\n14,24,1,2,3,E1,A,edge,1,,4,5,6\n"
                                              ",,,,,T1,A,depth,1,0.02,,,,7.5\n,,1,2,3,T1,,surface,1,,0,0,1\n,,9,9,9,,A,position,1,0.05\n"
                                              "99,99,9,9,9,off,A,control,0\n")));
  ASSERT_TRUE(rows) << rows.error().text();
  ASSERT_EQ(rows->size(), 8u) << "use 0 is skipped";
  EXPECT_DOUBLE_EQ((*rows)[0].sigmaM, 0.01);
  EXPECT_EQ((*rows)[1].kind, ObservationKind::Scan);
  EXPECT_DOUBLE_EQ((*rows)[1].sigmaM, 0.003);
  EXPECT_FALSE((*rows)[2].world);
  EXPECT_TRUE((*rows)[3].heldOut);
  EXPECT_DOUBLE_EQ((*rows)[4].second->z, 6);
  EXPECT_DOUBLE_EQ((*rows)[5].depthM, 7.5);
  EXPECT_EQ((*rows)[6].kind, ObservationKind::Surface);
  EXPECT_EQ((*rows)[7].kind, ObservationKind::Position);
}

TEST(ObservationRows, BadRowsNameTheirLine) {
  for (const auto& [row, text] : {std::pair{"1,2,3,4,5,P,A,star", "no kind of observation"}, {"1,2,3,4,5,P,A,control,maybe", "use is"},
                                  {"1,2,3,4,5,P,A,edge", "e2, n2 and h2"}, {"1,2,,,,,A,tie", "no name"},
                                  {"1,2,3,4,,P,A,control", "e, n, h must be finite"}, {"1,2,3,4,5,P,A,scan,1,-1", "sigma_m"},
                                  {",,,,,P,A,depth", "depth_m"}, {"nan,2,3,4,5,P,A,scan", "u, v must be finite"}, {",,9,9,9,P,A,position,check", "position cannot be held out"},
                                  {",,1,2,3,T1,,surface,check,,0,0,1", "surface cannot be held out"}}) {
    const auto rows = readObservationRows(write(withHeader(row)));
    ASSERT_FALSE(rows) << row;
    EXPECT_THAT(rows.error().text(), HasSubstr(text));
    EXPECT_THAT(rows.error().where, HasSubstr("line 2"));
  }
}

TEST(ObservationRows, ColumnsAndCellsThatNobodyWouldReadAreRefused) {
  const auto expectRefused = [](const std::string& text, const std::string& reason) {
    const auto rows = readObservationRows(write(text));
    ASSERT_FALSE(rows) << text;
    EXPECT_THAT(rows.error().text(), HasSubstr(reason));
  };
  expectRefused("u,v,e,n,h,sigma,name\n1,2,3,4,5,0.3,P\n", "no column 'sigma'");
  expectRefused("u,v,e,n,h,sigma,name\n1,2,3,4,5,0.3,P\n", "is sigma_px");
  expectRefused("u,v,e,n,h,colour\n1,2,3,4,5,red\n", "The columns are u, v, e, n, h, sigma_px, name");
  expectRefused("u,v,e,n,h,\n1,2,3,4,5,\n", "Column 6 has no name");
  expectRefused("u,v,e,n,h,U\n1,2,3,4,5,6\n", "The column 'u' comes twice");
  expectRefused("u,v,e,n,h,name\n1,2,3,4,5,P\n1,5,2,3,4,5,P\n", "line 3");
  expectRefused("u,v,e,n,h,name\n1,5,2,3,4,5,P\n", "7 cells, the header 6");
  expectRefused("u,v,e,n,h,name\n1,2,3,4,5\n", "5 cells, the header 6");
  expectRefused("u;v;e;n;h;name\n1,5;2;3;4;5;P\n", "separated by semicolons");
  expectRefused("u\tv\te\tn\th\n1\t2\t3\t4\t5\n", "separated by tabs");
}

Project twoFrames() {
  Project project;
  project.cameras.push_back({CameraId{1}, "camera", Camera(Intrinsics::fromParameters(CameraModel::Pinhole, 640, 480, {500, 500, 320, 240}).value())});
  for (int i = 0; i < 2; ++i) {
    Frame frame;
    frame.id = FrameId{i + 1};
    frame.name = i == 0 ? "A.png" : "B.png";
    frame.camera = CameraId{1};
    frame.cameraFromWorld = RigidTransform{};
    project.frames.push_back(frame);
  }
  return project;
}

TEST(ObservationRows, MakeOneNetworkOverTheFramesTheyName) {
  const auto rows = readObservationRows(write(withHeader("10,20,1,2,3,C1,A,control\n12,22,,,,T1,A,tie\n13,23,,,,T1,B,tie\n,,1,2,3,T1,,surface,1,,0,0,1\n")));
  ASSERT_TRUE(rows);
  const auto made = networkOf(twoFrames(), "", *rows, {});
  ASSERT_TRUE(made) << made.error().text();
  EXPECT_EQ(made->network.frames.size(), 2u);
  EXPECT_EQ(made->network.points.size(), 2u);
  EXPECT_EQ(made->network.observations.size(), 3u);
  EXPECT_TRUE(made->network.points[1].surface);
}

TEST(ObservationRows, AProjectKeepsEveryKind) {
  const auto rows = readObservationRows(write(withHeader(",,,,,C1,A,depth,check,0.02,,,,7.5\n,,1,2,3,T1,,surface,1,0.004,0,0,1\n10,20,1,2,3,C1,A,control\n"
                                                         "12,22,,,,T1,A,tie\n13,23,,,,T1,B,tie\n30,31,1,2,3,E1,A,edge,1,,4,5,6\n32,31,1,2,3,E1,A,edge,1,,4,5,6\n")));
  ASSERT_TRUE(rows) << rows.error().text();
  Project project = twoFrames();
  ASSERT_TRUE(keepObservations(project, "", *rows));
  ASSERT_EQ(project.observations.size(), 7u);
  EXPECT_EQ(project.observations[0].kind, ObservedKind::Depth);
  EXPECT_FALSE(project.observations[1].frame);
  const auto again = observationRowsOf(project);
  ASSERT_EQ(again.size(), rows->size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    const ObservationRow &was = (*rows)[i], &is = again[i];
    EXPECT_EQ(is.kind, was.kind);
    EXPECT_EQ(is.frame.substr(0, 1), was.frame);
    EXPECT_EQ(is.name, was.name);
    EXPECT_EQ(is.pixel, was.pixel);
    EXPECT_EQ(is.depthM, was.depthM);
    EXPECT_EQ(is.sigmaM, was.sigmaM);
    EXPECT_EQ(is.heldOut, was.heldOut);
    if (was.kind != ObservationKind::Depth) { EXPECT_EQ(is.world, was.world); }
    if (was.second) { EXPECT_EQ(is.second, was.second); }
  }
  const auto made = networkOf(project, "", again, {});
  ASSERT_TRUE(made) << made.error().text();
  ASSERT_EQ(made->network.depths.size(), 1u);
  EXPECT_EQ(made->network.depths[0].depthM, 7.5);
  ASSERT_EQ(made->surfaceRows.size(), 1u);
  EXPECT_TRUE(made->network.points[static_cast<std::size_t>(made->surfaceRows.begin()->first)].surface);
  EXPECT_EQ(again[made->surfaceRows.begin()->second].name, "T1");

  ASSERT_TRUE(keepObservations(project, "", {rows->begin(), rows->begin() + 1}));
  EXPECT_EQ(project.observations.size(), 7u) << "in place of the same";

  // One picture has no tie points, and nothing of other pictures' points.
  EXPECT_EQ(observationRowsOf(project, FrameId{1}).size(), 4u) << "C1, its depth, two places of E1";
  EXPECT_EQ(observationRowsOf(project, FrameId{2}).size(), 0u);
  for (Observation& o : project.observations)
    if (o.kind == ObservedKind::Tie) o.enabled = false;
  EXPECT_EQ(observationRowsOf(project).size(), 4u) << "without the point, its surface has nothing to hold";

  ObservationRow tripod;
  tripod.kind = ObservationKind::Position, tripod.frame = "A", tripod.where = "line 9";
  const auto refused = keepObservations(project, "", {tripod});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text(), HasSubstr("line 9"));
  EXPECT_EQ(project.observations.size(), 7u);
}

TEST(ObservationRows, ADepthIsJudgedAtThePoseOfItsFrame) {
  Project project = twoFrames();
  project.frames[0].cameraFromWorld = RigidTransform{glm::dquat(1, 0, 0, 0), {0, 0, 2}};
  Observation point, depth;
  point.name = depth.name = "C1", point.frame = depth.frame = FrameId{1};
  point.world = {0.1, 0.2, 5.5}, point.pixel = {320, 240};
  depth.kind = ObservedKind::Depth, depth.depthM = 7.25;
  project.observations = {point, depth};
  ASSERT_TRUE(depthResidualM(project, depth));
  EXPECT_DOUBLE_EQ(*depthResidualM(project, depth), 0.25);
  EXPECT_FALSE(depthResidualM(project, point));
  project.observations[0].kind = ObservedKind::Tie;
  EXPECT_FALSE(depthResidualM(project, depth)) << "of an unknown point nobody knows";
}

TEST(ObservationRows, WhatContradictsItselfIsRefused) {
  const auto expectRefused = [](const std::string& text, const std::string& reason) {
    const auto rows = readObservationRows(write(withHeader(text)));
    ASSERT_TRUE(rows) << rows.error().text();
    const auto made = networkOf(twoFrames(), "", *rows, {});
    ASSERT_FALSE(made) << text;
    EXPECT_THAT(made.error().text(), HasSubstr(reason));
  };
  expectRefused("1,2,3,4,5,P,A\n1,2,3,4,5,P,A\n", "observed twice");
  expectRefused("1,2,3,4,5,P,A\n1,2,3,4,6,P,B\n", "two positions");
  expectRefused("1,2,3,4,5,P,A\n1,2,,,,P,B,tie\n", "known point in one row");
  expectRefused("1,2,3,4,5,P\n", "names no frame");
  expectRefused("1,2,3,4,5,P,C\n", "C");
  expectRefused(",,,,,Q,A,depth,1,,,,,3\n", "No row observes");
}

}  // namespace
}  // namespace alidade

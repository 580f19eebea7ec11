// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trajectory/pose_table_reader.h"

#include <filesystem>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {

using testing::HasSubstr;

namespace {

Result<CameraSet> parsed(const std::string& text) { return parsePoseTable(text, "poses.csv", Progress()); }

/// Where the first pose's camera looks, and where its picture's bottom points.
struct View {
  glm::dvec3 forward, down, centre;
  explicit View(const CameraSet& set, std::size_t i = 0) {
    const RigidTransform worldFromCamera = set.pictures.at(i).cameraFromWorld->inverse();
    forward = worldFromCamera.rotation * glm::dvec3(0, 0, 1);
    down = worldFromCamera.rotation * glm::dvec3(0, 1, 0);
    centre = worldFromCamera.translation;
  }
};

bool near(const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b) < 1e-12; }

}  // namespace

TEST(PoseTable, AnglesOfEveryKindLookWhereTheirTextbooksSay) {
  const glm::dvec3 east(1, 0, 0), north(0, 1, 0), up(0, 0, 1);
  const auto photo = parsed("name,x,y,z,omega_deg,phi_deg,kappa_deg\na.jpg,1,2,3,90,0,0\nb.jpg,1,2,3,0,0,90\nc.jpg,1,2,3,0,-90,0\n");
  ASSERT_TRUE(photo) << photo.error().text();
  EXPECT_TRUE(photo->warnings.empty());
  EXPECT_TRUE(near(View(*photo, 0).forward, north)) << "omega 90 lifts the view to the north";
  EXPECT_TRUE(near(View(*photo, 0).centre, {1, 2, 3}));
  EXPECT_TRUE(near(View(*photo, 1).down, east)) << "kappa turns the top from north to west";
  EXPECT_TRUE(near(View(*photo, 2).forward, east));
  const auto floor = parsed("label;easting;northing;height;yaw;pitch;roll\na;1;2;3;90;0;0\nb;1;2;3;0;90;0\n");
  ASSERT_TRUE(floor) << floor.error().text();
  EXPECT_TRUE(near(View(*floor, 0).down, -east)) << "yaw is clockwise";
  EXPECT_TRUE(near(View(*floor, 0).forward, -up));
  EXPECT_TRUE(near(View(*floor, 1).forward, north));
  const auto gimbal = parsed("file\tE\tN\tH\tgimbal_yaw\tgimbal_pitch\tgimbal_roll\na\t1\t2\t3\t90\t0\t0\nb\t1\t2\t3\t0\t-90\t0\n");
  ASSERT_TRUE(gimbal) << gimbal.error().text();
  EXPECT_TRUE(near(View(*gimbal, 0).forward, east));
  EXPECT_TRUE(near(View(*gimbal, 0).down, -up));
  EXPECT_TRUE(near(View(*gimbal, 1).forward, -up));
}

TEST(PoseTable, UnitsStandInTheHeaderAndAreAssumedOnlyWithAWarning) {
  const auto degrees = parsed("name,x,y,z,omega,phi,kappa\na,1,2,3,9,18,27\n");
  const auto gon = parsed("#Label,X [m],Y [m],Z [m],Omega [gon],Phi [gon],Kappa [gon]\na,1,2,3,10,20,30\n");
  const auto radians = parsed("name x y z omega_rad phi_rad kappa_rad\na 1 2 3 0.15707963267948966 0.3141592653589793 0.47123889803846897\n");
  ASSERT_TRUE(degrees) << degrees.error().text();
  ASSERT_TRUE(gon) << gon.error().text();
  ASSERT_TRUE(radians) << radians.error().text();
  ASSERT_EQ(degrees->warnings.size(), 1u);
  EXPECT_THAT(degrees->warnings[0].what, HasSubstr("degrees are assumed"));
  EXPECT_TRUE(gon->warnings.empty());
  for (const auto* other : {&*gon, &*radians})
    EXPECT_LT(rotationAngleBetween(*degrees->pictures[0].cameraFromWorld, *other->pictures[0].cameraFromWorld), 1e-14);
}

TEST(PoseTable, ColumnsGoByNameWhateverTheirOrder) {
  const auto set = parsed("# made by hand\nkappa_deg,time_s,\"image\",z,code,omega_deg,y,phi_deg,x\n0,7.5,\"my picture.jpg\",3,q,0,2,0,1\n");
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->pictures[0].name, "my picture.jpg");
  EXPECT_EQ(set->pictures[0].timeSecs, 7.5);
  EXPECT_TRUE(set->pictures[0].hasTime);
  EXPECT_EQ(set->pictures[0].camera, -1);
  EXPECT_TRUE(near(View(*set).centre, {1, 2, 3}));
}

TEST(PoseTable, WhatCannotBeReadRightlyIsRefusedByName) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"name,latitude,longitude,altitude,yaw,pitch,roll\n", "'latitude'", "line 1"},
      {"name,x_ft,y_ft,z_ft,yaw,pitch,roll\n", "feet", "line 1"},
      {"x,y,z,yaw,pitch,roll\n", "no column of names", "line 1"},
      {"name,x,y,yaw,pitch,roll\n", "lacks a column", "line 1"},
      {"name,x,y,z,yaw,pitch\n", "angles is missing", "line 1"},
      {"name,x,y,z\n", "no angles", "line 1"},
      {"name,x,y,z,yaw,pitch,roll,omega,phi,kappa\n", "two kinds", "line 1"},
      {"name,x,y,z,omega_gon,phi_deg,kappa_gon\n", "different units", "line 1"},
      {"name,x,y,z,yaw,pitch,roll\n", "no pose", ""},
      {"name,x,y,z,yaw,pitch,roll\na,1,2,3,4,5\n", "A number is expected", "line 2"},
      {"name,x,y,z,yaw,pitch,roll\na,1,2,high,4,5,6\n", "'high'", "line 2"},
      {"name,x,y,z,yaw,pitch,roll\na,1,2,nan,4,5,6\n", "not finite", "line 2"},
      {"name,x,y,z,yaw,pitch,roll\n,1,2,3,4,5,6\n", "no name", "line 2"},
      {"time,x,y,z,yaw,pitch,roll\nsoon,1,2,3,4,5,6\n", "time is no number", "line 2"},
      {"", "", ""},
  };
  for (const auto& [text, words, line] : cases) {
    const auto set = parsed(text);
    ASSERT_FALSE(set) << text;
    EXPECT_THAT(set.error().what, HasSubstr(words));
    EXPECT_THAT(set.error().where, HasSubstr(line));
    EXPECT_FALSE(set.error().advice.empty());
  }
}

TEST(PoseTable, IsKnownByItsHeader) {
  const auto score = [](const std::string& text) {
    FileProbe probe;
    probe.path = "p.csv";
    probe.extension = "csv";
    probe.head = {reinterpret_cast<const std::byte*>(text.data()), text.size()};
    return PoseTableReader().sniff(probe);
  };
  EXPECT_EQ(score("# by hand\n#Label,X,Y,Z,Yaw,Pitch,Roll\n"), 85);
  EXPECT_EQ(score("name,e,n,h,omega,phi,kappa\n"), 85);
  EXPECT_EQ(score("name,e,n,h\n"), 0);
}

TEST(PoseTable, SurvivesRandomDamage) {
  const std::string whole = "#Label;X;Y;Z;Omega [gon];Phi [gon];Kappa [gon]\na.jpg;100;200;30;1.5;-2.5;100\nb.jpg;101;200;30;1;2;300\n";
  std::mt19937 random(2);
  for (int i = 0; i < 4000; ++i) {
    std::string text = whole;
    for (int k = 0; k < 3; ++k) text[random() % text.size()] = "0123456789.-;,# [\n\t\"x\xff"[random() % 21];
    (void)parsed(text);
  }
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "command_line.h"
#include "io/picture_file.h"

namespace alidade::test {

namespace {

std::string demoProject() {
  return quoted(smallDemo() / "demo.alidade");
}

}  // namespace

TEST(CommandLine, MakesTheSampleInspectionAndSaysWhatItHolds) {
  const auto info = alidadeCli("info --json " + demoProject());
  ASSERT_EQ(info.exitCode, 0) << info.errors;
  const auto file = info.json()["files"][0];
  EXPECT_EQ(file["kind"], "project");
  EXPECT_EQ(file["frames"], 4);
  EXPECT_EQ(file["frames_with_pose"], 4);
  EXPECT_EQ(file["scans"], 1);
  EXPECT_EQ(file["designs"], 1);
  EXPECT_GT(file["stake_points"], 0);
  EXPECT_TRUE(file["source_problems"].empty());
}

TEST(CommandLine, DrawsAFrameWithItsTitleBlockAndTextChunks) {
  const auto picture = scratch() / "overlay.png";
  const auto outcome = alidadeCli("overlay --json " + demoProject() + " --frame 0 -o " + quoted(picture));
  ASSERT_EQ(outcome.exitCode, 0) << outcome.errors;
  const auto json = outcome.json();
  EXPECT_EQ(json["width"], 480);
  EXPECT_EQ(json["height"], 360);
  EXPECT_GT(json["points_drawn"], 1000);
  EXPECT_LE(json["points_drawn"], json["points_total"]);
  EXPECT_LT(json["worst_error_px"], 0.1);
  EXPECT_GT(json["elements"].size(), 3u);
  const auto image = readPicture(picture.string());
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width(), 480);
  EXPECT_GT(image->height(), 360) << "the title block stands below the picture";
  const auto text = readPngText(picture.string());
  ASSERT_TRUE(text);
  EXPECT_NE(text->at("Alidade:frame").find("1 of 4"), std::string::npos);
}

TEST(CommandLine, ABarePictureHasTheAskedSizeAndNothingElse) {
  const auto picture = scratch() / "bare.png";
  const auto outcome = alidadeCli("overlay " + demoProject() + " --frame 1 --size 240x180 --bare --hidden hide -o " +
                                  quoted(picture));
  ASSERT_EQ(outcome.exitCode, 0) << outcome.errors;
  const auto image = readPicture(picture.string());
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width(), 240);
  EXPECT_EQ(image->height(), 180);
}

TEST(CommandLine, DensityDrawsFewerPointsAndNothingAtZero) {
  std::uint64_t last = ~0ull;
  for (const char* density : {"1", "0.5", "0.1", "0"}) {
    const auto outcome = alidadeCli("overlay --json " + demoProject() + " --frame 0 --size 240x180 --density " + density +
                                    " -o " + quoted(scratch() / "density.png"));
    ASSERT_EQ(outcome.exitCode, 0) << outcome.errors;
    const std::uint64_t drawn = outcome.json()["points_drawn"];
    EXPECT_LT(drawn, last);
    last = drawn;
  }
  EXPECT_EQ(last, 0u);
}

namespace {

std::uint64_t pointsDrawn(const std::string& options) {
  const auto outcome = alidadeCli("overlay --json " + demoProject() + " --frame 0 --size 240x180 --passes points " + options + " -o " +
                                  quoted(scratch() / "points.png"));
  EXPECT_EQ(outcome.exitCode, 0) << options << outcome.errors << outcome.output;
  return outcome.exitCode == 0 ? outcome.json()["points_drawn"].get<std::uint64_t>() : 0;
}

}  // namespace

TEST(CommandLine, ClipPlanesCutAndTheirSidesMakeTheWhole) {
  const std::uint64_t all = pointsDrawn("");
  const std::uint64_t west = pointsDrawn("--clip-plane 2683512,1247800,412,90"), east = pointsDrawn("--clip-plane 2683512,1247800,412,270");
  EXPECT_GT(west, 0u);
  EXPECT_GT(east, 0u);
  EXPECT_EQ(west + east, all);
  const std::uint64_t corner = pointsDrawn("--clip-plane 2683512,1247800,412,90 --clip-plane 2683512,1247800,412,0,90");
  EXPECT_GT(corner, 0u);
  EXPECT_LT(corner, west);
  const auto wrong = alidadeCli("overlay " + demoProject() + " --frame 0 --clip-plane 1,2,3 -o " + quoted(scratch() / "no.png"));
  EXPECT_EQ(wrong.exitCode, 2);
  EXPECT_NE(wrong.errors.find("azimuth"), std::string::npos) << wrong.errors;
}

TEST(CommandLine, DensityByAreaAndABudgetOfPointsAreHeld) {
  const std::uint64_t dense = pointsDrawn("--points-per-square-metre 1e6"), sparse = pointsDrawn("--points-per-square-metre 1");
  EXPECT_GT(sparse, 0u);
  EXPECT_LT(2 * sparse, dense);
  EXPECT_LT(sparse, pointsDrawn("--density-by pixel"));
  const std::uint64_t few = pointsDrawn("--point-budget 5000");
  EXPECT_LE(few, 5000u);
  EXPECT_GT(few, 3000u);
  for (const char* options : {"--point-budget 0", "--point-budget 1.5", "--point-budget -3", "--frame-time 40", "--with glitter",
                              "--points-per-square-metre 5 --density-by pixel", "--light 10,100"}) {
    const auto wrong = alidadeCli("overlay " + demoProject() + " --frame 0 " + options + " -o " + quoted(scratch() / "no.png"));
    EXPECT_EQ(wrong.exitCode, 2) << options << wrong.errors;
  }
}

TEST(CommandLine, ARangeKeepsToABudgetOrATime) {
  const auto folder = scratch() / "paced";
  const auto outcome = alidadeCli("overlay --json " + demoProject() + " --frames 0:3 --size 240x180 --passes points --point-budget 2000 --frame-time 50 -o " +
                                  quoted(folder));
  ASSERT_EQ(outcome.exitCode, 0) << outcome.errors << outcome.output;
  EXPECT_EQ(outcome.json()["frames"], 4);
}

TEST(CommandLine, WhatIsPickedProjectsBackToItsPixel) {
  const auto picked = alidadeCli("pick --json " + demoProject() + " --frame 0", "240 200\n120.25,260.5 # left\n-5 3\n");
  ASSERT_EQ(picked.exitCode, 0) << picked.errors << picked.output;
  const auto points = picked.json()["points"];
  ASSERT_EQ(points.size(), 3u);
  EXPECT_TRUE(points[2]["world_m"].is_null());
  int seen = 0;
  for (int i = 0; i < 2; ++i) {
    if (points[i]["world_m"].is_null()) continue;
    ++seen;
    std::ostringstream world;
    world.precision(12);
    for (const auto& axis : points[i]["world_m"]) world << axis.get<double>() << " ";
    const auto back = alidadeCli("project-points --json " + demoProject() + " --frame 0", world.str()).json()["points"][0];
    EXPECT_NEAR(back["u_px"], points[i]["u_px"], 0.02);
    EXPECT_NEAR(back["v_px"], points[i]["v_px"], 0.02);
    EXPECT_NEAR(back["depth_m"], points[i]["depth_m"], 0.001);
  }
  EXPECT_GT(seen, 0);
  EXPECT_EQ(alidadeCli("pick " + demoProject() + " --frame 0", "12\n").exitCode, 1);
}

TEST(CommandLine, AddsToAProjectWhatANewOneWouldHave) {
  const auto project = scratch() / "grown.alidade";
  ASSERT_EQ(alidadeCli("new " + quoted(project) + " --scan " + quoted(smallDemo() / "scan.las")).exitCode, 0);
  const auto dry = alidadeCli("add --json --dry-run " + quoted(project) + " " + quoted(smallDemo() / "images") + " " + quoted(smallDemo() / "sparse"));
  ASSERT_EQ(dry.exitCode, 0) << dry.errors << dry.output;
  EXPECT_EQ(dry.json()["frames_with_pose"], 4);
  EXPECT_EQ(alidadeCli("info --json " + quoted(project)).json()["files"][0]["frames"], 0);
  const auto added = alidadeCli("add --json " + quoted(project) + " " + quoted(smallDemo() / "images") + " " + quoted(smallDemo() / "sparse"));
  ASSERT_EQ(added.exitCode, 0) << added.errors << added.output;
  EXPECT_TRUE(added.json()["saved"]);
  EXPECT_EQ(alidadeCli("info --json " + quoted(project)).json()["files"][0]["frames_with_pose"], 4);
  EXPECT_EQ(alidadeCli("add " + quoted(project)).exitCode, 2);
}

TEST(CommandLine, LeavesElementsAndStoreysOut) {
  const auto elements = [](const std::string& options) {
    const auto outcome = alidadeCli("overlay --json " + demoProject() + " --frame 0 --size 240x180 " + options + " -o " + quoted(scratch() / "some.png"));
    EXPECT_EQ(outcome.exitCode, 0) << options << outcome.errors << outcome.output;
    return outcome.json()["elements"];
  };
  const auto all = elements("");
  ASSERT_GT(all.size(), 3u);
  const std::string id = all[0]["global_id"], storey = all[0]["storey"];
  for (const auto& element : elements("--hide '" + id + "'")) EXPECT_NE(element["global_id"], id);
  const auto level = elements("--storey '" + storey + "'");
  EXPECT_FALSE(level.empty());
  for (const auto& element : level) EXPECT_EQ(element["storey"], storey);
  const auto wrong = alidadeCli("overlay --json " + demoProject() + " --frame 0 --storey Attic -o " + quoted(scratch() / "no.png"));
  EXPECT_EQ(wrong.exitCode, 1);
  EXPECT_NE(wrong.json()["error"]["advice"].get<std::string>().find(storey), std::string::npos);
}

TEST(CommandLine, RefinesAPoseFromObservationsAndRemembersIt) {
  const auto observations = smallDemo() / "observations.csv";
  ASSERT_TRUE(std::filesystem::exists(observations));
  const std::string common =
      "refine --json " + demoProject() + " --frame 0 --observations " + quoted(observations);
  const auto dry = alidadeCli(common + " --dry-run --at 2683500,1247800,412");
  ASSERT_EQ(dry.exitCode, 0) << dry.errors << dry.output;
  const auto json = dry.json();
  EXPECT_TRUE(json["converged"]);
  EXPECT_LT(json["rms_px"], 1.0);
  EXPECT_EQ(json["position_std_m"].size(), 3u);
  EXPECT_GT(json["expected_error_mm"], 0.0);
  EXPECT_FALSE(json["saved"]);
  const auto locked = alidadeCli(common + " --dry-run --lock position");
  ASSERT_EQ(locked.exitCode, 0) << locked.errors;
  EXPECT_EQ(locked.json()["position_std_m"][0], 0.0);
}

TEST(CommandLine, ARigsMountsStayInTheProject) {
  const auto rig = scratch() / "rig.json", project = scratch() / "rig.alidade";
  std::ofstream(scratch() / "way.txt") << "-1 0 0 0 0 0 0 1\n0 1 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n";
  std::ofstream(rig) << R"({"alidade_rig": 1, "trajectory": "way.txt", "cameras": [{"name": "left", "pictures": )" << smallDemo() / "images"
                     << R"(, "calibration": )" << smallDemo() / "camera.yml" << R"(, "rate_hz": 15, "start_s": 0,
    "sensor_from_camera": {"position_m": [0.1, -0.2, 0.05], "rotation_wxyz": [0.6, 0.8, 0, 0]}}]})";
  const auto made = alidadeCli("new " + quoted(project) + " --rig " + quoted(rig));
  ASSERT_EQ(made.exitCode, 0) << made.errors;
  const auto mounts = alidadeCli("info --json " + quoted(project)).json()["files"][0]["mounts"];
  ASSERT_EQ(mounts.size(), 1u);
  EXPECT_EQ(mounts[0]["camera"], "left");
  EXPECT_EQ(mounts[0]["body"], "way");
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(mounts[0]["position_on_body_m"][i], (std::array{0.1, -0.2, 0.05}[i]), 1e-12);
  EXPECT_NEAR(mounts[0]["body_from_camera_wxyz"][1], 0.8, 1e-12);

  const auto set = alidadeCli("mount --json " + quoted(project) + " --position 0.11,-0.2,0.05 --position-sigma 1,1,2");
  ASSERT_EQ(set.exitCode, 0) << set.errors << set.output;
  const auto after = set.json()["mounts"][0];
  EXPECT_NEAR(after["position_on_body_m"][0], 0.11, 1e-12);
  EXPECT_NEAR(after["angles_deg"][0], 2 * std::atan2(0.8, 0.6) * 180 / std::acos(-1), 1e-9);
  EXPECT_NEAR(after["offset_std_m"][2], 0.002, 1e-12);
  EXPECT_TRUE(set.json()["saved"]);
  EXPECT_NEAR(alidadeCli("mount --json " + quoted(project)).json()["mounts"][0]["position_on_body_m"][0], 0.11, 1e-12);
  const auto far = alidadeCli("mount " + quoted(project) + " --position 2683512,1247811,413");
  EXPECT_EQ(far.exitCode, 1);
  EXPECT_NE(far.errors.find("in the body's axes"), std::string::npos) << far.errors;
  EXPECT_EQ(alidadeCli("mount " + quoted(project) + " --position 1,2").exitCode, 2);
  EXPECT_EQ(alidadeCli("mount " + quoted(project) + " --position-sigma=-1,0,0").exitCode, 1);
}

TEST(CommandLine, AProjectKeepsDepthsAndRefinesFromThem) {
  const auto project = smallDemo() / "kept.alidade";
  std::filesystem::copy_file(smallDemo() / "demo.alidade", project, std::filesystem::copy_options::overwrite_existing);
  std::ifstream file(smallDemo() / "observations.csv");
  std::string header, line, rows, name;
  std::getline(file, header);
  ASSERT_EQ(header, "u,v,e,n,h,sigma_px,name");
  while (std::getline(file, line)) {
    rows += line + ",,\n";
    if (name.empty()) name = line.substr(line.rfind(',') + 1);
  }
  const auto first = alidadeCli("refine --json --dry-run --frame 0 --observations " + quoted(smallDemo() / "observations.csv") + " " + quoted(project));
  ASSERT_EQ(first.exitCode, 0) << first.errors;
  const auto csv = scratch() / "depth.csv";
  const auto refined = [&](double depth) {
    std::ofstream(csv) << header << ",kind,depth_m\n" << rows << ",,,,,," << name << ",depth," << depth << "\n";
    return alidadeCli("refine --json --keep --frame 0 --observations " + quoted(csv) + " " + quoted(project));
  };
  const auto depthOf = [](const nlohmann::json& json) {
    for (const auto& residual : json["residuals"])
      if (residual["kind"] == "depth") return residual["residual_m"].get<double>();
    return std::nan("");
  };
  const auto far = refined(1000);  // an outlier, whose residual says how deep the point lies
  ASSERT_EQ(far.exitCode, 0) << far.errors << far.output;
  const double depth = 1000 + depthOf(far.json());
  ASSERT_GT(depth, 0.5);
  ASSERT_LT(depth, 100);
  ASSERT_EQ(refined(depth + 0.002).exitCode, 0);
  // The project's own from now on, in place of the wrong one.
  const auto own = alidadeCli("refine --json --dry-run --frame 0 " + quoted(project));
  ASSERT_EQ(own.exitCode, 0) << own.errors << own.output;
  EXPECT_NEAR(depthOf(own.json()), -0.002, 0.002);
  EXPECT_EQ(alidadeCli("info --json " + quoted(project)).json()["files"][0]["observations"], own.json()["residuals"].size());
  EXPECT_EQ(own.json()["residuals"].size(), first.json()["residuals"].size() + 1);
  EXPECT_NE(alidadeCli("refine --dry-run --frame 0 " + quoted(project)).output.find("depth"), std::string::npos);
}

TEST(CommandLine, ADegenerateSetIsRefusedWithItsReasonAndTheProjectUnchanged) {
  const auto observations = scratch() / "two.csv";
  std::ofstream(observations) << "u,v,e,n,h\n100,100,2683500,1247800,412\n200,200,2683501,1247801,413\n";
  const auto outcome = alidadeCli("refine --json " + demoProject() + " --frame 0 --observations " + quoted(observations));
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_FALSE(outcome.json()["converged"]);
  EXPECT_FALSE(outcome.json()["reason"].get<std::string>().empty());
  EXPECT_FALSE(outcome.json()["saved"]);
}

TEST(CommandLine, RefineRefusesOptionsThatItWouldNotHeed) {
  const std::string rows = " --observations " + quoted(smallDemo() / "observations.csv");
  for (const std::string& options : {std::string("--auto --free rig"), std::string("--auto --rig"),
                                     std::string("--auto --trajectory"), std::string("--auto --keyframes 5"),
                                     "--keyframes 5" + rows, "--within 2" + rows, std::string("--within 2"), std::string("--to scan"),
                                     std::string("--auto --within nan")}) {
    const auto outcome = alidadeCli("refine --dry-run " + options + " " + demoProject());
    EXPECT_EQ(outcome.exitCode, 2) << options;
    EXPECT_NE(outcome.errors.find("--"), std::string::npos) << outcome.errors;
  }
}

TEST(CommandLine, AlignsAFrameWithTheDesignAndSaysWhatItKnows) {
  // A point that the frame sees, from its own control.
  std::ifstream file(smallDemo() / "observations.csv");
  std::string header, row;
  std::getline(file, header), std::getline(file, row);
  std::vector<std::string> cells(1);
  for (const char c : row) c == ',' ? cells.emplace_back() : cells.back().append(1, c);
  const std::string point = cells[2] + "," + cells[3] + "," + cells[4];
  const auto aligned = alidadeCli("refine --json --auto --to design --frame 0 --within 3 --dry-run --at " + point + " " + demoProject());
  ASSERT_EQ(aligned.exitCode, 0) << aligned.errors << aligned.output;
  const auto frame = aligned.json()["frames"][0];
  EXPECT_TRUE(frame["converged"]) << frame["reason"];
  EXPECT_GT(frame["evidence"]["places_agreeing"], 100);
  EXPECT_LT(frame["turned_rad"], 0.01);
  EXPECT_GT(frame["ellipse_95"]["semi_major_m"], 0);
  EXPECT_GE(frame["ellipse_95"]["semi_major_m"], frame["ellipse_95"]["semi_minor_m"]);
  EXPECT_GT(frame["expected_error_mm"], 0);
  EXPECT_LT(frame["expected_error_mm"], 500);
  EXPECT_FALSE(aligned.json()["saved"]);
  EXPECT_EQ(alidadeCli("refine --auto --to wall " + demoProject()).exitCode, 2);
  EXPECT_EQ(alidadeCli("refine --to design --observations x.csv " + demoProject()).exitCode, 2);
  EXPECT_EQ(alidadeCli("refine --auto --sequence " + demoProject()).exitCode, 2);
}

TEST(CommandLine, ProjectPointsAlwaysPrintsFourColumns) {
  const auto outcome =
      alidadeCli("project-points " + demoProject() + " --frame 0", "2683500 1247800 412\n0 0 0\nnan 1 2\n# note\n1,2,3\n");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.errors;
  std::istringstream lines(outcome.output);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    std::istringstream cells(line);
    std::string u, v, depth, state, extra;
    ASSERT_TRUE(cells >> u >> v >> depth >> state) << line;
    EXPECT_FALSE(cells >> extra) << line;
  }
  EXPECT_EQ(count, 4);
}

TEST(CommandLine, BadUsageIsTwoAndFailureIsOne) {
  EXPECT_EQ(alidadeCli("").exitCode, 2);
  EXPECT_EQ(alidadeCli("frobnicate").exitCode, 2);
  EXPECT_EQ(alidadeCli("overlay").exitCode, 2);
  EXPECT_EQ(alidadeCli("--help").exitCode, 0);
  EXPECT_EQ(alidadeCli("demo " + quoted(scratch() / "x") + " --points -5").exitCode, 2);
  const auto missing = alidadeCli("overlay /nowhere/p.alidade --frame 0 -o " + quoted(scratch() / "x.png"));
  EXPECT_EQ(missing.exitCode, 1);
  EXPECT_NE(missing.errors.find("/nowhere/p.alidade"), std::string::npos);
  const auto frame = alidadeCli("overlay " + demoProject() + " --frame 99 -o " + quoted(scratch() / "x.png"));
  EXPECT_EQ(frame.exitCode, 1);
  EXPECT_NE(frame.errors.find("99"), std::string::npos);
}

TEST(CommandLine, AFullDiskOnExportIsAClearErrorAndLeavesNoFile) {
  const auto outcome = alidadeCli("overlay " + demoProject() + " --frame 0 --size 240x180 -o /dev/full");
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_FALSE(outcome.errors.empty());
}

TEST(CommandLine, BadValuesAreBadUsageBeforeAnythingIsLoaded) {
  const std::string overlay = "overlay /nowhere/p.alidade --frame 0 -o x.png ";
  for (const std::string wrong : {"--size 0x0", "--size 100", "--size 640X360", "--passes image,sky", "--density 2"}) {
    const auto outcome = alidadeCli(overlay + wrong);
    EXPECT_EQ(outcome.exitCode, 2) << wrong;
    EXPECT_NE(outcome.errors.find(wrong.substr(0, wrong.find(' '))), std::string::npos) << outcome.errors;
  }
  const std::string refine = "refine /nowhere/p.alidade --frame 0 --observations o.csv ";
  EXPECT_EQ(alidadeCli(refine + "--lock roll").exitCode, 2);
  EXPECT_EQ(alidadeCli(refine + "--at 1,2").exitCode, 2);
}

TEST(CommandLine, JsonIsAnsweredOnErrorsToo) {
  const auto usage = alidadeCli("overlay --json");
  EXPECT_EQ(usage.exitCode, 2);
  EXPECT_FALSE(usage.json()["error"]["what"].get<std::string>().empty()) << usage.output;
  const auto verb = alidadeCli("frobnicate --json");
  EXPECT_EQ(verb.exitCode, 2);
  EXPECT_NE(verb.json()["error"]["what"].get<std::string>().find("frobnicate"), std::string::npos) << verb.output;
  const auto bytes = alidadeCli("overlay --json /nowhere/\xff.alidade --frame 0 -o x.png");
  EXPECT_EQ(bytes.exitCode, 1) << bytes.errors;
  EXPECT_FALSE(bytes.json()["error"]["what"].get<std::string>().empty()) << bytes.output;
}

TEST(CommandLine, APictureIsNeverWrittenOverTheProjectOrItsSources) {
  const auto picture = smallDemo() / "images/frame_0000.png";
  const auto before = std::filesystem::file_size(picture);
  const auto outcome = alidadeCli("overlay " + demoProject() + " --frame 0 -o " + quoted(picture));
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_NE(outcome.errors.find("not overwritten"), std::string::npos) << outcome.errors;
  EXPECT_EQ(std::filesystem::file_size(picture), before);
  EXPECT_EQ(alidadeCli("overlay " + demoProject() + " --frame 0 -o " + demoProject()).exitCode, 1);
  EXPECT_EQ(alidadeCli("info " + demoProject()).exitCode, 0);
  const auto jpeg = alidadeCli("overlay " + demoProject() + " --frame 0 -o " + quoted(scratch() / "x.jpg"));
  EXPECT_EQ(jpeg.exitCode, 1);
  EXPECT_NE(jpeg.errors.find("PNG"), std::string::npos) << jpeg.errors;
}

TEST(CommandLine, NewReplacesAProjectOnlyWhereAskedAndNothingElseEver) {
  const std::string scan = " --scan " + quoted(smallDemo() / "scan.las");
  const auto project = scratch() / "again.alidade", other = scratch() / "other.txt";
  ASSERT_EQ(alidadeCli("new " + quoted(project) + scan).exitCode, 0);
  EXPECT_EQ(alidadeCli("new " + quoted(project) + scan).exitCode, 1);
  EXPECT_EQ(alidadeCli("new " + quoted(project) + scan + " --overwrite").exitCode, 0);
  std::ofstream(other) << "somebody's notes";
  EXPECT_EQ(alidadeCli("new " + quoted(other) + scan + " --overwrite").exitCode, 1);
  EXPECT_EQ(std::filesystem::file_size(other), 16u);
}

TEST(CommandLine, AFileSizeLimitIsAClearErrorAndLeavesTheOldFileAlone) {
  const auto folder = scratch() / "limited";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "keep.png") << "old";
  const auto outcome = limited("overlay " + demoProject() + " --frame 0 -o " + quoted(folder / "keep.png"), 8);
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_NE(outcome.errors.find("no room"), std::string::npos) << outcome.errors;
  EXPECT_EQ(std::filesystem::file_size(folder / "keep.png"), 3u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST(CommandLine, StandardInputThatCannotBeReadIsAnError) {
  const auto folder = alidadeCli("project-points " + demoProject() + " --frame 0 < /tmp");
  EXPECT_EQ(folder.exitCode, 1);
  EXPECT_NE(folder.errors.find("standard input"), std::string::npos) << folder.errors;
  EXPECT_EQ(alidadeCli("project-points " + demoProject() + " --frame 0 <&-").exitCode, 1);
}

TEST(CommandLine, NewSaysWhatIsThereTwiceAndWhatIsMissing) {
  const auto scan = quoted(smallDemo() / "scan.las");
  const auto twice = alidadeCli("new --json " + quoted(scratch() / "twice.alidade") + " --scan " + scan + " " + scan +
                                " --design " + quoted(smallDemo() / "design.ifc"));
  ASSERT_EQ(twice.exitCode, 0) << twice.errors;
  EXPECT_EQ(twice.json()["scans"], 1);
  // The scan's WKT and the design's EPSG number state the same system.
  ASSERT_EQ(twice.json()["notes"].size(), 1u) << twice.output;
  EXPECT_NE(twice.json()["notes"][0].get<std::string>().find("already"), std::string::npos);
  EXPECT_EQ(alidadeCli("new --json " + quoted(scratch() / "bare.alidade")).json()["notes"].size(), 1u);
}

TEST(CommandLine, NewSaysWhereALensIsMissingOrOfAnotherPictureSize) {
  const auto poses = scratch() / "poses.csv", lens = scratch() / "lens.yml", images = smallDemo() / "images";
  ASSERT_EQ(alidadeCli("export-cameras " + demoProject() + " -o " + quoted(poses)).exitCode, 0);
  const std::string common = " --images " + quoted(images) + " --cameras " + quoted(poses);
  const auto without = alidadeCli("new " + quoted(scratch() / "lensless.alidade") + common);
  ASSERT_EQ(without.exitCode, 0) << without.errors;
  EXPECT_NE(without.output.find("4 frames (4 with a pose, 4 without a lens)"), std::string::npos) << without.output;
  EXPECT_NE(without.output.find("the lens is missing"), std::string::npos) << without.output;
  // The pictures are of 480 × 360.
  std::ofstream(lens) << "%YAML:1.0\n---\nimage_width: 1280\nimage_height: 960\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n"
                         "   dt: d\n   data: [ 560., 0, 640., 0, 560., 480., 0, 0, 1 ]\ndistortion_coefficients: !!opencv-matrix\n"
                         "   rows: 5\n   cols: 1\n   dt: d\n   data: [ 0., 0., 0., 0., 0. ]\n";
  const auto wrong = alidadeCli("new " + quoted(scratch() / "wronglens.alidade") + common + " " + quoted(lens));
  ASSERT_EQ(wrong.exitCode, 0) << wrong.errors;
  EXPECT_NE(wrong.output.find("4 frames (4 with a pose), "), std::string::npos) << wrong.output;
  EXPECT_NE(wrong.output.find("has 480×360 pixels, its calibration 'lens' is for 1280×960"), std::string::npos) << wrong.output;
}

TEST(CommandLine, CamerasAreExportedToWhatTheEndingSaysOrAFolder) {
  const auto refused = alidadeCli("export-cameras " + demoProject() + " -o " + quoted(scratch() / "cameras.xyz"));
  EXPECT_EQ(refused.exitCode, 1);
  EXPECT_NE(refused.errors.find(".json or .csv"), std::string::npos) << refused.errors;
  EXPECT_FALSE(std::filesystem::exists(scratch() / "cameras.xyz"));
  EXPECT_EQ(alidadeCli("export-cameras " + demoProject() + " -o " + quoted(scratch() / "cameras.v2/")).exitCode, 0);
  EXPECT_TRUE(std::filesystem::exists(scratch() / "cameras.v2" / "cameras.txt"));
}

TEST(CommandLine, AMissingSourceIsNamed) {
  const auto folder = scratch() / "moved";
  std::filesystem::create_directories(folder);
  std::filesystem::copy_file(smallDemo() / "demo.alidade", folder / "demo.alidade",
                             std::filesystem::copy_options::overwrite_existing);
  const auto info = alidadeCli("info --json " + quoted(folder / "demo.alidade"));
  EXPECT_FALSE(info.json()["files"][0]["source_problems"].empty());
  const auto overlay =
      alidadeCli("overlay " + quoted(folder / "demo.alidade") + " --frame 0 -o " + quoted(scratch() / "x.png"));
  EXPECT_EQ(overlay.exitCode, 1);
  EXPECT_NE(overlay.errors.find("Move the data along"), std::string::npos) << overlay.errors;
  EXPECT_EQ(std::count(overlay.errors.begin(), overlay.errors.end(), '\n'), 7) << "five warnings, their number, the error";
}

}  // namespace alidade::test

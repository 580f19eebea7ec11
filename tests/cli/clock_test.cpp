// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// How pictures and poses agree in time: shown, set, estimated, of a video whose trajectory's clock is known to be ahead.

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command_line.h"

namespace alidade::test {

namespace {

using ::testing::HasSubstr;

/// Two seconds at 15 Hz; the poses' clock is 0.2 s ahead.
std::filesystem::path video() {
  static const std::filesystem::path folder = [] {
    const auto made = scratch() / "clock_video";
    const auto outcome = alidadeCli("demo " + quoted(made) + " --video --points 1000 --frames 30 --width 320 --height 240 --clock-offset 0.2");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.errors;
    return made;
  }();
  return folder / "demo.alidade";
}

/// A copy that may be changed; sources stay where they are.
std::filesystem::path copyOfVideo(const std::string& name) {
  const auto copy = video().parent_path() / name;
  std::filesystem::copy_file(video(), copy, std::filesystem::copy_options::overwrite_existing);
  return copy;
}

}  // namespace

TEST(Clock, ShowsWhatTheProjectSaysAndChangesNothing) {
  const auto shown = alidadeCli("clock --json " + quoted(video()));
  ASSERT_EQ(shown.exitCode, 0) << shown.errors;
  const auto json = shown.json();
  EXPECT_EQ(json["trajectory"], "trajectory");
  EXPECT_EQ(json["clock_offset_s"], 0.0);
  EXPECT_TRUE(json["clock_offset_std_s"].is_null());
  EXPECT_EQ(json["frames_posed"], 30);
  EXPECT_FALSE(json["saved"]);
  EXPECT_EQ(json["poses"], 177);
}

TEST(Clock, EstimatesTheOffsetThatWasInjectedAndKeepsItUnlessTold) {
  const auto project = copyOfVideo("estimated.alidade");
  const auto tried = alidadeCli("clock --json --dry-run --estimate " + quoted(project));
  ASSERT_EQ(tried.exitCode, 0) << tried.output << tried.errors;
  EXPECT_FALSE(tried.json()["saved"]);
  EXPECT_EQ(alidadeCli("clock --json " + quoted(project)).json()["clock_offset_s"], 0.0);

  const auto found = alidadeCli("clock --json --estimate " + quoted(project));
  ASSERT_EQ(found.exitCode, 0) << found.output << found.errors;
  const auto estimate = found.json()["estimate"];
  EXPECT_TRUE(estimate["found"]);
  const double std = estimate["std_s"];
  EXPECT_LT(std, 0.004);
  EXPECT_NEAR(estimate["offset_s"], 0.2, 4 * std);
  const auto kept = alidadeCli("clock --json " + quoted(project)).json();
  EXPECT_EQ(kept["clock_offset_s"], estimate["offset_s"]);
  EXPECT_EQ(kept["clock_offset_std_s"], estimate["std_s"]);
}

TEST(Clock, SetsOffsetRateAndReadOutAndFramesLoseTheirPoseWhereTheTrajectoryEnds) {
  const auto project = copyOfVideo("set.alidade");
  // Poses go from half a second before the first frame to half a second after the last, on a clock 0.2 s ahead.
  const auto late = alidadeCli("clock --json --offset 1.2 --readout 20 " + quoted(project));
  ASSERT_EQ(late.exitCode, 0) << late.errors;
  EXPECT_EQ(late.json()["clock_offset_s"], 1.2);
  const int posed = late.json()["frames_posed"];
  EXPECT_GE(posed, 21);  // 0.5 s of frames are beyond the end
  EXPECT_LE(posed, 24);
  for (const auto& readout : late.json()["readout_s"]) EXPECT_DOUBLE_EQ(readout, 0.02);
  // At half the rate the video lasts twice as long as the poses.
  const auto slow = alidadeCli("clock --json --offset 0.2 --rate 7.5 " + quoted(project));
  ASSERT_EQ(slow.exitCode, 0) << slow.errors;
  const int slowly = slow.json()["frames_posed"];
  EXPECT_GE(slowly, 18);
  EXPECT_LE(slowly, 20);
}

TEST(Clock, TakesTimesFromATableAndRefusesOneThatDoesNotFit) {
  const auto project = copyOfVideo("table.alidade");
  const auto table = scratch() / "times.csv", brief = scratch() / "brief.csv";
  std::ofstream out(table);
  for (int i = 0; i < 30; ++i) out << 0.2 + i / 15.0 << '\n';  // on the poses' clock
  out.close();
  std::ofstream(brief) << "0\n0.1\n";
  const auto taken = alidadeCli("clock --json --times " + quoted(table) + " " + quoted(project));
  ASSERT_EQ(taken.exitCode, 0) << taken.errors;
  EXPECT_EQ(taken.json()["frames_posed"], 30);
  const auto refused = alidadeCli("clock --times " + quoted(brief) + " " + quoted(project));
  EXPECT_EQ(refused.exitCode, 1);
  EXPECT_THAT(refused.errors, HasSubstr("30"));
}

TEST(Clock, SaysWhatItLacks) {
  const auto pictures = smallDemo() / "demo.alidade";
  const auto without = alidadeCli("clock --estimate " + quoted(pictures));
  EXPECT_EQ(without.exitCode, 1);
  EXPECT_THAT(without.errors, HasSubstr("trajector"));
  EXPECT_EQ(alidadeCli("clock --estimate --offset 1 " + quoted(video())).exitCode, 2);
  EXPECT_EQ(alidadeCli("clock --rate 0 " + quoted(video())).exitCode, 2);
  for (const char* option : {"--offset nan", "--offset inf", "--rate nan", "--readout nan", "--estimate --range nan", "--rate 15 --start nan"})
    EXPECT_EQ(alidadeCli(std::string("clock ") + option + " " + quoted(video())).exitCode, 2) << option;
  const auto far = alidadeCli("clock --offset 1e300 " + quoted(video()));
  EXPECT_EQ(far.exitCode, 1);
  EXPECT_THAT(far.errors, HasSubstr("no frame has a pose"));
  EXPECT_EQ(alidadeCli("clock --json " + quoted(video())).json()["frames_posed"], 30);
  EXPECT_EQ(alidadeCli("clock --trajectory other " + quoted(video())).exitCode, 1);
}

}  // namespace alidade::test

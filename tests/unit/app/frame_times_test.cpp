// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/frame_times.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {

namespace {

class FrameTimesTest : public testing::Test {
 protected:
  FrameTimesTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "alidade-times-XXXXXX").string();
    m_folder = mkdtemp(pattern.data());
    for (int i = 0; i < 4; ++i) {
      Frame frame;
      frame.id = FrameId{i + 1};
      frame.name = "cam_" + std::to_string(i) + ".png";
      frame.timeSecs = i;
      m_project.frames.push_back(frame);
    }
  }
  ~FrameTimesTest() override { std::filesystem::remove_all(m_folder); }

  std::string table(const std::string& text) const {
    const auto path = m_folder / "times.csv";
    std::ofstream(path) << text;
    return path.string();
  }
  Result<void> set(const std::string& text) {
    const auto times = readFrameTimes(table(text));
    if (!times) return fail(times.error());
    return setFrameTimes(m_project, {}, *times);
  }
  std::vector<double> secs() const {
    std::vector<double> all;
    for (const Frame& frame : m_project.frames) all.push_back(frame.timeSecs);
    return all;
  }

  std::filesystem::path m_folder;
  Project m_project;
};

}  // namespace

TEST_F(FrameTimesTest, TakesTimesAloneOrWithNamesInEitherOrder) {
  ASSERT_TRUE(set("0.5\n0.6\n0.75\n0.8\n"));
  EXPECT_THAT(secs(), testing::ElementsAre(0.5, 0.6, 0.75, 0.8));
  ASSERT_TRUE(set("name,time\ncam_0.png,1\ncam_2.png,3\ncam_1.png,2.5\ncam_3.png,4\nother.png,9\n"));
  EXPECT_THAT(secs(), testing::ElementsAre(1, 2.5, 3, 4));
  // EuRoC's data.csv: nanoseconds since 1970, then the file's name.
  ASSERT_TRUE(set("#timestamp [ns],filename\n1403636579763555584,cam_0.png\n1403636579813555456,cam_1.png\n"
                  "1403636579863555584,cam_2.png\n1403636579913555456,cam_3.png\n"));
  EXPECT_NEAR(secs()[0], 1403636579.763555584, 1e-6);
  EXPECT_NEAR(secs()[1] - secs()[0], 0.05, 1e-6);
}

TEST_F(FrameTimesTest, RefusesWithTheLineAndChangesNothing) {
  const std::vector<double> before = secs();
  const std::pair<const char*, const char*> cases[] = {
      {"", "no time"},
      {"a,b\nc,d\n", "is no time"},
      {"1\n2\n3\n", "3 times for 4 frames"},
      {"1\n2\n2\n3\n", "not later than the one before"},
      {"1\n2\n1.5\n3\n", "not later than the one before"},
      {"cam_0.png,1\ncam_1.png,2\ncam_2.png,3\n", "no time for frame 'cam_3.png'"},
      {"cam_0.png,1\ncam_0.png,2\n", "two times"},
      {"1,2,3,4\n", "is no time"},
      {"1\nnan\n3\n4\n", "is no time"},
  };
  for (const auto& [text, words] : cases) {
    const auto done = set(text);
    ASSERT_FALSE(done) << text;
    EXPECT_THAT(done.error().text(), testing::HasSubstr(words)) << text;
    EXPECT_EQ(secs(), before) << text;
  }
  EXPECT_FALSE(readFrameTimes((m_folder / "none.csv").string()));
}

TEST_F(FrameTimesTest, AConstantRateCountsFromItsStart) {
  ASSERT_TRUE(setFrameRate(m_project, {}, 25, 10));
  EXPECT_THAT(secs(), testing::ElementsAre(10, 10.04, 10.08, 10.12));
  EXPECT_FALSE(setFrameRate(m_project, {}, 0, 0));
  EXPECT_FALSE(setFrameRate(m_project, VideoId{7}, 25, 0)) << "a video that is not there";
  EXPECT_EQ(firstFallingTime(m_project, {}), -1);
  m_project.frames[2].timeSecs = 0;
  EXPECT_EQ(firstFallingTime(m_project, {}), 2);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>

#include <QByteArray>
#include <QCryptographicHash>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/project_store.h"
#include "unit/io/test_folder.h"

namespace alidade {

TEST(SourceCheck, HashesASmallFileWholeAfterItsSize) {
  const TestFolder folder;
  const auto source = describeSource(folder.write("s.txt", "abc"));
  ASSERT_TRUE(source) << source.error().text();
  EXPECT_EQ(source->size, 3u);
  EXPECT_EQ(source->hash, QCryptographicHash::hash("3abc", QCryptographicHash::Sha256).toHex().toStdString());
}

TEST(SourceCheck, TellsMissingGrownAndAlteredFiles) {
  const TestFolder folder;
  Project project;
  project.scans.resize(3);
  const char* names[] = {"missing", "grown", "altered"};
  for (int i = 0; i < 3; ++i) {
    const auto source = describeSource(folder.write(names[i], "0123456789ab"));
    ASSERT_TRUE(source);
    project.scans[i].source = *source;
  }
  EXPECT_TRUE(checkSources(project).empty());
  std::filesystem::remove(folder / "missing");
  folder.write("grown", "0123456789abcdefg");
  folder.write("altered", "0123456789aX");
  const auto problems = checkSources(project);
  ASSERT_EQ(problems.size(), 3u);
  EXPECT_EQ(problems[0].what, "is missing");
  EXPECT_EQ(problems[1].what, "has changed since it was added (size 12 → 17 bytes)");
  EXPECT_THAT(problems[2].what, testing::HasSubstr("other content"));
}

TEST(SourceCheck, NoticesAChangeAtEitherEndOfALargeFile) {
  const TestFolder folder;
  std::string bytes(20 << 20, 'a');
  const auto before = describeSource(folder.write("big", bytes));
  for (const std::size_t at : {std::size_t(0), (std::size_t(1) << 20) - 1, bytes.size() - (1 << 20), bytes.size() - 1}) {
    std::string changed = bytes;
    changed[at] = 'b';
    EXPECT_NE(describeSource(folder.write("big", changed))->hash, before->hash) << at;
  }
}

TEST(SourceCheck, RefusesFoldersDevicesAndNothing) {
  const TestFolder folder;
  EXPECT_FALSE(describeSource(folder.path().string()));
  EXPECT_FALSE(describeSource("/dev/zero"));
  EXPECT_FALSE(describeSource(folder / "none"));
  EXPECT_FALSE(describeSource(""));
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/reader_registry.h"

#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/io/test_folder.h"

namespace alidade {

namespace {

class FakeReader : public PointListReader {
 public:
  FakeReader(std::string id, int score) : m_id(std::move(id)), m_score(score) {}
  ReaderDescription description() const override { return {m_id, m_id + " format", {"fake"}}; }
  int sniff(const FileProbe& probe) const override { return probe.startsWith("FAKE") ? m_score : 0; }
  Result<PointList> read(const std::string&) const override { return PointList(); }

 private:
  std::string m_id;
  int m_score;
};

class FakeWriter : public ScanWriter {
 public:
  explicit FakeWriter(std::string ending) : m_ending(std::move(ending)) {}
  ReaderDescription description() const override { return {m_ending, m_ending + " scan", {m_ending}}; }
  bool writes(const std::string& path) const override { return path.ends_with("." + m_ending); }
  bool isTree() const override { return false; }
  Result<std::unique_ptr<ScanSink>> create(const std::string& path, const ScanWriteOptions&) const override { return fail("Not now", path); }

 private:
  std::string m_ending;
};

}  // namespace

TEST(ReaderRegistry, FindsTheWriterThatAPathAsksForByItsName) {
  ReaderRegistry registry;
  EXPECT_THAT(registry.findWriter("a.one").error().what, testing::HasSubstr("No plugin that writes"));
  registry.add(std::make_unique<FakeWriter>("one"));
  registry.add(std::make_unique<FakeWriter>("two"));
  registry.add(std::make_unique<FakeWriter>("two"));
  EXPECT_EQ(registry.writers().size(), 2u);
  EXPECT_EQ((*registry.findWriter("a.two"))->description().id, "two");
  EXPECT_THAT(registry.findWriter("a.three").error().advice, testing::HasSubstr("one scan, two scan"));
}

TEST(ReaderRegistry, LoadsThePluginsBesideTheProgram) {
  const auto& readers = ReaderRegistry::instance().readers();
  for (const std::string id : {"colmap", "pictures", "video"})
    EXPECT_TRUE(std::any_of(readers.begin(), readers.end(), [&](const auto& r) { return r->description().id == id; })) << id;
  EXPECT_TRUE(ReaderRegistry::instance().loadErrors().empty());
}

TEST(ReaderRegistry, TheHighestClaimWins) {
  const TestFolder folder;
  const std::string path = folder.write("a.fake", "FAKE data");
  ReaderRegistry registry;
  registry.add(std::make_unique<FakeReader>("low", 20));
  registry.add(std::make_unique<FakeReader>("high", 60));
  registry.add(std::make_unique<FakeReader>("middle", 40));
  EXPECT_EQ((*registry.find(path))->description().id, "high");
  EXPECT_EQ((*registry.findAs<PointListReader>(path))->description().id, "high");
}

TEST(ReaderRegistry, SaysWhatTheFileIsInstead) {
  const TestFolder folder;
  const std::string path = folder.write("a.fake", "FAKE data");
  ReaderRegistry registry;
  registry.add(std::make_unique<FakeReader>("points", 60));
  const auto found = registry.findAs<ScanReader>(path);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().what, "This is a list of points (points format), not a scan");
}

TEST(ReaderRegistry, SaysWhatIsRead) {
  const TestFolder folder;
  ReaderRegistry registry;
  registry.add(std::make_unique<FakeReader>("points", 60));
  const auto found = registry.find(folder.write("b.doc", "something else"));
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().advice, testing::HasSubstr("points format (fake)"));
}

TEST(ReaderRegistry, NamesAKnownFormatThatIsNotRead) {
  const TestFolder folder;
  ReaderRegistry registry;
  registry.add(std::make_unique<FakeReader>("points", 60));
  const auto whatOf = [&](const std::string& name, const std::string& text) {
    const auto found = registry.findAs<ScanReader>(folder.write(name, text));
    return found ? std::string() : found.error().what + ". " + found.error().advice;
  };
  EXPECT_THAT(whatOf("renamed.dat", "AC1032 and more"), testing::HasSubstr("DWG"));
  EXPECT_THAT(whatOf("a.FLS", "2\n2\n0 0 0\n"), testing::HasSubstr("scanner maker's"));
  EXPECT_THAT(whatOf("b.doc", "something else"), testing::HasSubstr("No reader of a scan"));
  EXPECT_EQ((*registry.find(folder.write("mine.dwg", "FAKE data")))->description().id, "points");
}

TEST(ReaderRegistry, SaysThatNoPluginIsThere) {
  const TestFolder folder;
  const ReaderRegistry registry;
  const std::string path = folder.write("a.las", "LASF");
  EXPECT_THAT(registry.find(path).error().what, testing::HasSubstr("No reader plugin is installed"));
  EXPECT_THAT(registry.findAs<ScanReader>(path).error().advice, testing::HasSubstr("ALIDADE_PLUGIN_PATH"));
}

TEST(ReaderRegistry, RefusesMissingAndEmptyFilesAndDevices) {
  const TestFolder folder;
  const ReaderRegistry registry;
  EXPECT_EQ(registry.find(folder / "none").error().what, "The file does not exist");
  EXPECT_EQ(registry.find(folder.write("e.las", "")).error().what, "The file is empty");
  std::filesystem::create_directories(folder / "empty");
  EXPECT_EQ(registry.find(folder / "empty").error().what, "The folder is empty");
  EXPECT_FALSE(registry.find("/dev/zero"));
  EXPECT_FALSE(registry.find(""));
}

TEST(ReaderRegistry, ABrokenPluginIsALoadErrorAndTheOthersGoOn) {
  const TestFolder folder;
  folder.write("a_broken.so", "not an ELF file");
  folder.write("readme.txt", "no library");
  ReaderRegistry registry;
  registry.loadFolder(folder.path().string());
  ASSERT_EQ(registry.loadErrors().size(), 1u);
  EXPECT_THAT(registry.loadErrors().front().where, testing::HasSubstr("a_broken.so"));
  std::filesystem::copy_file(std::string(ALIDADE_BINARY_DIR) + "/lib/alidade/plugins/colmap.so", folder / "b_colmap.so");
  registry.loadFolder(folder.path().string());
  EXPECT_EQ(registry.readers().size(), 1u);
}

TEST(ReaderRegistry, AFolderThatIsNotThereIsNoError) {
  ReaderRegistry registry;
  registry.loadFolder("/nowhere/at/all");
  EXPECT_TRUE(registry.loadErrors().empty());
}

TEST(ReaderRegistry, KeepsOneReaderOfAName) {
  ReaderRegistry registry;
  registry.add(std::make_unique<FakeReader>("same", 10));
  registry.add(std::make_unique<FakeReader>("same", 20));
  EXPECT_EQ(registry.readers().size(), 1u);
}

}  // namespace alidade

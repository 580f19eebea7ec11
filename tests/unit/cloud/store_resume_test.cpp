// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <signal.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>

#include <gtest/gtest.h>

#include "unit/cloud/store_sources.h"

namespace alidade {
namespace {

using test::filesOf;
using test::hallScan;

constexpr std::uint64_t kPoints = 700'000;

IndexOptions spilling() {
  IndexOptions options;
  options.memoryBytes = 16 << 20;
  options.threads = 2;
  return options;
}

/// Runs `work` in a process of its own and kills it after so many milliseconds (negative: never).
template <class Work>
int inChild(const Work& work, int killAfterMs, rusage* usage = nullptr) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  if (killAfterMs >= 0) {
    ::usleep(static_cast<useconds_t>(killAfterMs) * 1000);
    ::kill(child, SIGKILL);
  }
  int status = 0;
  rusage used{};
  ::wait4(child, &status, 0, &used);
  if (usage != nullptr) *usage = used;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::uint64_t residentBytes() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// Indexes until the streams are on their way to a tree, then cancels.
Result<IndexReport> cancelledLate(const ScanSource& scan, const std::string& path, const IndexOptions& options) {
  Progress* listening = nullptr;
  Progress watched([&](double fraction, std::string_view) {
    if (fraction > 0.6) listening->cancel();
  });
  listening = &watched;
  return indexScans(std::span(&scan, 1), path, options, watched);
}

/// ALIDADE_KILL_ROUNDS asks for more than the few of an everyday run.
int killRounds() {
  const char* asked = std::getenv("ALIDADE_KILL_ROUNDS");
  return asked != nullptr ? std::atoi(asked) : 8;
}

TEST(StoreResume, KilledAtAnyMomentGoesOnToTheSameBytes) {
  const test::ScratchFolder scratch;
  const std::vector<ScanSource> scans{hallScan(60'000, 3), hallScan(kPoints, 4)};
  const auto start = std::chrono::steady_clock::now();
  const std::string whole = scratch / "whole.alidade-points";
  ASSERT_EQ(inChild([&] { return indexScans(scans, whole, spilling(), Progress()) ? 0 : 1; }, -1), 0);
  const auto took = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start).count();
  const auto expected = filesOf(whole);
  std::mt19937 random(17);
  int killed = 0;
  for (int round = 0; round < killRounds(); ++round) {
    const std::string path = scratch / "killed.alidade-points";
    std::filesystem::remove_all(path);
    // One kill, sometimes a second one in the run that goes on.
    for (int times = 0; times < 1 + round % 2; ++times) {
      const int outcome = inChild([&] { return indexScans(scans, path, spilling(), Progress()) ? 0 : 1; },
                                  static_cast<int>(random() % static_cast<unsigned>(took + 1)));
      ASSERT_NE(outcome, 1);
      killed += outcome == -1;
      if (outcome == 0) break;
      if (std::filesystem::exists(path)) {
        const auto half = openStore(path);
        if (half) {  // killed after all was done
          ASSERT_EQ(half->parts.size(), 2u);
          break;
        }
      }
    }
    if (!openStore(path)) {
      const auto report = indexScans(scans, path, spilling(), Progress());
      ASSERT_TRUE(report) << report.error().text();
    }
    auto files = filesOf(path);
    std::erase_if(files, [](const auto& file) { return file.first.ends_with(".tmp"); });  // between manifest and tidying
    ASSERT_EQ(files.size(), expected.size());
    for (const auto& [name, content] : expected) ASSERT_TRUE(files.at(name) == content) << name << " in round " << round;
  }
  EXPECT_GT(killed, 0);
}

TEST(StoreResume, GoesOnBehindWhatTheDiaryVouchesFor) {
  const test::ScratchFolder scratch;
  const std::string path = scratch / "one.alidade-points", whole = scratch / "whole.alidade-points";
  ScanSource scan = hallScan(kPoints);
  int reads = 0;
  const auto read = scan.read;
  scan.read = [&reads, read](const ScanSource::Sink& sink, const Progress& progress) { return ++reads, read(sink, progress); };
  ASSERT_TRUE(indexScans(std::span(&scan, 1), whole, spilling(), Progress()));
  ASSERT_EQ(reads, 1);
  ASSERT_FALSE(cancelledLate(scan, path, spilling()));
  ASSERT_EQ(reads, 2);
  ASSERT_TRUE(indexScans(std::span(&scan, 1), path, spilling(), Progress()));
  EXPECT_EQ(reads, 2) << "the scan was read again";
  EXPECT_TRUE(filesOf(path) == filesOf(whole));
}

TEST(StoreResume, OtherOptionsOrScansStartAnew) {
  const test::ScratchFolder scratch;
  const std::string path = scratch / "one.alidade-points", whole = scratch / "whole.alidade-points";
  const ScanSource first = hallScan(kPoints, 1), second = hallScan(kPoints, 2);
  ASSERT_FALSE(cancelledLate(first, path, spilling()));
  IndexOptions random = spilling();
  random.levels = LevelKind::Random;
  ASSERT_FALSE(cancelledLate(first, path, random));
  ASSERT_TRUE(indexScans(std::span(&second, 1), path, random, Progress()));
  ASSERT_TRUE(indexScans(std::span(&second, 1), whole, random, Progress()));
  EXPECT_TRUE(filesOf(path) == filesOf(whole));
}

TEST(StoreResume, ADamagedTemporaryFileOrDiaryStartsAnew) {
  const test::ScratchFolder scratch;
  const std::string path = scratch / "one.alidade-points", whole = scratch / "whole.alidade-points";
  const ScanSource scan = hallScan(kPoints);
  ASSERT_TRUE(indexScans(std::span(&scan, 1), whole, spilling(), Progress()));
  for (const std::string name : {"spill.tmp", "diary.tmp"}) {
    std::filesystem::remove_all(path);
    ASSERT_FALSE(cancelledLate(scan, path, spilling()));
    const std::string file = path + "/part-0001.partial/" + name;
    ASSERT_TRUE(std::filesystem::exists(file));
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    const auto report = indexScans(std::span(&scan, 1), path, spilling(), Progress());
    ASSERT_TRUE(report) << report.error().text();
    EXPECT_TRUE(filesOf(path) == filesOf(whole)) << name;
  }
}

TEST(StoreResume, AFullDiskIsSaidAndGoneOnWith) {
  const test::ScratchFolder scratch;
  const std::string path = scratch / "one.alidade-points", whole = scratch / "whole.alidade-points";
  const ScanSource scan = hallScan(kPoints);
  ASSERT_TRUE(indexScans(std::span(&scan, 1), whole, spilling(), Progress()));
  for (const rlim_t megabytes : {1, 10, 30}) {
    // No file may grow beyond: as a disk without room, at another moment each.
    const int outcome = inChild(
        [&] {
          const rlimit limit{megabytes << 20, megabytes << 20};
          ::signal(SIGXFSZ, SIG_IGN);
          if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) return 2;
          const auto report = indexScans(std::span(&scan, 1), path, spilling(), Progress());
          if (report) return 3;
          return report.error().what.starts_with("There is no room to write the point store") && !report.error().advice.empty() ? 0 : 4;
        },
        -1);
    EXPECT_EQ(outcome, megabytes == 30 ? 3 : 0) << megabytes << " MB";
  }
  EXPECT_TRUE(filesOf(path) == filesOf(whole));
}

TEST(StoreResume, StaysInsideTheMemoryItIsGiven) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer's own memory would be measured";
#endif
  const test::ScratchFolder scratch;
  const ScanSource scan = hallScan(3'000'000);
  IndexOptions options;
  options.memoryBytes = 96 << 20;
  options.threads = 2;
  // Beside the points at work: program and stacks, batches between reader and workers, the sample.
  constexpr std::uint64_t kBase = 32 << 20;
  rusage used{};
  ::malloc_trim(0);  // what earlier tests freed would be room that the child does not ask for
  const std::uint64_t before = residentBytes();
  ASSERT_EQ(inChild([&] { return indexScans(std::span(&scan, 1), scratch / "one.alidade-points", options, Progress()) ? 0 : 1; }, -1, &used), 0);
  const std::uint64_t peak = static_cast<std::uint64_t>(used.ru_maxrss) * 1024;
  RecordProperty("peak_mb", std::to_string(peak >> 20));
  EXPECT_LT(peak, before + options.memoryBytes + kBase) << "before " << (before >> 20) << " MB, peak " << (peak >> 20) << " MB";
  // A cell group of a sixteenth of the points, as read, in Morton order and as written: less were not this work's peak.
  constexpr std::uint64_t kRecord = 32;
  EXPECT_GT(peak, 3 * kRecord * scan.info.pointCount / 16);
}

}  // namespace
}  // namespace alidade

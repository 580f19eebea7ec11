// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "plugin_api/child_process.h"

namespace alidade {
namespace {

using Clock = std::chrono::steady_clock;

Result<std::vector<std::byte>> run(std::vector<std::string> arguments, const Progress& progress = {},
                                   const std::function<void(ChildOptions&)>& change = {}) {
  ChildOptions options;
  options.helper = "alidade-test-child";
  options.arguments = std::move(arguments);
  options.inputName = "hall.ifc";
  if (change) change(options);
  auto result = runChild(options, progress);
  // Whatever happened, no child of this process is left, neither running nor as a zombie.
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
  return result;
}

std::string text(const Result<std::vector<std::byte>>& result) {
  return result ? std::string(reinterpret_cast<const char*>(result->data()), result->size()) : result.error().text();
}

TEST(ChildProcess, HandsOverALongResultWhole) {
  const auto result = run({"answer"});
  ASSERT_TRUE(result) << result.error().text();
  ASSERT_EQ(result->size(), std::size_t{5} << 20);
  for (std::size_t i = 0; i < result->size(); ++i) ASSERT_EQ((*result)[i], static_cast<std::byte>(i * 7)) << i;
}

TEST(ChildProcess, PassesProgressOn) {
  std::string seen;
  const Progress progress([&](double, std::string_view what) {
    seen += std::string(what) + ";";
    std::this_thread::sleep_for(std::chrono::milliseconds(40));
  });
  ASSERT_TRUE(run({"answer"}, progress));
  EXPECT_NE(seen.find("Reading"), std::string::npos);
  EXPECT_NE(seen.find("Half way there"), std::string::npos) << seen;
}

TEST(ChildProcess, PassesTheHelpersOwnErrorOn) {
  const auto result = run({"refuse"});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().what, "It is broken");
  EXPECT_EQ(result.error().where, "line 7");
  EXPECT_EQ(result.error().advice, "Mend it");
}

TEST(ChildProcess, ACrashBecomesAnErrorThatNamesTheFile) {
  const std::string words = text(run({"crash"}));
  EXPECT_NE(words.find("crashed"), std::string::npos) << words;
  EXPECT_NE(words.find("hall.ifc"), std::string::npos) << words;
  EXPECT_NE(text(run({"quit"})).find("without a result"), std::string::npos);
  EXPECT_NE(text(run({"garbage"})).find("makes no sense"), std::string::npos);
}

TEST(ChildProcess, AnAnswerCountsEvenWhereTheHelperCrashesWhileCleaningUp) {
  EXPECT_EQ(text(run({"answer-then-crash"})), "ok");
}

TEST(ChildProcess, WhatTheHelperPrintsDoesNotMixIntoTheAnswer) {
  const auto result = run({"noise"});
  ASSERT_TRUE(result) << result.error().text();
  EXPECT_TRUE(result->empty());
}

TEST(ChildProcess, StopsAHelperThatHangs) {
  const auto start = Clock::now();
  const std::string words = text(run({"hang"}, {}, [](ChildOptions& o) { o.wallSecs = 0.3; }));
  EXPECT_NE(words.find("did not finish"), std::string::npos) << words;
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(10));
}

TEST(ChildProcess, StopsAHelperThatUsesUpItsProcessorTime) {
  const std::string words = text(run({"spin"}, {}, [](ChildOptions& o) { o.cpuSecs = 1; }));
  EXPECT_NE(words.find("processor time"), std::string::npos) << words;
}

TEST(ChildProcess, StopsAHelperThatEatsMemory) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer needs the whole address space";
#endif
  const std::string words = text(run({"eat"}, {}, [](ChildOptions& o) { o.memoryBytes = std::uint64_t{256} << 20; }));
  EXPECT_NE(words.find("more than 256 MiB of memory"), std::string::npos) << words;
}

TEST(ChildProcess, StopsAResultThatIsTooLong) {
  const std::string words = text(run({"flood"}, {}, [](ChildOptions& o) { o.resultBytes = 1 << 20; }));
  EXPECT_NE(words.find("larger than 1 MiB"), std::string::npos) << words;
}

TEST(ChildProcess, EndsSoonAfterCancel) {
  const Progress progress;
  std::thread canceller([progress] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    progress.cancel();
  });
  const auto start = Clock::now();
  const auto result = run({"hang"}, progress);
  canceller.join();
  ASSERT_FALSE(result);
  EXPECT_TRUE(isCancelled(result.error()));
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(10));
}

TEST(ChildProcess, TheHelperGetsNoneOfTheParentsFiles) {
  std::ifstream kept(ALIDADE_SOURCE_DIR "/CMakeLists.txt");
  ASSERT_TRUE(kept.is_open());
  EXPECT_EQ(text(run({"descriptors"})), "4");  // three standard ones and the pipe
}

TEST(ChildProcess, TheHelperWritesNoFiles) {
  const auto path = std::filesystem::temp_directory_path() / ("alidade-child-" + std::to_string(::getpid()));
  const auto result = run({"write-file", path.string()});
  EXPECT_NE(text(result), "wrote");
  std::filesystem::remove(path);
}

TEST(ChildProcess, AMissingHelperIsNamed) {
  const std::string words = text(run({}, {}, [](ChildOptions& o) { o.helper = "alidade-no-such-helper"; }));
  EXPECT_NE(words.find("alidade-no-such-helper is missing"), std::string::npos) << words;
}

TEST(ChildProcess, RunsFromManyThreadsAtOnce) {
  std::vector<std::thread> threads;
  std::array<std::size_t, 8> size{};
  for (std::size_t& each : size)
    threads.emplace_back([&each] {
      ChildOptions options;
      options.helper = "alidade-test-child";
      options.arguments = {"answer"};
      const auto result = runChild(options, Progress());
      each = result ? result->size() : 0;
    });
  for (auto& t : threads) t.join();
  for (const std::size_t each : size) EXPECT_EQ(each, std::size_t{5} << 20);
}

}  // namespace
}  // namespace alidade

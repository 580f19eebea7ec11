// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <dirent.h>
#include <unistd.h>

#include "plugin_api/child_process.h"

using alidade::ChildReporter;

namespace {

volatile unsigned sink = 0;

int openDescriptors() {
  int count = 0;
  DIR* folder = ::opendir("/proc/self/fd");
  while (folder && ::readdir(folder)) ++count;
  ::closedir(folder);
  return count - 3;  // ".", ".." and the folder's own
}

}  // namespace

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  // A sanitizer would take the signal and make a plain exit of the crash.
  ::signal(SIGSEGV, SIG_DFL);
  ChildReporter reporter;
  if (mode == "answer") {
    reporter.progress(0.5, "Half way there");
    std::vector<std::byte> result(std::size_t{5} << 20);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = static_cast<std::byte>(i * 7);
    return reporter.done(result);
  }
  if (mode == "refuse") return reporter.fail({"It is broken", "line 7", "Mend it"});
  if (mode == "crash") ::raise(SIGSEGV);
  if (mode == "quit") return 3;
  if (mode == "noise") std::puts("text on standard output"), std::fputs("text on standard error\n", stderr);
  if (mode == "noise") return reporter.done({});
  if (mode == "garbage") return ::write(ChildReporter::kDescriptor, "this is no message at all", 25) == 25 ? 0 : 1;
  if (mode == "hang") ::sleep(60);
  if (mode == "spin")
    for (;;) sink = sink + 1;
  if (mode == "eat") {
    std::vector<std::vector<char>> all;
    for (;;) all.emplace_back(std::size_t{16} << 20, 'x');
  }
  if (mode == "flood") {
    const std::vector<std::byte> much(std::size_t{64} << 20);
    return reporter.done(much);
  }
  if (mode == "answer-then-crash") {
    reporter.done(std::as_bytes(std::span("ok", 2)));
    ::raise(SIGSEGV);
  }
  if (mode == "descriptors") {
    const std::string text = std::to_string(openDescriptors());
    return reporter.done(std::as_bytes(std::span(text)));
  }
  if (mode == "write-file") {
    std::FILE* file = std::fopen(argv[2], "w");
    const bool wrote = file && std::fputs("x", file) >= 0 && std::fflush(file) == 0;
    const std::string text = wrote ? "wrote" : "could not";
    return reporter.done(std::as_bytes(std::span(text)));
  }
  return 2;
}

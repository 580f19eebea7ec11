// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "command_line.h"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

namespace alidade::test {

namespace fs = std::filesystem;

namespace {

struct Scratch {
  fs::path path = fs::temp_directory_path() / ("alidade_cli_tests_" + std::to_string(getpid()));
  Scratch() { fs::create_directories(path); }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

std::string contentOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

std::string quoted(const fs::path& path) {
  return fmt::format("\"{}\"", path.string());
}

const fs::path& scratch() {
  static const Scratch instance;
  return instance.path;
}

namespace {

/// `input` comes first, so that a redirection among the arguments wins.
Outcome ran(const std::string& before, const std::string& arguments, const std::string& input) {
  const fs::path in = scratch() / "stdin", out = scratch() / "stdout", err = scratch() / "stderr";
  std::ofstream(in, std::ios::binary) << input;
  const std::string command = fmt::format("{}{} < {} {} > {} 2> {}", before, quoted(ALIDADE_BINARY_DIR "/bin/alidade-cli"),
                                          quoted(in), arguments, quoted(out), quoted(err));
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), contentOf(out), contentOf(err)};
}

}  // namespace

Outcome alidadeCli(const std::string& arguments, const std::string& input) {
  return ran("", arguments, input);
}

Outcome limited(const std::string& arguments, int blocks) {
  return ran(fmt::format("ulimit -f {}; ", blocks), arguments, {});
}

const fs::path& smallDemo() {
  static const fs::path folder = [] {
    const fs::path made = scratch() / "demo";
    const auto outcome =
        alidadeCli(fmt::format("demo {} --points 60000 --frames 4 --seed 3 --width 480 --height 360", quoted(made)));
    if (outcome.exitCode != 0) throw std::runtime_error("demo failed: " + outcome.errors);
    return made;
  }();
  return folder;
}

fs::path sharedData(const std::string& name) {
  const fs::path path = fs::path(ALIDADE_SHARED_DATA_DIR) / name;
  return fs::exists(path) ? fs::weakly_canonical(path) : fs::path();
}

}  // namespace alidade::test

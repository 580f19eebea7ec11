// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

namespace alidade::test {

struct Outcome {
  int exitCode = -1;
  std::string output;  ///< standard output
  std::string errors;  ///< standard error
  nlohmann::json json() const { return nlohmann::json::parse(output, nullptr, false); }
};

/// Runs `alidade-cli ARGUMENTS` in a shell, with `input` on standard input.
Outcome alidadeCli(const std::string& arguments, const std::string& input = {});

/// The same where no file may grow beyond `blocks` of 512 bytes or 1 KiB, as the shell counts them.
Outcome limited(const std::string& arguments, int blocks);

/// The path between double quotes, for a shell.
std::string quoted(const std::filesystem::path& path);

/// A folder of this test process's own, removed at its end.
const std::filesystem::path& scratch();

/// The sample inspection, made once a process: 60 k points, 4 frames of 480 × 360.
const std::filesystem::path& smallDemo();

/// Data that is not part of the project; empty where it is not there.
std::filesystem::path sharedData(const std::string& name);

}  // namespace alidade::test

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/progress.h"

namespace alidade::cli {

/// What a verb answers: a JSON object for `--json`, and the same in words for people.
struct Answer {
  nlohmann::ordered_json json;
  std::string text;
  bool failed = false;  ///< the job ran, but what was asked for did not come out (exit code 1)
};

/// A verb: declared on the application, run after parsing. Progress draws a bar on a terminal only;
/// Ctrl+C cancels it.
using Verb = std::function<Result<Answer>(const Progress&)>;

/// Registers one verb: `run` is called where it was given on the command line.
class Verbs {
 public:
  explicit Verbs(CLI::App& app) : m_app(app) {}
  CLI::App* add(const std::string& name, const std::string& description, Verb run);

  /// Runs the parsed verb and prints its answer. Exit code 0 done, 1 failed.
  int run() const;

  /// The words on the command line are wrong: says so, as JSON too where `json` asks for it.
  /// Exit code 2.
  int refuse(const CLI::ParseError& error, bool json) const;

 private:
  struct Entry {
    CLI::App* command;
    Verb run;
    std::shared_ptr<bool> json;
  };
  CLI::App& m_app;
  std::vector<Entry> m_entries;
};

/// For CLI11's check(): the parser's refusal as bad usage, before anything is loaded.
template <class Parse>
CLI::Validator checkedBy(Parse parse, const std::string& name) {
  return CLI::Validator(
      [parse](std::string& text) {
        const auto parsed = parse(text);
        return parsed ? std::string() : parsed.error().what + ". " + parsed.error().advice;
      },
      name);
}

/// For CLI11's check() of every option that is a number with a point: CLI11's own checks let nan pass.
CLI::Validator finiteNumber();
CLI::Validator positiveNumber();
CLI::Validator numberWithin(double low, double high);

void addAdd(Verbs& verbs);
void addCalibrate(Verbs& verbs);
void addClean(Verbs& verbs);
void addClock(Verbs& verbs);
void addConvert(Verbs& verbs);
void addDemo(Verbs& verbs);
void addIndex(Verbs& verbs);
void addInfo(Verbs& verbs);
void addLevels(Verbs& verbs);
void addNew(Verbs& verbs);
void addOverlay(Verbs& verbs);
void addPick(Verbs& verbs);
void addRefine(Verbs& verbs);
void addProjectPoints(Verbs& verbs);
void addExportCameras(Verbs& verbs);
void addMesh(Verbs& verbs);
void addMount(Verbs& verbs);
void addRegister(Verbs& verbs);

}  // namespace alidade::cli

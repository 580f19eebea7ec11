// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/project_input.h"

#include <algorithm>

#include "base/log.h"
#include "io/project_store.h"

namespace alidade::cli {

namespace {

constexpr std::size_t kProblemsTold = 5;

/// A project that was moved without its data has as many problems as pictures: the first say it all.
void tellProblems(const std::vector<SourceProblem>& problems) {
  for (std::size_t i = 0; i < std::min(problems.size(), kProblemsTold); ++i)
    logWarning(problems[i].path + " " + problems[i].what);
  if (problems.size() > kProblemsTold)
    logWarning(std::to_string(problems.size() - kProblemsTold) + " more sources of the project are missing or changed");
}

/// The reader knows that a file is not there, the project why that may be.
Error explained(Error error, const std::vector<SourceProblem>& problems) {
  const bool missing = std::any_of(problems.begin(), problems.end(), [&](const SourceProblem& problem) {
    return problem.path == error.where && problem.what == "is missing";
  });
  if (missing) error.advice = "Move the data along with the project, or make the project anew with alidade-cli new";
  return error;
}

}  // namespace

Result<OpenProject> openProject(const std::string& path, const std::string& frame, bool withData,
                                const Progress& progress, const std::function<Result<void>(const Project&)>& check) {
  auto project = loadProject(path);
  if (!project) return fail(project.error());
  OpenProject open;
  open.project = std::move(*project);
  auto id = open.project.frameByNameOrIndex(frame);
  if (!id) return fail(id.error());
  open.frame = *id;
  if (check)
    if (auto fit = check(open.project); !fit) return fail(fit.error());
  const std::vector<SourceProblem> problems = checkSources(open.project);
  tellProblems(problems);
  if (!withData) return open;
  auto loaded = loadData(open.project, progress);
  if (!loaded) return fail(loaded.error());
  if (!loaded->problems.empty()) return fail(explained(loaded->problems.front(), problems));
  for (const ImportWarning& warning : loaded->warnings) logInfo(warning.what + " (" + warning.where + ")");
  open.data = std::move(loaded->data);
  return open;
}

const char* stateName(Visibility state) {
  switch (state) {
    case Visibility::Visible: return "visible";
    case Visibility::Hidden: return "hidden";
    case Visibility::Unknown: return "unknown";
    case Visibility::Outside: return "outside";
  }
  return "";
}

}  // namespace alidade::cli

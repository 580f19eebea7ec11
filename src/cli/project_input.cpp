// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/project_input.h"

#include "base/log.h"
#include "io/project_store.h"

namespace alidade::cli {

Result<OpenProject> openProject(const std::string& path, const std::string& frame, bool withData,
                                const Progress& progress) {
  auto project = loadProject(path);
  if (!project) return fail(project.error());
  OpenProject open;
  open.project = std::move(*project);
  auto id = open.project.frameByNameOrIndex(frame);
  if (!id) return fail(id.error());
  open.frame = *id;
  for (const SourceProblem& problem : checkSources(open.project)) logWarning(problem.path + " " + problem.what);
  if (!withData) return open;
  auto loaded = loadData(open.project, progress);
  if (!loaded) return fail(loaded.error());
  if (!loaded->problems.empty()) return fail(loaded->problems.front());
  for (const ImportWarning& warning : loaded->warnings) logInfo(warning.what + " (" + warning.where + ")");
  open.data = std::move(loaded->data);
  return open;
}

}  // namespace alidade::cli

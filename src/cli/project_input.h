// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <string>

#include "app/workspace.h"
#include "base/error.h"
#include "base/progress.h"
#include "raster/occlusion.h"
#include "survey/project.h"

namespace alidade::cli {

/// Opens a project and, where wanted, its scans and designs. A source that cannot be read stops a
/// command: an unattended picture must not silently lack its design. `check` may refuse the project
/// before anything is loaded.
struct OpenProject {
  Project project;
  LoadedData data;
  FrameId frame;
};
Result<OpenProject> openProject(const std::string& path, const std::string& frame, bool withData, const Progress& progress,
                                const std::function<Result<void>(const Project&)>& check = {});

/// "visible", "hidden", "unknown", "outside".
const char* stateName(Visibility state);

}  // namespace alidade::cli

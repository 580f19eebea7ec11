// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "base/error.h"
#include "survey/project.h"

namespace alidade {

/// A project is one SQLite database, `*.alidade`. Schema in resources/schemas/project.sql; its
/// version is the database's user_version. Source paths are stored relative to the file.
///
/// Saving writes a new file beside the old one and renames it over: a full disk or a crash leaves
/// the old project whole.
Result<void> saveProject(const Project& project, const std::string& path);

/// Reads all of it or fails. Sources that are missing or changed are no failure of the project:
/// see checkSources.
Result<Project> loadProject(const std::string& path);

struct SourceProblem {
  std::string path;
  std::string what;    ///< "is missing", "has changed since it was added (size 12 → 17 bytes)"
};

/// Compares every source file with the size and hash that the project remembers.
std::vector<SourceProblem> checkSources(const Project& project);

/// Size and hash of a file. The hash is SHA-256 over the size, the first and the last MiB, and 64
/// blocks of 64 KiB spread evenly between: a changed scan is noticed without reading gigabytes.
Result<SourceFile> describeSource(const std::string& path);

}  // namespace alidade

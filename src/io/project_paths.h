// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <string>

#include "survey/project.h"

namespace alidade {

/// Calls `visit` for every source file of the project: scans, designs, videos, pictures.
void forEachSource(Project& project, const std::function<void(SourceFile&)>& visit);
void forEachSource(const Project& project, const std::function<void(const SourceFile&)>& visit);

/// The source as seen from the project file: "scans/hall.las", "../common/road.ifc". An empty path
/// stays empty. Below the project's folder links are left alone, so that folder may move; outside it
/// both paths are resolved first, because ".." means nothing across a link.
std::string pathRelativeToProject(const std::string& source, const std::string& projectFile);

/// The way back; an absolute path stays as it is.
std::string pathFromProject(const std::string& stored, const std::string& projectFile);

}  // namespace alidade

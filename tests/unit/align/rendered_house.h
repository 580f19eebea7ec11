// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "base/error.h"
#include "survey/project.h"

namespace alidade::test {

/// A project of a design alone and pictures of it as it would stand, from all sides: walls plastered, roof tiled, on a lawn,
/// with things around it that no design has. Drawn by the simulator; the poses are the true ones. The design stands
/// wherever its file says.
Result<Project> renderedHouse(const std::string& designFile, const std::string& folder, int views, int width, int height);

}  // namespace alidade::test

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <string>

#include "app/workspace.h"

namespace alidade {

/// Hides the elements of all other storeys, and shows this one's. False where the design has none of it; then nothing changes.
bool showOnlyStorey(Design& design, const DesignModel& model, const std::string& storey);

/// Hides the scans, designs and elements of that name, or the element of that global id. How many there were.
std::size_t hideByName(Project& project, const LoadedData& data, const std::string& name);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "adjust/normal_system.h"

namespace alidade {

/// The summary of a network left as it came.
NetworkSummary startSummary(const NetworkTerms& terms, const NetworkState& start);

/// The summary at a solution. `normals`: factored without damping; null where no covariance is wanted.
NetworkSummary describe(const NetworkTerms& terms, const NetworkState& state, const std::vector<char>& active,
                        const NormalSystem* normals, const NetworkOptions& options);

/// What a residual is called: the point's or the edge's name, or a number.
std::string residualName(const NetworkTerms& terms, int term);

}  // namespace alidade

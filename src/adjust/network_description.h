// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "adjust/normal_system.h"

namespace alidade {

/// The summary of a network left as it came.
NetworkSummary startSummary(const NetworkTerms& terms, const NetworkState& start);

/// The summary at a solution: residuals, sigma0, check points.
NetworkSummary describe(const NetworkTerms& terms, const NetworkState& state, const std::vector<char>& active,
                        const NetworkOptions& options);

/// How well it is known, into the same summary. `normals`: factored without damping.
void describeAccuracy(const NetworkTerms& terms, const NetworkState& state, const NormalSystem& normals,
                      const NetworkOptions& options, NetworkSummary& summary);

/// What a residual is called: the point's or the edge's name, or a number.
std::string residualName(const NetworkTerms& terms, int term);

}  // namespace alidade

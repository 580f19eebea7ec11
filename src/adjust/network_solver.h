// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "adjust/normal_system.h"
#include "base/progress.h"

namespace alidade {

/// Where a run of Levenberg-Marquardt ended.
struct NetworkFit {
  NetworkState state;
  double initialCost = 0, cost = 0;  ///< half the (robust) sum of squares
  int iterations = 0;
  bool converged = false;
  bool cancelled = false;
};

/// Minimises over the terms that `normals` uses. Damping after Nielsen (1999); converged where the linear model
/// promises less than 1e-9 of the cost with no damping to speak of.
NetworkFit fitNetwork(const NetworkTerms& terms, NormalSystem& normals, const std::vector<char>& active,
                      NetworkState start, double huberSigmas, int maximumIterations, const Progress& progress);

/// Half the robust sum of squares; infinite where an active term has no value.
double networkCost(const NetworkTerms& terms, const NetworkState& state, const std::vector<char>& active,
                   double huberSigmas);

/// |residual| in sigmas of each term, held-out ones too; infinite where there is none.
std::vector<double> termSigmas(const NetworkTerms& terms, const NetworkState& state);

}  // namespace alidade

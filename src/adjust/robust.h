// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>

#include "base/error.h"

namespace alidade {

// What every adjustment here shares about outliers and when to stop.

/// Among n right observations in the plane the worst one lies beyond this in one set of a hundred thousand: sqrt(2 ln(n 10⁵)), as
/// P(|r| > k sigma) = exp(-k²/2). Below it, dropping one costs more than it saves.
double chanceLimit(std::size_t n);

/// A region of 95 % in the plane is larger by this where sigma naught, which scales it, had to be estimated with so much
/// redundancy r: sqrt(F(2, r) / F(2, ∞)), in closed form F(2, r) = r/2 (0.05^(-2/r) - 1).
double widening95(double redundancy);

/// "Converged", or what else is to be said of residuals far above the given sigmas.
std::string reasonOfConvergence(bool farAboveSigmas, double sigma0);

/// The options of that name in ResectionOptions and NetworkOptions.
Result<void> checkRobustOptions(double huberSigmas, double outlierSigmas, int maximumIterations);

}  // namespace alidade

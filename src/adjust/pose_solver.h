// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include "adjust/pose_problem.h"

namespace alidade {

struct PoseSolution {
  PoseState state;
  bool converged = false;
  int iterations = 0;
};

/// Minimises the weighted squares of the chosen observations (Levenberg-Marquardt, analytic derivatives).
/// `huberSigmas` > 0 puts a Huber loss on each observation's length. Converged where the next step is
/// shorter than a ten-thousandth of a standard deviation.
PoseSolution solvePose(const PoseProblem& problem, const PoseState& start, const std::vector<int>& chosen,
                       double huberSigmas, int maximumIterations);

/// Observations that agree with one pose.
struct Consensus {
  PoseState state;
  std::vector<int> inliers;
  double scale = 1;  ///< the given sigmas had to be multiplied by this before a majority agreed
  int iterations = 0;
};

/// Finds the pose that most observations agree with, however far off the others are: a Huber solution
/// from the start, and where that leaves outliers, poses from small random subsets (fixed seed)
/// scored by truncated squares (MSAC, Torr and Zisserman 2000); fifty observations or more of which nine tenths agree
/// need no subsets. Where fewer than three sevenths agree within
/// `outlierSigmas`, or a larger scale is likelier, the scale is that of the least median of squares (Rousseeuw 1984), at
/// most 20.
Consensus findConsensus(const PoseProblem& problem, const std::vector<int>& usable, const ResectionOptions& options);

}  // namespace alidade

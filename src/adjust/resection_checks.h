// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adjust/pose_problem.h"

namespace alidade {

/// Why a set of observations cannot fix the pose, as a sentence that also says what to do; nothing
/// where it can. All of these look at geometry and numbers, none moves the pose.

/// Numbers that are no numbers, nothing free, a start that is no pose.
std::optional<std::string> refusalOfInput(const PoseProblem& problem, const RigidTransform& start);

/// Too few, duplicates, one spot, one line. `chosen` is what is about to be, or was, used.
std::optional<std::string> refusalOfGeometry(const PoseProblem& problem, const std::vector<int>& chosen);

/// Observations in front of the camera; or the reason why too few of them are.
std::optional<std::string> refusalOfSide(const PoseProblem& problem, const std::vector<int>& usable);

/// A free parameter that the observations leave open, from the singular values at `state`, or from the
/// standard deviations: a position beyond a twentieth of the distance of the points, or beyond a metre, is none.
std::optional<std::string> refusalOfWeakness(const PoseProblem& problem, const PoseState& state,
                                             const std::vector<int>& chosen, double sigmaScale);
/// The largest standard deviation of a position that still is one, with what it sees so far away.
double weakestPositionM(double distanceM);

/// A known point seen at a pixel.
struct KnownPick {
  int frame = 0;
  glm::dvec2 pixel{0};
  glm::dvec3 world{0};
  std::string_view name;
};
/// The same pixel and point under several names counts as often: a sentence, or nothing.
std::optional<std::string> warningOfTwins(std::vector<KnownPick> picks);

/// Points of one plane allow two poses (Schweighofer and Pinz 2006): looks for the second, and where it
/// fits as well, says so. Where it fits clearly better, `state` becomes the better one.
std::optional<std::string> refusalOfTwoPoses(const PoseProblem& problem, PoseState& state,
                                             const std::vector<int>& chosen, double sigmaScale);

}  // namespace alidade

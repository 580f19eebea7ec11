// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adjust/network_solver.h"

namespace alidade {

/// Indices, numbers, sizes and names that make no sense, as one error each with what to do.
Result<void> checkNetwork(const Network& network);

/// Values to start from: given poses, poses found from known points where none is given, given or intersected tie
/// points. `warnings` names tie points that no rays fix; those are NaN. Error where a frame's pose cannot be had.
Result<NetworkState> startState(const Network& network, const NetworkLayout& layout, std::vector<std::string>& warnings);

/// Where the rays of the observations (indices) of one point meet best, relative to the origin; nothing where they are
/// fewer than two, nearly parallel, or meet behind a camera.
std::optional<glm::dvec3> intersectRays(const Network& network, const std::vector<Camera>& cameras,
                                        const NetworkState& state, const std::vector<int>& observations);
/// The cameras of a state, for intersectRays.
std::vector<Camera> camerasOf(const NetworkState& state);

/// A sentence where a frame's observations cannot fix what is free of it whatever their numbers: all on one line, in
/// one spot, on edges of fewer than three directions.
std::optional<std::string> refusalOfFrames(const NetworkTerms& terms, const NetworkState& state,
                                           const std::vector<char>& active);

/// A sentence where what is adjusted is left open: singular equations, or standard deviations beyond a twentieth of the
/// distance to what was seen or beyond a metre. After NormalSystem::factorUndamped().
std::optional<std::string> refusalOfWeakness(const NetworkTerms& terms, const NetworkState& state,
                                             const std::vector<char>& active, const NormalSystem& normals);

/// What an unknown is called in sentences: "the centre's E of pose P".
std::string unknownName(const Network& network, const NetworkLayout& layout, int block, int column);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <numbers>

namespace alidade {

/// Angles are radians inside; degrees or gon (400 a turn) on screen.
constexpr double radiansFromDegrees(double degrees) { return degrees * std::numbers::pi / 180.0; }
constexpr double degreesFromRadians(double radians) { return radians * 180.0 / std::numbers::pi; }
constexpr double radiansFromGon(double gon) { return gon * std::numbers::pi / 200.0; }
constexpr double gonFromRadians(double radians) { return radians * 200.0 / std::numbers::pi; }

}  // namespace alidade

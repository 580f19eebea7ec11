// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <functional>
#include <optional>

namespace alidade {

/// How quick the frames of a moving view are wanted; a matter of the machine, not of the project.
struct FramePace {
  double frameTimeMs = 40;    ///< fewer points are used to keep it; 0: all, however long it takes
  std::uint64_t mostPoints = 0;  ///< in any case no more; 0: no such limit
  double selectionAgeMs = 0;  ///< the points chosen for one frame serve others for so long (Zhang 2020); 0: each chooses its own
  friend bool operator==(const FramePace&, const FramePace&) = default;
};

/// Holds the frames of a moving view to a wanted time by the number of points they use; the still picture uses all. The
/// time of a frame is taken as what it costs, whatever it is spent on: too slow a frame lowers the budget in proportion, at most
/// to the half, a quick one raises it by at most a quarter, and between 80 and 100 % of the wanted time it stays. The budget found is
/// where the next movement begins. One thread.
class FramePacer {
 public:
  using Clock = std::function<double()>;  ///< milliseconds
  FramePacer();
  explicit FramePacer(Clock clock);

  /// Before a frame: how many points it may use; 0: all. Without a pace the picture is still and may take its time.
  std::uint64_t begin(const std::optional<FramePace>& pace);
  /// After it: how many it used.
  void end(std::uint64_t points);

  /// A picture of fewer tells nothing of the scan.
  static constexpr std::uint64_t kFewest = 50'000;

 private:
  Clock m_clock;
  double m_start = 0, m_wanted = 0;
  std::uint64_t m_budget = 0;               ///< 0: none needed yet
  double m_lastMs = 0;
  std::uint64_t m_lastPoints = 0;  ///< of the last frame without a budget
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace alidade {

/// How large a played video is drawn: in full where that keeps up, else at half the width and height, which costs about a
/// third, until the full size would keep up again. A frame that takes long now and then changes nothing.
class PlayQuality {
 public:
  /// A frame took so long, where one comes every `stepMs`.
  void drawn(double ms, double stepMs);
  int shrink() const { return m_shrink; }  ///< 1 or 2

 private:
  static constexpr int kFewSlow = 4, kManyQuick = 30;
  static constexpr double kQuick = 0.25;  ///< of the step: at full size it then takes three quarters

  int m_shrink = 1, m_slow = 0, m_quick = 0;
};

}  // namespace alidade

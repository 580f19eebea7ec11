// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/play_quality.h"

#include <algorithm>

namespace alidade {

void PlayQuality::drawn(double ms, double stepMs) {
  // A slow one weighs as much as a quick one, so that only more slow ones than quick ones add up.
  m_slow = ms > stepMs ? m_slow + 1 : std::max(0, m_slow - 1);
  m_quick = ms < kQuick * stepMs ? m_quick + 1 : 0;
  if (m_shrink == 1 && m_slow >= kFewSlow) m_shrink = 2, m_slow = m_quick = 0;
  else if (m_shrink == 2 && m_quick >= kManyQuick) m_shrink = 1, m_slow = m_quick = 0;
}

}  // namespace alidade

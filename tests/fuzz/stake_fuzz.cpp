// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "stake/stake_point_reader.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto list = alidade::parseStakePoints(text, "fuzz.csv");
  if (!list) {
    if (list.error().what.empty()) std::abort();
    return 0;
  }
  for (const auto& point : list->points) {
    for (int a = 0; a < 3; ++a)
      if (!(std::abs(point.position[a]) <= 1e9)) std::abort();
    if (!std::isfinite(point.toleranceM) || point.toleranceM < 0 || point.name.empty()) std::abort();
  }
  if (list->points.size() > size || list->warnings.size() > 2 * size + 8) std::abort();
  return 0;
}

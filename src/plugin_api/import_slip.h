// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "plugin_api/reader.h"

namespace alidade {

/// Counts a slip of one kind, keeps its first place, and becomes one warning: "12 times come twice".
struct ImportSlip {
  std::size_t count = 0;
  std::string place;

  void note(const std::string& where) {
    if (count++ == 0) place = where;
  }
  /// `what` goes on after the count; nothing is told where nothing was noted.
  void tell(std::vector<ImportWarning>& warnings, const std::string& what) const {
    if (count > 0) warnings.push_back({std::to_string(count).append(" ").append(what), place});
  }
};

}  // namespace alidade

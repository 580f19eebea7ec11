// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trajectory/pose_rows.h"

namespace alidade {

Result<void> forPoseRows(LineReader& lines, const std::string& path, const Progress& progress,
                         const std::function<Result<void>(std::string_view line, const std::string& place)>& take) {
  for (std::string_view line; lines.next(line);) {
    const std::string_view words = trimmed(line);
    if (words.empty() || words.starts_with('#')) continue;
    if (lines.number() % 1024 == 0) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(lines.fraction(), "Reading poses");
    }
    if (auto taken = take(line, placeInFile(path, lines.number())); !taken) return fail(taken.error());
  }
  return {};
}

}  // namespace alidade

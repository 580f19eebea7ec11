// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <vector>

#include "base/error.h"
#include "base/input_file.h"

namespace alidade {

/// When each frame of an MP4 or QuickTime file's first video track is shown: seconds from the first one, in order.
/// From the sample tables alone (ISO/IEC 14496-12: stts 8.6.1.2, ctts 8.6.1.3, elst 8.6.6); nothing is decoded.
///
/// Nothing where the tables do not tell: another container, fragments (moof), an edit list that repeats or cuts.
/// Error where they lie: an offset past the end, counts that contradict each other.
Result<std::optional<std::vector<double>>> mp4FrameTimes(const InputFile& file);

}  // namespace alidade

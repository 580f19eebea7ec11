// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/progress.h"
#include "plugin_api/text_file.h"

namespace alidade {

/// Hands over each line from here on that is neither empty nor a remark (#), with its place in the file for messages. Ends with the first error, and when cancelled.
Result<void> forPoseRows(LineReader& lines, const std::string& path, const Progress& progress,
                         const std::function<Result<void>(std::string_view line, const std::string& place)>& take);

}  // namespace alidade

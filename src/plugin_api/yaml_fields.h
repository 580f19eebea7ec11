// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace alidade {

using TextFields = std::map<std::string, std::string, std::less<>>;

/// The text of every value of a small YAML file by its key, as OpenCV's FileStorage and the EuRoC data sets write them:
/// "key: value" a line, those that stand indented below `top` as "top.key"; a list may go on over several lines. Without
/// remarks, type tags ("!!opencv-matrix") and quotes. Nothing here calls itself.
TextFields yamlFields(std::string_view text);

/// Without type tag and quotes.
std::string_view yamlValue(std::string_view text);

}  // namespace alidade

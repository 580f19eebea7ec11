// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plugin_api/reader.h"

#include <string_view>

namespace alidade {

namespace {

std::string_view textOf(const FileProbe& probe) {
  return {reinterpret_cast<const char*>(probe.head.data()), probe.head.size()};
}

}  // namespace

bool FileProbe::startsWith(std::string_view text) const {
  return textOf(*this).starts_with(text);
}

bool FileProbe::holds(std::string_view text) const {
  return textOf(*this).find(text) != std::string_view::npos;
}

}  // namespace alidade

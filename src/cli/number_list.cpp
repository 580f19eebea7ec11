// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/number_list.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace alidade::cli {

Result<std::vector<double>> numberList(const std::string& text, std::size_t least, std::size_t most, const char* option, const char* advice) {
  std::vector<double> values;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    double value = 0;
    const auto read = std::from_chars(at, end, value);
    if (read.ec != std::errc() || !std::isfinite(value)) return fail("'" + text + "' is no list of numbers", option, advice);
    values.push_back(value);
    at = read.ptr;
    if (at == end) break;
    if (*at++ != ',') return fail("'" + text + "' is no list of numbers", option, advice);
  }
  if (values.size() < least || values.size() > most)
    return fail(std::to_string(values.size()) + " numbers are given", option, advice);
  return values;
}

std::vector<std::string> wordList(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t start = 0; start <= text.size();) {
    const auto comma = std::min(text.find(',', start), text.size());
    words.push_back(text.substr(start, comma - start));
    start = comma + 1;
  }
  return words;
}

}  // namespace alidade::cli

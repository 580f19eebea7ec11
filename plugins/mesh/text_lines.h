// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

namespace alidade {

/// The lines of a text, without their ends.
class Lines {
 public:
  explicit Lines(std::string_view text) : m_text(text) {}

  std::size_t number = 0;  ///< of `line`, from 1
  std::string_view line;

  bool next() {
    if (m_at >= m_text.size()) return false;
    auto end = m_text.find('\n', m_at);
    if (end == m_text.npos) end = m_text.size();
    line = m_text.substr(m_at, end - m_at);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    m_at = end + 1;
    ++number;
    return true;
  }

 private:
  std::string_view m_text;
  std::size_t m_at = 0;
};

/// The next word of `line`, which is shortened by it; empty at its end.
inline std::string_view takeWord(std::string_view& line) {
  const auto start = line.find_first_not_of(" \t");
  if (start == line.npos) {
    line = {};
    return {};
  }
  auto end = line.find_first_of(" \t", start);
  if (end == line.npos) end = line.size();
  const std::string_view word = line.substr(start, end - start);
  line.remove_prefix(end);
  return word;
}

/// A finite number that is all of the word.
inline std::optional<double> toNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

inline std::optional<long long> toInteger(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  long long value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace alidade

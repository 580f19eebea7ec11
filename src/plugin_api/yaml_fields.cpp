// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plugin_api/yaml_fields.h"

#include <algorithm>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

bool isKeyText(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  }) && !(text[0] >= '0' && text[0] <= '9') && text[0] != '-';
}

}  // namespace

std::string_view yamlValue(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with("!!")) text = trimmed(text.substr(std::min(text.find(' '), text.size())));
  if (text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.back() == text.front())
    text = text.substr(1, text.size() - 2);
  return text;
}

TextFields yamlFields(std::string_view text) {
  TextFields fields;
  std::string top;
  std::string* value = nullptr;
  LineReader lines(text);
  for (std::string_view line; lines.next(line);) {
    if (line.starts_with('%') || line.starts_with("---") || line.starts_with("...")) continue;
    if (const std::size_t remark = line.find('#'); remark != std::string_view::npos) line = line.substr(0, remark);
    const std::string_view words = trimmed(line);
    if (words.empty()) continue;
    const std::size_t colon = words.find(':');
    if (const std::string_view key = trimmed(words.substr(0, colon)); colon != std::string_view::npos && isKeyText(key)) {
      const bool isTop = line.front() != ' ' && line.front() != '\t';
      if (isTop) top = key;
      value = &fields[isTop ? top : top + "." + std::string(key)];
      *value = std::string(yamlValue(words.substr(colon + 1)));
    } else if (value) {  // a list goes on
      value->append(" ").append(words);
    }
  }
  return fields;
}

}  // namespace alidade

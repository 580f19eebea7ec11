// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "opencv-calib/calibration_fields.h"

#include <algorithm>
#include <vector>

#include <nlohmann/json.hpp>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

const std::string kAdvice = "Save the calibration again with OpenCV's FileStorage";
constexpr int kMaxDepth = 32;

Result<TextFields> xmlFields(std::string_view text, const std::string& path) {
  const auto broken = [&](const char* what) { return fail(std::string("The XML is damaged: ") + what, path, kAdvice); };
  TextFields fields;
  std::vector<std::string> open;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t tag = std::min(text.find('<', at), text.size());
    const std::string_view words = trimmed(text.substr(at, tag - at));
    if (!words.empty() && open.size() >= 2) {
      const bool below = open.size() > 2 && open[2] != "_";
      fields[below ? open[1] + "." + open[2] : open[1]].append(words).append(" ");
    }
    if (tag == text.size()) break;
    const std::string_view rest = text.substr(tag);
    const bool remark = rest.starts_with("<!--");
    const std::size_t end = remark ? text.find("-->", tag) : text.find('>', tag);
    if (end == std::string_view::npos) return broken("an element does not end");
    at = end + (remark ? 3 : 1);
    const std::string_view inside = text.substr(tag + 1, end - tag - 1);
    if (remark || inside.starts_with('?') || inside.starts_with('!') || inside.ends_with('/')) continue;
    if (inside.starts_with('/')) {
      if (open.empty() || open.back() != trimmed(inside.substr(1))) return broken("an element is closed that was not opened");
      open.pop_back();
      continue;
    }
    open.emplace_back(inside.substr(0, inside.find_first_of(" \t\r\n")));
    if (open.size() > std::size_t(kMaxDepth)) return broken("it is nested too deep");
  }
  if (!open.empty()) return broken("it ends before its elements do");
  for (auto& [key, value] : fields) value = std::string(yamlValue(value));
  return fields;
}

Result<TextFields> jsonFields(const std::string& text, const std::string& path) {
  int depth = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kMaxDepth) return fail("The JSON is nested too deep", path, kAdvice);
  }
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return fail("The JSON is damaged", path, kAdvice);
  const auto words = [](const nlohmann::json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  };
  TextFields fields;
  for (const auto& [key, value] : json.items()) {
    if (!value.is_object()) {
      fields[key] = words(value);
      continue;
    }
    for (const auto& [below, inner] : value.items()) fields[std::string(key).append(".").append(below)] = words(inner);
  }
  return fields;
}

}  // namespace

Result<TextFields> parseCalibrationFields(const std::string& text, const std::string& path) {
  const std::string_view start = trimmed(text);
  if (start.starts_with('<')) return xmlFields(text, path);
  if (start.starts_with('{')) return jsonFields(text, path);
  return yamlFields(text);
}

}  // namespace alidade

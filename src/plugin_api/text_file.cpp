// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plugin_api/text_file.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>

#include <sys/stat.h>

namespace alidade {

namespace {

constexpr std::string_view kSpace = " \t\r\n\v\f";

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

Result<std::string> readTextFile(const std::string& path, std::uint64_t maxBytes) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0)
    return fail(std::string("The file cannot be read: ") + std::strerror(errno), path, "Check the path");
  if (S_ISDIR(status.st_mode)) return fail("This is a folder, not a file", path, "Choose a file in it");
  // Pipes and devices have no size and may never end.
  if (!S_ISREG(status.st_mode)) return fail("This is no ordinary file", path, "Save the data to a file first");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size > maxBytes)
    return fail("The text file is too large: " + std::to_string(size) + " bytes, at most " +
                    std::to_string(maxBytes) + " are read", path, "Split the file");

  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen(path.c_str(), "rb"));
  if (!file)
    return fail(std::string("The file cannot be opened: ") + std::strerror(errno), path, "Check its permissions");
  std::string text(size, '\0');
  const std::size_t read = std::fread(text.data(), 1, text.size(), file.get());
  if (std::ferror(file.get()))
    return fail(std::string("The file cannot be read: ") + std::strerror(errno), path, "Check the disk");
  text.resize(read);
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  return text;
}

std::string placeInFile(const std::string& path, std::size_t line) {
  return path + ", line " + std::to_string(line);
}

bool LineReader::next(std::string_view& line) {
  if (m_rest.empty()) return false;
  ++m_number;
  const std::size_t end = m_rest.find_first_of("\r\n");
  if (end == std::string_view::npos) {
    line = m_rest;
    m_rest = {};
    return true;
  }
  line = m_rest.substr(0, end);
  const bool both = m_rest[end] == '\r' && end + 1 < m_rest.size() && m_rest[end + 1] == '\n';
  m_rest.remove_prefix(end + (both ? 2 : 1));
  return true;
}

bool FieldReader::next(std::string_view& field) {
  const std::size_t begin = m_rest.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) {
    m_rest = {};
    return false;
  }
  const std::size_t end = std::min(m_rest.find_first_of(kSpace, begin), m_rest.size());
  field = m_rest.substr(begin, end - begin);
  m_rest.remove_prefix(end);
  return true;
}

std::optional<double> FieldReader::number() {
  std::string_view field;
  return next(field) ? parseNumber(field) : std::nullopt;
}

std::optional<std::int64_t> FieldReader::integer() {
  std::string_view field;
  return next(field) ? parseInteger(field) : std::nullopt;
}

std::string_view FieldReader::rest() const { return trimmed(m_rest); }

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::optional<double> parseNumber(std::string_view text) {
  if (text.starts_with('+') && text.size() > 1 && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || end != text.data() + text.size()) return std::nullopt;
  // Out of range: from_chars leaves the value alone; strtod rounds to 0 or infinity.
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(text).c_str(), nullptr);
  if (error != std::errc()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parseInteger(std::string_view text) {
  if (text.starts_with('+') && text.size() > 1 && text[1] != '-') text.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::vector<double>> parseNumbers(std::string_view text, std::size_t limit) {
  std::vector<double> numbers;
  FieldReader fields(text);
  for (std::string_view field; fields.next(field);) {
    const auto number = parseNumber(field);
    if (!number || numbers.size() == limit) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::size_t jsonDepth(std::string_view text) {
  std::size_t depth = 0, deepest = 0;
  bool inString = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inString) {
      if (c == '\\') ++i;
      else if (c == '"') inString = false;
    } else if (c == '"') {
      inString = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return deepest;
}

std::string quotedWords(std::string_view text, std::size_t limit) {
  std::string words = "'";
  for (const char c : text.substr(0, limit)) words += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  return words + (text.size() > limit ? "…'" : "'");
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace alidade {

// What every reader of a text format needs: the file in memory, its lines with their numbers, and
// numbers that do not depend on the locale.

/// The whole file. Error where it is missing, a folder, unreadable, or larger than `maxBytes`. A
/// UTF-8 byte order mark is dropped.
Result<std::string> readTextFile(const std::string& path, std::uint64_t maxBytes = std::uint64_t(2) << 30);

/// "cameras.txt, line 12", for Error::where.
std::string placeInFile(const std::string& path, std::size_t line);

/// Walks over lines ended by \n, \r\n or \r, counting from 1. Views into the text, which must outlive it.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : m_rest(text), m_size(text.size()) {}

  /// The next line without its ending; false at the end of the text.
  bool next(std::string_view& line);

  std::size_t number() const { return m_number; }
  /// Share of the text already walked over, 0..1.
  double fraction() const { return m_size == 0 ? 1.0 : 1.0 - double(m_rest.size()) / double(m_size); }

 private:
  std::string_view m_rest;
  std::size_t m_size;
  std::size_t m_number = 0;
};

/// Walks over the fields of a line that white space separates.
class FieldReader {
 public:
  explicit FieldReader(std::string_view line) : m_rest(line) {}

  bool next(std::string_view& field);
  /// A field that is a number (nan and inf are numbers: ask std::isfinite); nothing where it is none or missing.
  std::optional<double> number();
  std::optional<std::int64_t> integer();
  /// What is left, without white space around it; a picture's name may hold spaces.
  std::string_view rest() const;

 private:
  std::string_view m_rest;
};

std::string_view trimmed(std::string_view text);
std::string lowerCase(std::string_view text);

/// The whole of `text` as a number, point as decimal sign, a leading + allowed; nothing where
/// anything else stands there. A number beyond double's range is infinite or 0.
std::optional<double> parseNumber(std::string_view text);
std::optional<std::int64_t> parseInteger(std::string_view text);

/// Numbers between white space and nothing else; nothing where there is another word, or more than `limit` of them.
std::optional<std::vector<double>> parseNumbers(std::string_view text, std::size_t limit);

/// Brackets ([ and {) open at the same time in a JSON text, those within strings left out: asked before a
/// parser that calls itself.
std::size_t jsonDepth(std::string_view text);

/// At most `limit` characters of a file's own words for an error message, made printable.
std::string quotedWords(std::string_view text, std::size_t limit = 40);

}  // namespace alidade

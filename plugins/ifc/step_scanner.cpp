// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ifc/step_scanner.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include <fmt/format.h>

namespace alidade {

namespace {

/// Walks through the exchange structure's text one token at a time. Tokens are views into the text.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : m_text(text) {}

  enum class Kind { End, Word, String, Sign, Broken };
  Kind kind = Kind::End;
  std::string_view token;

  Kind next() {
    skipBlanks();
    if (kind == Kind::Broken) return kind;
    if (m_at >= m_text.size()) return kind = Kind::End;
    const std::size_t start = m_at;
    const char c = m_text[m_at];
    if (c == '\'') {
      kind = skipString() ? Kind::String : Kind::Broken;
    } else if (isWord(c)) {
      while (m_at < m_text.size() && isWord(m_text[m_at])) ++m_at;
      kind = Kind::Word;
    } else {
      ++m_at;
      kind = Kind::Sign;
    }
    token = m_text.substr(start, m_at - start);
    return kind;
  }

  /// Past the next ';' that is in no string and no comment. False at the end of the text.
  bool skipStatement() {
    while (next() != Kind::End && kind != Kind::Broken)
      if (kind == Kind::Sign && token == ";") return true;
    return false;
  }

 private:
  static bool isWord(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '#' || c == '.' || c == '+';
  }

  void skipBlanks() {
    while (m_at < m_text.size()) {
      if (std::isspace(static_cast<unsigned char>(m_text[m_at]))) {
        ++m_at;
      } else if (m_text.substr(m_at, 2) == "/*") {
        const auto end = m_text.find("*/", m_at + 2);
        if (end == m_text.npos) {
          kind = Kind::Broken;
          return;
        }
        m_at = end + 2;
      } else {
        return;
      }
    }
  }

  bool skipString() {
    for (++m_at; m_at < m_text.size(); ++m_at) {
      if (m_text[m_at] != '\'') continue;
      if (m_at + 1 < m_text.size() && m_text[m_at + 1] == '\'') {
        ++m_at;
      } else {
        ++m_at;
        return true;
      }
    }
    return false;
  }

  std::string_view m_text;
  std::size_t m_at = 0;
};

std::string upper(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return result;
}

/// The strings of a statement such as FILE_SCHEMA(('IFC4')), up to its ';'.
std::vector<std::string> stringsOf(Tokens& tokens) {
  std::vector<std::string> found;
  while (tokens.next() != Tokens::Kind::End && tokens.kind != Tokens::Kind::Broken) {
    if (tokens.kind == Tokens::Kind::String) found.emplace_back(tokens.token.substr(1, tokens.token.size() - 2));
    if (tokens.kind == Tokens::Kind::Sign && tokens.token == ";") break;
  }
  return found;
}

void scanHeader(Tokens& tokens, StepSummary& summary) {
  while (tokens.next() != Tokens::Kind::End && tokens.kind != Tokens::Kind::Broken) {
    if (tokens.kind != Tokens::Kind::Word) continue;
    const std::string word = upper(tokens.token);
    if (word == "FILE_SCHEMA") {
      const auto strings = stringsOf(tokens);
      if (!strings.empty()) summary.schema = upper(strings.front());
    } else if (word == "FILE_NAME") {
      // name, time stamp, authors, organizations, preprocessor, originating system, authorization
      const auto strings = stringsOf(tokens);
      if (strings.size() >= 3) summary.program = strings[strings.size() - 2];
    } else if (word == "ENDSEC") {
      return;
    }
  }
}

constexpr std::string_view kAdvice =
    "Export it again from the design program as IFC4 Reference View or as IFC2x3 Coordination View";

}  // namespace

Result<StepSummary> scanStep(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  Tokens tokens(text);
  if (tokens.next() != Tokens::Kind::Word || upper(tokens.token) != "ISO-10303-21")
    return fail("The file is no STEP file: it does not begin with ISO-10303-21", {}, "Choose an IFC file in STEP form");
  StepSummary summary;
  scanHeader(tokens, summary);
  if (summary.schema.empty())
    return fail("The file names no schema in its header", {}, std::string(kAdvice));

  bool ended = false;
  while (tokens.next() != Tokens::Kind::End && tokens.kind != Tokens::Kind::Broken) {
    if (tokens.kind != Tokens::Kind::Word) continue;
    if (tokens.token.front() == '#') {
      tokens.next();  // =
      if (tokens.next() != Tokens::Kind::Word) continue;
      const std::string entity = upper(tokens.token);
      ++summary.count[entity];
      if (entity == "IFCPROJECTEDCRS" && summary.crsName.empty()) {
        const auto strings = stringsOf(tokens);
        if (!strings.empty()) summary.crsName = strings.front();
      } else if (!tokens.skipStatement()) {
        break;
      }
    } else if (upper(tokens.token) == "END-ISO-10303-21") {
      ended = true;
      break;
    }
  }
  if (!ended)
    return fail("The file is cut off: END-ISO-10303-21 is missing at its end", {}, "Copy or export it again");
  return summary;
}

Result<void> checkSchema(const std::string& schema) {
  if (schema == "IFC2X3" || schema == "IFC4" || schema == "IFC2X3_FINAL" || schema == "IFC2X3_TC1" ||
      schema == "IFC4_ADD1" || schema == "IFC4_ADD2" || schema == "IFC4_ADD2_TC1")
    return {};
  if (schema.starts_with("IFC"))
    return fail(fmt::format("The file's schema {} is not read; IFC2X3 and IFC4 are", schema), {}, std::string(kAdvice));
  return fail(fmt::format("The file is a STEP file of schema {}, not IFC", schema), {}, std::string(kAdvice));
}

bool isDrawnProduct(std::string_view entity) {
  // Subtypes of IfcElement and the spatial elements that may have a body, IFC2x3 and IFC4.
  static constexpr std::array kBeginnings = {
      "IFCWALL",      "IFCSLAB",       "IFCROOF",      "IFCCOLUMN",     "IFCBEAM",       "IFCMEMBER",
      "IFCPLATE",     "IFCWINDOW",     "IFCDOOR",      "IFCSTAIR",      "IFCRAMP",       "IFCRAILING",
      "IFCFURNI",     "IFCCOVERING",   "IFCFOOTING",   "IFCPILE",       "IFCCURTAINWALL", "IFCPIPE",
      "IFCFLOW",      "IFCDUCT",       "IFCDISTRIBUTION", "IFCREINFORC", "IFCTENDON",    "IFCBUILDINGELEMENT",
      "IFCCHIMNEY",   "IFCSHADINGDEVICE", "IFCTRANSPORTELEMENT", "IFCCIVILELEMENT", "IFCGEOGRAPHICELEMENT",
      "IFCELEMENTASSEMBLY", "IFCDISCRETEACCESSORY", "IFCFASTENER", "IFCMECHANICALFASTENER", "IFCPROXY",
      "IFCSITE",      "IFCSANITARYTERMINAL", "IFCLIGHTFIXTURE", "IFCAIRTERMINAL", "IFCVALVE", "IFCTANK",
      "IFCPUMP",      "IFCCABLE",      "IFCOUTLET",    "IFCSYSTEMFURNITURE", "IFCEQUIPMENTELEMENT",
  };
  static constexpr std::array kEndings = {"TYPE", "STYLE", "PROPERTIES", "STANDARD", "RELATIONSHIP"};
  const auto begins = [&](const char* b) { return entity.starts_with(b); };
  const auto ends = [&](const char* e) { return entity.ends_with(e); };
  return std::any_of(kBeginnings.begin(), kBeginnings.end(), begins) &&
         std::none_of(kEndings.begin(), kEndings.end(), ends);
}

}  // namespace alidade

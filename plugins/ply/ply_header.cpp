// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ply/ply_header.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace alidade {

namespace {

// A header beyond these is no header; they bound what a hostile one makes us keep.
constexpr std::size_t kMostLines = 10000;
constexpr std::size_t kMostComments = 50;
constexpr const char* kDamaged = "The file is damaged or no PLY: export it again";

std::vector<std::string> wordsOf(std::string_view line) {
  std::vector<std::string> words;
  std::size_t at = 0;
  while ((at = line.find_first_not_of(" \t", at)) != std::string_view::npos && words.size() < 8) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.emplace_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

std::optional<NumberType> numberTypeOf(const std::string& word) {
  static const std::pair<const char*, NumberType> kTypes[] = {
      {"char", NumberType::I8},   {"int8", NumberType::I8},     {"uchar", NumberType::U8},  {"uint8", NumberType::U8},
      {"short", NumberType::I16}, {"int16", NumberType::I16},   {"ushort", NumberType::U16}, {"uint16", NumberType::U16},
      {"int", NumberType::I32},   {"int32", NumberType::I32},   {"uint", NumberType::U32},  {"uint32", NumberType::U32},
      {"float", NumberType::F32}, {"float32", NumberType::F32}, {"double", NumberType::F64}, {"float64", NumberType::F64},
  };
  for (const auto& [name, type] : kTypes)
    if (word == name) return type;
  return std::nullopt;
}

bool takeFormat(const std::vector<std::string>& words, PlyHeader& header) {
  if (words.size() < 2) return false;
  if (words[1] == "ascii") header.coding = PlyCoding::Ascii;
  else if (words[1] == "binary_little_endian") header.coding = PlyCoding::LittleEndian;
  else if (words[1] == "binary_big_endian") header.coding = PlyCoding::BigEndian;
  else return false;
  return true;
}

bool takeElement(const std::vector<std::string>& words, PlyHeader& header) {
  if (words.size() < 3) return false;
  PlyElement element;
  element.name = words[1];
  const char* end = words[2].data() + words[2].size();
  const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
  if (error != std::errc() || stop != end) return false;
  header.elements.push_back(std::move(element));
  return true;
}

bool takeProperty(const std::vector<std::string>& words, PlyHeader& header) {
  if (header.elements.empty() || words.size() < 3) return false;
  PlyProperty property;
  const bool list = words[1] == "list";
  if (list && words.size() < 5) return false;
  const auto type = numberTypeOf(words[list ? 3 : 1]);
  if (!type) return false;
  property.type = *type;
  if (list) {
    property.listCountType = numberTypeOf(words[2]);
    if (!property.listCountType || *property.listCountType == NumberType::F32 ||
        *property.listCountType == NumberType::F64)
      return false;
  }
  property.name = words[list ? 4 : 2];
  header.elements.back().properties.push_back(std::move(property));
  return true;
}

}  // namespace

bool PlyElement::hasLists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.listCountType; });
}

std::size_t PlyElement::fixedSize() const {
  std::size_t size = 0;
  for (const PlyProperty& property : properties) size += numberSize(property.listCountType.value_or(property.type));
  return size;
}

const PlyElement* PlyHeader::element(const std::string& name) const {
  const auto found = std::find_if(elements.begin(), elements.end(), [&](const PlyElement& e) { return e.name == name; });
  return found == elements.end() ? nullptr : &*found;
}

Result<PlyHeader> readPlyHeader(ByteStream& stream, const std::string& path) {
  PlyHeader header;
  bool hasFormat = false;
  for (std::size_t number = 1; number <= kMostLines; ++number) {
    const auto line = stream.line();
    if (!line) return fail(line.error());
    if (!*line) return fail("The PLY header has no end", fmt::format("{}, line {}", path, number), kDamaged);
    const auto words = wordsOf(**line);
    if (number == 1) {
      if (words.empty() || words[0] != "ply")
        return fail("This is no PLY file: it does not start with \"ply\"", path, "Check the file's type");
      continue;
    }
    if (words.empty()) continue;
    bool good = true;
    if (words[0] == "end_header") {
      if (!hasFormat) return fail("The PLY header does not say its format", path, kDamaged);
      return header;
    } else if (words[0] == "format") {
      good = hasFormat = takeFormat(words, header);
    } else if (words[0] == "element") {
      good = takeElement(words, header);
    } else if (words[0] == "property") {
      good = takeProperty(words, header);
    } else if (words[0] == "comment" || words[0] == "obj_info") {
      if (header.comments.size() < kMostComments) {
        const std::size_t start = line->value().find(words[0]) + words[0].size() + 1;
        if (start < line->value().size()) header.comments.emplace_back(line->value().substr(start, 200));
      }
    } else {
      good = false;
    }
    if (!good)
      return fail("The PLY header has a line that is not understood: " + std::string(line->value().substr(0, 80)),
                  fmt::format("{}, line {}", path, number), kDamaged);
  }
  return fail("The PLY header does not end", path, kDamaged);
}

}  // namespace alidade

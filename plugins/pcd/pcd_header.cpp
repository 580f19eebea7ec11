// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pcd/pcd_header.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>

#include <fmt/format.h>

namespace alidade {

namespace {

constexpr int kMostLines = 1000;
constexpr std::size_t kMostFields = 1000;
constexpr std::uint64_t kMostNumbers = 100000;  // of one point
constexpr const char* kDamaged = "The file is damaged or no PCD: export it again";

struct RawHeader {
  std::vector<std::string> fields, sizes, types, counts;
  std::optional<std::uint64_t> width, height, points;
};

bool parseCount(const std::string& word, std::uint64_t& value) {
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  return error == std::errc() && stop == end;
}

std::optional<NumberType> numberTypeOf(const std::string& type, const std::string& size) {
  static const std::pair<const char*, NumberType> kTypes[] = {
      {"I1", NumberType::I8},  {"I2", NumberType::I16}, {"I4", NumberType::I32}, {"I8", NumberType::I64},
      {"U1", NumberType::U8},  {"U2", NumberType::U16}, {"U4", NumberType::U32}, {"U8", NumberType::U64},
      {"F4", NumberType::F32}, {"F8", NumberType::F64}};
  for (const auto& [name, number] : kTypes)
    if (type + size == name) return number;
  return std::nullopt;
}

/// Joins FIELDS, SIZE, TYPE and COUNT; an empty text or what is wrong.
std::string joinFields(const RawHeader& raw, PcdHeader& header) {
  if (raw.fields.empty()) return "it has no FIELDS";
  if (raw.sizes.size() != raw.fields.size() || raw.types.size() != raw.fields.size() ||
      (!raw.counts.empty() && raw.counts.size() != raw.fields.size()))
    return fmt::format("it has {} FIELDS, {} SIZE, {} TYPE and {} COUNT", raw.fields.size(), raw.sizes.size(),
                       raw.types.size(), raw.counts.size());
  std::uint64_t offset = 0, numbers = 0;
  for (std::size_t i = 0; i < raw.fields.size(); ++i) {
    PcdField field;
    field.name = raw.fields[i];
    const auto type = numberTypeOf(raw.types[i], raw.sizes[i]);
    if (!type) return fmt::format("field {} has the unknown type {}{}", field.name, raw.types[i], raw.sizes[i]);
    field.type = *type;
    if (!raw.counts.empty() && !parseCount(raw.counts[i], field.count)) return "COUNT is not a number";
    if (field.count > kMostNumbers || (numbers += field.count) > kMostNumbers)
      return fmt::format("a point would have more than {} numbers", kMostNumbers);
    field.offset = offset;
    offset += field.size();
    header.fields.push_back(std::move(field));
  }
  return offset == 0 ? "its points have no size" : "";
}

std::string settleCounts(const RawHeader& raw, PcdHeader& header) {
  if (!raw.points && !raw.width) return "it has neither POINTS nor WIDTH";
  header.width = raw.width.value_or(raw.points.value_or(0));
  header.height = raw.height.value_or(1);
  constexpr std::uint64_t kLargestSide = 1ull << 31;
  if (header.width > kLargestSide || header.height > kLargestSide) return "WIDTH or HEIGHT is beyond reason";
  const std::uint64_t grid = header.width * header.height;
  header.points = raw.points.value_or(grid);
  if (header.points != grid) {
    header.slip = fmt::format("WIDTH times HEIGHT is {}, POINTS is {}; the latter is used", grid, header.points);
    header.width = header.points;
    header.height = 1;
  }
  return {};
}

/// False where the line is none of a header's.
bool takeLine(std::string_view line, RawHeader& raw, PcdHeader& header, bool& atData) {
  std::string_view rest = line;
  const std::string_view key = nextPcdWord(rest);
  std::vector<std::string> words;
  for (auto word = nextPcdWord(rest); !word.empty() && words.size() <= kMostFields; word = nextPcdWord(rest))
    words.emplace_back(word);
  const auto number = [&](std::optional<std::uint64_t>& to) {
    std::uint64_t value = 0;
    if (words.empty() || !parseCount(words[0], value)) return false;
    to = value;
    return true;
  };
  if (key == "VERSION") return !words.empty() && (header.version = words[0].substr(0, 10), true);
  if (key == "FIELDS" || key == "COLUMNS") return raw.fields = words, words.size() <= kMostFields;
  if (key == "SIZE") return raw.sizes = words, true;
  if (key == "TYPE") return raw.types = words, true;
  if (key == "COUNT") return raw.counts = words, true;
  if (key == "WIDTH") return number(raw.width);
  if (key == "HEIGHT") return number(raw.height);
  if (key == "POINTS") return number(raw.points);
  if (key == "VIEWPOINT") {
    for (std::size_t i = 0; i < std::min(words.size(), header.viewpoint.size()); ++i)
      std::from_chars(words[i].data(), words[i].data() + words[i].size(), header.viewpoint[i]);
    return words.size() >= header.viewpoint.size();
  }
  if (key != "DATA" || words.empty()) return false;
  atData = true;
  if (words[0] == "ascii") header.coding = PcdCoding::Ascii;
  else if (words[0] == "binary") header.coding = PcdCoding::Binary;
  else if (words[0] == "binary_compressed") header.coding = PcdCoding::Compressed;
  else return false;
  return true;
}

}  // namespace

std::string_view nextPcdWord(std::string_view& line) {
  constexpr const char* kSeparators = " \t,";
  const std::size_t start = std::min(line.find_first_not_of(kSeparators), line.size());
  const std::size_t end = std::min(line.find_first_of(kSeparators, start), line.size());
  const std::string_view word = line.substr(start, end - start);
  line.remove_prefix(end);
  return word;
}

bool PcdField::isPackedColour() const {
  return count == 1 && numberSize(type) == 4 && (name == "rgb" || name == "rgba" || name == "RGB" || name == "RGBA");
}

std::uint64_t PcdHeader::recordSize() const {
  return fields.empty() ? 0 : fields.back().offset + fields.back().size();
}

Result<PcdHeader> readPcdHeader(ByteStream& stream, const std::string& path) {
  PcdHeader header;
  RawHeader raw;
  bool atData = false;
  for (int number = 1; number <= kMostLines && !atData; ++number) {
    const auto line = stream.line();
    if (!line) return fail(line.error());
    if (!*line) return fail("The PCD header has no line DATA", fmt::format("{}, line {}", path, number), kDamaged);
    const std::string_view text = **line;
    const std::size_t start = text.find_first_not_of(" \t");
    if (start == std::string_view::npos || text[start] == '#') continue;
    if (!takeLine(text, raw, header, atData)) {
      const bool bare = raw.fields.empty() && (std::isdigit(static_cast<unsigned char>(text[start])) || text[start] == '-');
      if (bare)
        return fail("This PCD file has no header: it starts with numbers", fmt::format("{}, line {}", path, number),
                    "Export it again with its header, or rename it to .xyz and read it as text");
      return fail("The PCD header has a line that is not understood: " + std::string(text.substr(0, 80)),
                  fmt::format("{}, line {}", path, number), kDamaged);
    }
  }
  if (!atData) return fail("The PCD header does not end", path, kDamaged);
  if (const std::string wrong = joinFields(raw, header); !wrong.empty())
    return fail("The PCD header is not usable: " + wrong, path, kDamaged);
  if (const std::string wrong = settleCounts(raw, header); !wrong.empty())
    return fail("The PCD header is not usable: " + wrong, path, kDamaged);
  return header;
}

}  // namespace alidade

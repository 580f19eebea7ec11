// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "mesh/mesh_source.h"
#include "mesh/text_lines.h"

namespace alidade {

namespace {

constexpr const char* kExportAgain = "Export it again from the program it came from";

std::size_t sizeOf(std::string_view type) {
  static const std::map<std::string_view, std::size_t> kSizes = {
      {"char", 1},  {"uchar", 1},  {"int8", 1},    {"uint8", 1},   {"short", 2},   {"ushort", 2},
      {"int16", 2}, {"uint16", 2}, {"int", 4},     {"uint", 4},    {"int32", 4},   {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = kSizes.find(type);
  return found == kSizes.end() ? 0 : found->second;
}

/// The header as far as the vertices' coordinates and the counts need it.
struct PlyHeader {
  enum class Coding { Text, Little, Big } coding = Coding::Text;
  std::size_t body = 0;  ///< where the data begin
  std::uint64_t vertices = 0, faces = 0, stride = 0;
  std::size_t words = 0;  ///< numbers of a vertex
  struct Coordinate {
    bool present = false;
    std::size_t byte = 0, word = 0, size = 0;
    bool isDouble = false;
  };
  std::array<Coordinate, 3> xyz;
};

Result<PlyHeader> parseHeader(const std::string& content) {
  PlyHeader header;
  std::string element;
  bool ended = false;
  Lines lines(content);
  std::size_t elements = 0;
  while (!ended && lines.number < 10000 && lines.next()) {
    std::string_view rest = lines.line;
    const std::string_view word = takeWord(rest);
    const std::string where = fmt::format("line {}", lines.number);
    if (word == "format") {
      const std::string_view coding = takeWord(rest);
      if (coding == "ascii") header.coding = PlyHeader::Coding::Text;
      else if (coding == "binary_little_endian") header.coding = PlyHeader::Coding::Little;
      else if (coding == "binary_big_endian") header.coding = PlyHeader::Coding::Big;
      else return fail(fmt::format("The PLY coding {} is not known", coding), where, kExportAgain);
    } else if (word == "element") {
      element = takeWord(rest);
      const auto count = toInteger(takeWord(rest));
      if (!count || *count < 0) return fail("A count in the PLY header is no number", where, kExportAgain);
      if (element == "vertex") {
        if (elements > 0) return fail("The PLY file does not begin with its vertices", where, kExportAgain);
        header.vertices = static_cast<std::uint64_t>(*count);
      } else if (element == "face") {
        header.faces = static_cast<std::uint64_t>(*count);
      }
      ++elements;
    } else if (word == "property" && element == "vertex") {
      const std::string_view type = takeWord(rest), name = takeWord(rest);
      const std::size_t size = sizeOf(type);
      if (size == 0) return fail(fmt::format("The vertex property \"{}\" is of a kind that is not read", lines.line), where, kExportAgain);
      const int axis = name == "x" ? 0 : name == "y" ? 1 : name == "z" ? 2 : -1;
      if (axis >= 0)
        header.xyz[axis] = {true, static_cast<std::size_t>(header.stride), header.words, size,
                            type == "double" || type == "float64"};
      header.stride += size;
      ++header.words;
    } else if (word == "end_header") {
      ended = true;
      header.body = static_cast<std::size_t>(lines.line.data() - content.data());
      header.body = content.find('\n', header.body);
      header.body = header.body == content.npos ? content.size() : header.body + 1;
    }
  }
  if (!ended) return fail("The PLY header does not end", {}, "Copy or export it again");
  for (const auto& c : header.xyz)
    if (!c.present || c.size < 4) return fail("The PLY vertices lack x, y or z as float or double", "header", kExportAgain);
  if (header.faces == 0)
    return fail("The PLY file holds points and no faces", {}, "Open it as a scan");
  return header;
}

template <class T>
T swapped(T value) {
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

double readNumber(const char* at, bool isDouble, bool swap) {
  if (isDouble) {
    double value;
    std::memcpy(&value, at, 8);
    return swap ? swapped(value) : value;
  }
  float value;
  std::memcpy(&value, at, 4);
  return swap ? swapped(value) : value;
}

void writeNumber(char* at, double value, bool isDouble, bool swap) {
  if (isDouble) {
    const double out = swap ? swapped(value) : value;
    std::memcpy(at, &out, 8);
  } else {
    const float plain = static_cast<float>(value);
    const float out = swap ? swapped(plain) : plain;
    std::memcpy(at, &out, 4);
  }
}

struct Range {
  glm::dvec3 least{std::numeric_limits<double>::infinity()}, most{-std::numeric_limits<double>::infinity()};
  bool add(int axis, double value) {
    least[axis] = std::min(least[axis], value);
    most[axis] = std::max(most[axis], value);
    return std::isfinite(value) && std::abs(value) < 1e12;
  }
};

Result<glm::dvec3> moveBinary(std::string& content, const PlyHeader& header) {
  if (header.vertices > (content.size() - header.body) / header.stride)
    return fail(fmt::format("The PLY file promises {} vertices and is too short for them", header.vertices), "header",
                "Copy or export it again");
  const bool swap = header.coding == PlyHeader::Coding::Big;
  Range range;
  for (std::uint64_t i = 0; i < header.vertices; ++i)
    for (int a = 0; a < 3; ++a) {
      const char* at = content.data() + header.body + i * header.stride + header.xyz[a].byte;
      if (!range.add(a, readNumber(at, header.xyz[a].isDouble, swap)))
        return fail("A vertex has a coordinate that is no usable number", fmt::format("vertex {}", i), kExportAgain);
    }
  const glm::dvec3 offset = wholeMetreOffset(range.least, range.most);
  if (offset == glm::dvec3(0)) return offset;
  for (std::uint64_t i = 0; i < header.vertices; ++i)
    for (int a = 0; a < 3; ++a) {
      char* at = content.data() + header.body + i * header.stride + header.xyz[a].byte;
      const bool isDouble = header.xyz[a].isDouble;
      writeNumber(at, readNumber(at, isDouble, swap) - offset[a], isDouble, swap);
    }
  return offset;
}

Result<glm::dvec3> moveText(std::string& content, const PlyHeader& header) {
  const std::string_view body = std::string_view(content).substr(header.body);
  Range range;
  std::vector<double> numbers;
  Lines lines(body);
  for (std::uint64_t i = 0; i < header.vertices; ++i) {
    const std::string where = fmt::format("vertex {}", i);
    if (!lines.next()) return fail(fmt::format("The PLY file promises {} vertices and holds {}", header.vertices, i), where, "Copy or export it again");
    std::string_view rest = lines.line;
    std::array<double, 3> xyz{};
    for (std::size_t w = 0; w < header.words; ++w) {
      const std::string_view word = takeWord(rest);
      for (int a = 0; a < 3; ++a) {
        if (header.xyz[a].word != w) continue;
        const auto value = toNumber(word);
        if (!value || !range.add(a, *value)) return fail("A vertex has a coordinate that is no usable number", where, kExportAgain);
        xyz[a] = *value;
      }
    }
    numbers.insert(numbers.end(), xyz.begin(), xyz.end());
  }
  const glm::dvec3 offset = wholeMetreOffset(range.least, range.most);
  if (offset == glm::dvec3(0)) return offset;
  std::string out = content.substr(0, header.body);
  Lines again(body);
  for (std::uint64_t i = 0; i < header.vertices && again.next(); ++i) {
    std::string_view rest = again.line;
    for (std::size_t w = 0; w < header.words; ++w) {
      const std::string_view word = takeWord(rest);
      int axis = -1;
      for (int a = 0; a < 3; ++a)
        if (header.xyz[a].word == w) axis = a;
      if (axis < 0) out.append(word);
      else fmt::format_to(std::back_inserter(out), "{:.9g}", numbers[3 * i + static_cast<std::size_t>(axis)] - offset[axis]);
      out += ' ';
    }
    out += '\n';
  }
  const std::size_t done = static_cast<std::size_t>(again.line.data() - content.data()) + again.line.size();
  const std::size_t next = content.find('\n', done);
  if (next != content.npos) out.append(content, next + 1, content.npos);
  content = std::move(out);
  return offset;
}

}  // namespace

Result<MeshSource> preparePly(std::string content) {
  const auto header = parseHeader(content);
  if (!header) return fail(header.error());
  auto offset = header->coding == PlyHeader::Coding::Text ? moveText(content, *header) : moveBinary(content, *header);
  if (!offset) return fail(offset.error());
  MeshSource source;
  source.ending = "ply";
  source.offset = *offset;
  source.elementCount = 1;
  source.details = fmt::format("PLY, {} vertices, {} faces", header->vertices, header->faces);
  if (!header->xyz[0].isDouble && header->coding != PlyHeader::Coding::Text) {
    const double step = std::max(std::abs(offset->x), std::abs(offset->y)) * std::numeric_limits<float>::epsilon();
    if (step > 0.0005)
      source.notes.push_back({fmt::format("The file holds coordinates as float, good to {:.0f} mm only this far from the "
                                          "origin", 1000 * step), {}});
  }
  source.content = std::move(content);
  return source;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "mesh/mesh_source.h"
#include "mesh/text_lines.h"

namespace alidade {

namespace {

constexpr const char* kExportAgain = "Export it again from the design program";

struct Counts {
  long long v = 0, vt = 0, vn = 0;
};

std::string atLine(std::size_t number) { return fmt::format("line {}", number); }

/// What the first pass over an OBJ file finds.
struct ObjScan {
  glm::dvec3 least{std::numeric_limits<double>::infinity()}, most{-std::numeric_limits<double>::infinity()};
  Counts total;
  std::uint64_t faces = 0;
  std::set<std::string> groups;
  std::vector<std::string> materialFiles;
  bool freeForm = false;
};

std::string restOf(std::string_view line) {
  const auto start = line.find_first_not_of(" \t");
  if (start == line.npos) return {};
  return std::string(line.substr(start, line.find_last_not_of(" \t") - start + 1));
}

Result<ObjScan> scanObj(const std::string& content) {
  ObjScan scan;
  Lines lines(content);
  while (lines.next()) {
    std::string_view rest = lines.line;
    const std::string_view word = takeWord(rest);
    if (word == "v") {
      for (int i = 0; i < 3; ++i) {
        const auto value = toNumber(takeWord(rest));
        if (!value || std::abs(*value) > 1e12)
          return fail("A vertex has a coordinate that is no usable number", atLine(lines.number), kExportAgain);
        scan.least[i] = std::min(scan.least[i], *value);
        scan.most[i] = std::max(scan.most[i], *value);
      }
      ++scan.total.v;
    } else if (word == "vt") ++scan.total.vt;
    else if (word == "vn") ++scan.total.vn;
    else if (word == "f") ++scan.faces;
    else if (word == "o" || word == "g") scan.groups.insert(restOf(rest));
    else if (word == "mtllib") scan.materialFiles.push_back(restOf(rest));
    else if (word == "surf" || word == "curv" || word == "curv2") scan.freeForm = true;
  }
  if (scan.total.v == 0 || scan.faces == 0)
    return fail("The OBJ file holds no faces", {}, "Export the design as a surface mesh");
  return scan;
}

/// One index of a face against how many there are; negative counts back from the last one read so far.
bool inRange(std::string_view word, long long sofar, long long total) {
  const auto index = toInteger(word);
  if (!index) return false;
  return *index > 0 ? *index <= total : *index < 0 && *index >= -sofar;
}

Result<void> checkFace(std::string_view rest, const Counts& sofar, const Counts& total, std::size_t line) {
  int corners = 0;
  for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest)) {
    if (word == "\\") continue;  // the face goes on in the next line
    const auto first = word.find('/');
    const auto second = first == word.npos ? word.npos : word.find('/', first + 1);
    const std::string_view v = word.substr(0, first);
    const std::string_view vt =
        first == word.npos ? std::string_view() : word.substr(first + 1, second == word.npos ? second : second - first - 1);
    const std::string_view vn = second == word.npos ? std::string_view() : word.substr(second + 1);
    const bool good = inRange(v, sofar.v, total.v) && (vt.empty() || inRange(vt, sofar.vt, total.vt)) &&
                      (vn.empty() || inRange(vn, sofar.vn, total.vn));
    if (!good)
      return fail(fmt::format("A face names the corner \"{}\", which does not exist", word.substr(0, 40)), atLine(line),
                  kExportAgain);
    ++corners;
  }
  if (corners == 0) return fail("A face has no corners", atLine(line), kExportAgain);
  return {};
}

/// The second pass: faces checked, vertices moved, all else copied.
Result<std::string> moveObj(const std::string& content, const ObjScan& scan, const glm::dvec3& offset) {
  std::string out;
  out.reserve(content.size() + content.size() / 8);
  Counts sofar;
  Lines lines(content);
  bool faceGoesOn = false;
  while (lines.next()) {
    std::string_view rest = lines.line;
    const std::string_view whole = lines.line;
    const std::string_view word = faceGoesOn ? std::string_view("f") : takeWord(rest);
    if (word == "v") {
      ++sofar.v;
      if (offset == glm::dvec3(0)) {
        out.append(whole);
      } else {
        std::array<double, 3> moved;
        for (int i = 0; i < 3; ++i) moved[i] = *toNumber(takeWord(rest)) - offset[i];
        fmt::format_to(std::back_inserter(out), "v {:.9g} {:.9g} {:.9g}{}", moved[0], moved[1], moved[2], rest);
      }
    } else if (word == "f") {
      if (const auto checked = checkFace(rest, sofar, scan.total, lines.number); !checked) return fail(checked.error());
      faceGoesOn = whole.ends_with('\\');
      out.append(whole);
    } else {
      if (word == "vt") ++sofar.vt;
      if (word == "vn") ++sofar.vn;
      out.append(whole);
    }
    out += '\n';
  }
  return out;
}

}  // namespace

Result<MeshSource> prepareObj(const std::string& content, const std::string& folder) {
  auto scan = scanObj(content);
  if (!scan) return fail(scan.error());
  MeshSource source;
  source.ending = "obj";
  source.offset = wholeMetreOffset(scan->least, scan->most);
  auto moved = moveObj(content, *scan, source.offset);
  if (!moved) return fail(moved.error());
  source.content = std::move(*moved);
  source.elementCount = std::max<std::uint64_t>(1, scan->groups.size());
  source.details = fmt::format("OBJ, {} groups, {} vertices, {} faces", source.elementCount, scan->total.v, scan->faces);
  for (const std::string& name : scan->materialFiles) {
    std::error_code code;
    if (!std::filesystem::is_regular_file(std::filesystem::path(folder) / name, code))
      source.notes.push_back({"The material file is missing; the design gets default colours", name});
  }
  if (scan->freeForm) source.notes.push_back({"Free-form curves and surfaces are not drawn", {}});
  return source;
}

}  // namespace alidade

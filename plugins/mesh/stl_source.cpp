// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "mesh/mesh_source.h"
#include "mesh/text_lines.h"

namespace alidade {

namespace {

constexpr const char* kExportAgain = "Export it again from the design program";
constexpr std::size_t kHeader = 84, kFacet = 50;

std::uint32_t facetCount(const std::string& content) {
  std::uint32_t count = 0;
  std::memcpy(&count, content.data() + 80, 4);
  return count;
}

/// Binary is 80 bytes, a count, and 50 bytes a facet (StereoLithography Interface Specification, 3D Systems
/// 1989); the size tells it apart, because binary files may begin with "solid" too.
Result<MeshSource> prepareBinary(std::string content) {
  if (content.size() < kHeader) return fail("The STL file is cut off in its header", {}, kExportAgain);
  const std::uint64_t count = facetCount(content);
  if (count == 0) return fail("The STL file holds no facets", {}, kExportAgain);
  if (kHeader + count * kFacet > content.size())
    return fail(fmt::format("The STL file promises {} facets and holds {}", count, (content.size() - kHeader) / kFacet),
                "header", "Copy or export it again");
  float reach = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::array<float, 9> corners;
    std::memcpy(corners.data(), content.data() + kHeader + i * kFacet + 12, sizeof corners);
    for (const float c : corners) {
      if (!std::isfinite(c))
        return fail("A facet has a coordinate that is no number", fmt::format("facet {}", i), kExportAgain);
      reach = std::max(reach, std::abs(c));
    }
  }
  MeshSource source;
  source.ending = "stl";
  source.elementCount = 1;
  source.details = fmt::format("binary STL, {} facets", count);
  const float step = std::nextafter(reach, std::numeric_limits<float>::infinity()) - reach;
  if (step > 0.0005f)
    source.notes.push_back({fmt::format("Binary STL holds coordinates to {:.0f} mm only, this far from the origin: "
                                        "export OBJ instead", 1000.0 * step), {}});
  source.content = std::move(content);
  return source;
}

Result<MeshSource> prepareText(const std::string& content) {
  glm::dvec3 least(std::numeric_limits<double>::infinity()), most(-std::numeric_limits<double>::infinity());
  std::uint64_t solids = 0, vertices = 0;
  for (Lines lines(content); lines.next();) {
    std::string_view rest = lines.line;
    const std::string_view word = takeWord(rest);
    if (word == "solid") ++solids;
    if (word != "vertex") continue;
    ++vertices;
    for (int i = 0; i < 3; ++i) {
      const auto value = toNumber(takeWord(rest));
      if (!value || std::abs(*value) > 1e12)
        return fail("A vertex has a coordinate that is no usable number", fmt::format("line {}", lines.number), kExportAgain);
      least[i] = std::min(least[i], *value);
      most[i] = std::max(most[i], *value);
    }
  }
  if (vertices < 3) return fail("The STL file holds no facets", {}, kExportAgain);
  if (vertices % 3 != 0) return fail("The STL file is cut off: its last facet lacks a corner", {}, "Copy or export it again");
  MeshSource source;
  source.ending = "stl";
  source.offset = wholeMetreOffset(least, most);
  source.elementCount = std::max<std::uint64_t>(1, solids);
  source.details = fmt::format("STL, {} solids, {} facets", source.elementCount, vertices / 3);
  for (Lines lines(content); lines.next();) {
    std::string_view rest = lines.line;
    if (takeWord(rest) == "vertex") {
      source.content += "vertex";
      for (int i = 0; i < 3; ++i)
        fmt::format_to(std::back_inserter(source.content), " {:.9g}", *toNumber(takeWord(rest)) - source.offset[i]);
    } else {
      source.content.append(lines.line);
    }
    source.content += '\n';
  }
  return source;
}

}  // namespace

Result<MeshSource> prepareStl(std::string content) {
  const bool exact = content.size() >= kHeader && kHeader + facetCount(content) * kFacet == content.size();
  const bool text = !exact && content.starts_with("solid") && content.find("facet") != content.npos;
  return text ? prepareText(content) : prepareBinary(std::move(content));
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/e57_document.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "e57/bit_packing.h"
#include "e57/e57_element.h"
#include "e57/e57_images.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace {

const std::string kAdvice = "Export the scan again, or convert it to LAS with another program";

// A DOM takes some ten times the text; the largest of real files are a few megabytes.
constexpr std::uint64_t kMaxXml = std::uint64_t(64) << 20;
constexpr std::size_t kMaxScans = 65535;  // PointBatch::scanner
constexpr std::size_t kMaxImages = 100000;
constexpr std::size_t kMaxFields = 1024;
constexpr int kMaxDepth = 16;

Result<std::string> readXml(const PagedFile& file) {
  if (file.xmlLength() > kMaxXml)
    return fail(fmt::format("The XML section has {} bytes, more than any E57 file needs", file.xmlLength()), file.path(), kAdvice);
  PageReader pages(file, 64);
  std::string text(file.xmlLength(), '\0');
  for (std::uint64_t at = 0; at < text.size();) {
    const std::size_t part = std::min<std::uint64_t>(text.size() - at, 60000);
    const auto bytes = pages.view(file.xmlOffset() + at, part);
    if (!bytes) return fail(bytes.error());
    std::memcpy(text.data() + at, bytes->data(), part);
    at += part;
  }
  return text;
}

Result<E57Field> fieldOf(const pugi::xml_node& node, const std::string& name) {
  E57Field field;
  field.name = name;
  const std::string_view type = node.attribute("type").value();
  if (type == "Float") {
    const std::string_view precision = node.attribute("precision").as_string("double");
    if (precision != "single" && precision != "double")
      return fail(fmt::format("The field {} has the unknown precision {}", name, quotedWords(precision)));
    field.kind = precision == "single" ? E57Field::Kind::Single : E57Field::Kind::Double;
    const auto least = numberAttribute(node, "minimum"), most = numberAttribute(node, "maximum");
    if (least) field.floatMinimum = *least;  // no codec depends on them: a slip here costs nothing
    if (most) field.floatMaximum = *most;
    return field;
  }
  if (type == "Integer" || type == "ScaledInteger") {
    field.kind = type == "Integer" ? E57Field::Kind::Integer : E57Field::Kind::ScaledInteger;
    const auto least = integerAttribute(node, "minimum"), most = integerAttribute(node, "maximum");
    if (!least) return fail(least.error());
    if (!most) return fail(most.error());
    field.minimum = least->value_or(INT64_MIN);
    field.maximum = most->value_or(INT64_MAX);
    if (field.minimum > field.maximum)
      return fail(fmt::format("The field {} has a minimum {} above its maximum {}", name, field.minimum, field.maximum));
    const auto scale = numberAttribute(node, "scale"), offset = numberAttribute(node, "offset");
    if (!scale) return fail(scale.error());
    if (!offset) return fail(offset.error());
    field.scale = scale->value_or(1);
    field.offset = offset->value_or(0);
    if (field.scale == 0) return fail(fmt::format("The field {} has a scale of 0", name));
    return field;
  }
  if (type == "String") {
    field.kind = E57Field::Kind::String;
    return field;
  }
  return fail(fmt::format("The field {} is of the unknown type {}", name, quotedWords(type)));
}

/// The leaves in document order: one stream each.
Result<void> gatherFields(const pugi::xml_node& structure, const std::string& prefix, int depth, std::vector<E57Field>& into) {
  if (depth > kMaxDepth) return fail("The point prototype is nested too deeply");
  for (const pugi::xml_node child : structure.children()) {
    if (child.type() != pugi::node_element) continue;
    const std::string_view type = child.attribute("type").value();
    const std::string name = prefix + child.name();
    if (type == "Structure" || type == "Vector") {
      if (auto ok = gatherFields(child, name + "/", depth + 1, into); !ok) return ok;
      continue;
    }
    auto field = fieldOf(child, name);
    if (!field) return fail(field.error());
    if (into.size() >= kMaxFields) return fail(fmt::format("The points have more than {} fields", kMaxFields));
    into.push_back(std::move(*field));
  }
  return {};
}

Result<void> checkCodecs(const pugi::xml_node& codecs) {
  for (const pugi::xml_node codec : codecs.children())
    for (const pugi::xml_node part : codec.children())
      if (localName(part).ends_with("Codec") && localName(part) != "bitPackCodec")
        return fail(fmt::format("The points are packed with the unknown codec {}", quotedWords(part.name())));
  return {};
}

Result<void> readPoints(const pugi::xml_node& points, E57Scan& scan) {
  if (std::strcmp(points.attribute("type").value(), "CompressedVector") != 0)
    return fail("Its points are no CompressedVector");
  const auto count = integerAttribute(points, "recordCount"), offset = integerAttribute(points, "fileOffset");
  if (!count) return fail(count.error());
  if (!offset) return fail(offset.error());
  if (!*count || !*offset || **count < 0 || **offset < 0)
    return fail("Its points have no recordCount or no fileOffset, or a negative one");
  scan.recordCount = static_cast<std::uint64_t>(**count);
  scan.fileOffset = static_cast<std::uint64_t>(**offset);
  if (auto ok = checkCodecs(points.child("codecs")); !ok) return ok;
  return gatherFields(points.child("prototype"), {}, 0, scan.fields);
}

std::optional<E57Limits> limitsOf(const pugi::xml_node& node, const char* minimum, const char* maximum) {
  const auto least = numberOf(node.child(minimum)), most = numberOf(node.child(maximum));
  if (!least || !most || !(*least < *most)) return std::nullopt;
  return E57Limits{*least, *most};
}

std::optional<std::pair<std::int64_t, std::int64_t>> indexBoundsOf(const pugi::xml_node& node, const char* minimum,
                                                                   const char* maximum) {
  const auto least = integerOf(node.child(minimum)), most = integerOf(node.child(maximum));
  if (!least || !most || *least > *most) return std::nullopt;
  return std::pair(*least, *most);
}

Bounds boundsOf(const pugi::xml_node& node) {
  glm::dvec3 corners[2];
  const char* names[2][3] = {{"xMinimum", "yMinimum", "zMinimum"}, {"xMaximum", "yMaximum", "zMaximum"}};
  for (int k = 0; k < 2; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      const auto value = numberOf(node.child(names[k][axis]));
      // Libraries leave ±1.8e308 where nobody stated any.
      if (!value || std::abs(*value) > 1e12) return {};
      corners[k][axis] = *value;
    }
  return Bounds{corners[0], corners[1]};
}

Result<E57Scan> scanOf(const pugi::xml_node& node, std::size_t index, std::vector<ImportWarning>& warnings) {
  E57Scan scan;
  scan.name = textOf(node.child("name"));
  if (scan.name.empty()) scan.name = fmt::format("Scan {}", index + 1);
  if (const pugi::xml_node pose = node.child("pose")) {
    const auto transform = poseOf(pose);
    if (!transform) return fail(transform.error());
    scan.worldFromScanner = *transform;
    scan.hasPose = true;
    if (const auto rotation = pose.child("rotation")) {
      const double w = numberOf(rotation.child("w")).value_or(0), x = numberOf(rotation.child("x")).value_or(0),
                   y = numberOf(rotation.child("y")).value_or(0), z = numberOf(rotation.child("z")).value_or(0);
      const double length = std::hypot(std::hypot(w, x), std::hypot(y, z));
      if (std::abs(length - 1) > 1e-3)
        warnings.push_back({fmt::format("The attitude's quaternion has the length {:.6g}; it was {}", length,
                                        length > 0 ? "made 1" : "taken as no rotation"), scan.name});
    }
  }
  scan.localBounds = boundsOf(node.child("cartesianBounds"));
  scan.intensityLimits = limitsOf(node.child("intensityLimits"), "intensityMinimum", "intensityMaximum");
  const pugi::xml_node colour = node.child("colorLimits");
  scan.colourLimits[0] = limitsOf(colour, "colorRedMinimum", "colorRedMaximum");
  scan.colourLimits[1] = limitsOf(colour, "colorGreenMinimum", "colorGreenMaximum");
  scan.colourLimits[2] = limitsOf(colour, "colorBlueMinimum", "colorBlueMaximum");
  const pugi::xml_node grid = node.child("indexBounds");
  scan.rowBounds = indexBoundsOf(grid, "rowMinimum", "rowMaximum");
  scan.columnBounds = indexBoundsOf(grid, "columnMinimum", "columnMaximum");
  const pugi::xml_node points = node.child("points");
  if (!points) return fail("It has no points element");
  if (auto ok = readPoints(points, scan); !ok) return fail(ok.error());
  return scan;
}

}  // namespace

std::uint64_t E57Field::bits() const {
  switch (kind) {
    case Kind::Single: return 32;
    case Kind::Double: return 64;
    case Kind::String: return 8;
    default: return static_cast<std::uint64_t>(packedBits(minimum, maximum));
  }
}

std::optional<std::pair<double, double>> E57Field::range() const {
  if (isFloat()) {
    const bool open = !floatMinimum || !floatMaximum || std::abs(*floatMinimum) > 1e30 || std::abs(*floatMaximum) > 1e30;
    return open || !(*floatMinimum < *floatMaximum) ? std::nullopt : std::optional(std::pair(*floatMinimum, *floatMaximum));
  }
  if (kind == Kind::String || minimum == INT64_MIN || maximum == INT64_MAX || minimum == maximum) return std::nullopt;
  return std::pair(static_cast<double>(minimum) * scale + offset, static_cast<double>(maximum) * scale + offset);
}

int E57Scan::fieldNamed(const std::string& wanted) const {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const E57Field& field) { return field.name == wanted; });
  return found == fields.end() ? -1 : static_cast<int>(found - fields.begin());
}

Result<E57Document> readE57Document(const PagedFile& file) {
  auto text = readXml(file);
  if (!text) return fail(text.error());
  pugi::xml_document xml;
  // Document types are skipped, entities of a file's own never expanded.
  const auto outcome = xml.load_buffer_inplace(text->data(), text->size(), pugi::parse_default, pugi::encoding_utf8);
  if (!outcome)
    return fail(fmt::format("The XML section is broken: {} at its byte {}", outcome.description(), outcome.offset), file.path(), kAdvice);
  const pugi::xml_node root = xml.child("e57Root");
  if (!root) return fail("The XML section has no e57Root", file.path(), kAdvice);

  E57Document document;
  document.library = textOf(root.child("e57LibraryVersion"));
  document.crs = textOf(root.child("coordinateMetadata"));
  for (const pugi::xml_node node : root.child("data3D").children()) {
    if (node.type() != pugi::node_element) continue;
    if (document.scans.size() >= kMaxScans) return fail(fmt::format("The file has more than {} scans", kMaxScans), file.path(), kAdvice);
    auto scan = scanOf(node, document.scans.size(), document.warnings);
    if (!scan) {
      Error error = scan.error();
      if (error.advice.empty()) error.advice = kAdvice;
      return fail(error.in(fmt::format("{}, scan {}", file.path(), document.scans.size() + 1)));
    }
    document.scans.push_back(std::move(*scan));
  }
  std::set<std::string> names;
  for (const pugi::xml_node node : root.child("images2D").children()) {
    if (node.type() != pugi::node_element) continue;
    auto image = e57ImageOf(node, document.images.size());
    if (!image) return fail(image.error().in(fmt::format("{}, picture {}", file.path(), document.images.size() + 1)));
    if (document.images.size() >= kMaxImages) return fail(fmt::format("The file has more than {} pictures", kMaxImages), file.path(), kAdvice);
    // Poses find their pictures by name.
    if (!names.insert(image->name).second) image->name += fmt::format(" ({})", document.images.size() + 1);
    document.images.push_back(std::move(*image));
  }
  return document;
}

}  // namespace alidade

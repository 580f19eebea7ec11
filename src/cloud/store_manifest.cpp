// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/store_manifest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cloud/byte_pack.h"
#include "cloud/disk.h"
#include "cloud/part_index.h"

namespace alidade {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 2;
constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 48, kMostManifestBytes = std::uint64_t{1} << 28;

/// By NumberType.
constexpr const char* kTypeNames[] = {"i8", "u8", "i16", "u16", "i32", "u32", "i64", "u64", "f32", "f64"};
/// By ExactCoordinates.
constexpr const char* kExactNames[] = {"lattice", "i32", "f32", "f64"};
/// By GpsTimeKind.
constexpr const char* kTimeNames[] = {"unknown", "of-week", "standard"};
/// By LevelKind.
constexpr const char* kLevelNames[] = {"blue-noise", "random"};

Json textJson(const std::string& text) {
  try {
    (void)Json(text).dump();
    return text;
  } catch (const Json::exception&) {
    Json bytes = Json::array();
    for (const char c : text) bytes.push_back(static_cast<unsigned char>(c));
    return bytes;
  }
}

Json numberJson(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

template <class Vec>
Json vecJson(const Vec& v) {
  if constexpr (std::is_same_v<Vec, glm::dvec3>) return {numberJson(v.x), numberJson(v.y), numberJson(v.z)};
  else return {v.x, v.y, v.z};
}

Json infoJson(const ScanInfo& info) {
  Json stations = Json::array(), attributes = Json::array();
  for (const Station& s : info.stations) {
    const glm::dquat& q = s.worldFromScanner.rotation;
    stations.push_back({{"name", textJson(s.name)},
                        {"rotation_wxyz", {numberJson(q.w), numberJson(q.x), numberJson(q.y), numberJson(q.z)}},
                        {"position_m", vecJson(s.worldFromScanner.translation)},
                        {"rows", s.rows},
                        {"columns", s.columns}});
  }
  for (const std::string& name : info.attributes) attributes.push_back(textJson(name));
  Json bounds = nullptr;
  if (!info.bounds.empty()) bounds = {{"min", vecJson(info.bounds.min)}, {"max", vecJson(info.bounds.max)}};
  return {{"points", info.pointCount},       {"bounds_m", bounds},         {"crs", textJson(info.crs)},
          {"scale_m", vecJson(info.scale)},  {"offset_m", vecJson(info.offset)}, {"attributes", attributes},
          {"stations", stations},            {"details", textJson(info.details)}};
}

/// Two digits a byte.
std::string hexOf(const std::vector<std::byte>& bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::byte byte : bytes) {
    text += digits[std::to_integer<std::size_t>(byte) >> 4];
    text += digits[std::to_integer<std::size_t>(byte) & 15];
  }
  return text;
}

Json notesJson(const ScanNotes& notes) {
  Json out = Json::object(), columns = Json::array(), records = Json::array();
  for (const ColumnMeaning& c : notes.columns)
    columns.push_back({{"column", textJson(c.column)}, {"description", textJson(c.description)}, {"given", c.given}, {"no_data", c.noData},
                       {"least", c.least}, {"largest", c.largest}, {"scale", vecJson(c.scale)}, {"offset", vecJson(c.offset)}});
  for (const ForeignRecord& r : notes.records)
    records.push_back({{"user", textJson(r.user)}, {"id", r.id}, {"description", textJson(r.description)}, {"payload", hexOf(r.payload)}});
  if (!columns.empty()) out["columns"] = std::move(columns);
  if (notes.gpsTime != GpsTimeKind::Unknown) out["gps_time"] = kTimeNames[static_cast<int>(notes.gpsTime)];
  if (!records.empty()) out["records"] = std::move(records);
  if (notes.degrees) out["degrees"] = true;
  return out;
}

Json partJson(const PartManifest& part) {
  const Json notes = notesJson(part.notes);
  Json columns = Json::array();
  for (const ColumnShape& c : part.schema.columns)
    columns.push_back({{"name", textJson(c.name)}, {"type", kTypeNames[static_cast<int>(c.type)]}, {"components", c.components},
                       {"extra", c.extra}, {"ordinal", c.ordinal}});
  Json json = {{"folder", part.folder},
          {"source", textJson(part.source)},
          {"identity", textJson(part.identity)},
          {"scan", infoJson(part.info)},
          {"lattice", {{"exact", kExactNames[static_cast<int>(part.lattice.exact)]}, {"step_m", part.lattice.step},
                       {"scale_m", vecJson(part.lattice.scale)}, {"offset_m", vecJson(part.lattice.offset)},
                       {"corner", vecJson(part.lattice.corner)}}},
          {"rgb_white", part.schema.rgbWhite},
          {"columns", columns},
          {"levels", {{"kind", kLevelNames[static_cast<int>(part.levelKind)]}, {"dimensions", part.law.dimensions},
                      {"deepest", part.law.deepest}, {"shift", part.lawShift}, {"seed", part.seed}}},
          {"points", part.pointCount},
          {"dropped", part.dropped},
          {"nodes", {{"count", part.nodeCount}, {"checksum", part.nodesChecksum}}},
          {"tables", {{"count", part.tableCount}, {"checksum", part.tablesChecksum}}},
          {"purpose", part.purpose}};
  if (!notes.empty()) json["notes"] = notes;
  return json;
}

/// Thrown and caught in this file alone, as the library's own exceptions are.
[[noreturn]] void refuse(const char* what) {
  throw std::runtime_error(what);
}

std::string textOf(const Json& j) {
  if (j.is_string()) return j.get<std::string>();
  if (!j.is_array()) refuse("a text");
  std::string text;
  for (const Json& byte : j) {
    if (!byte.is_number_unsigned() || byte.get<std::uint64_t>() > 255) refuse("a text");
    text.push_back(static_cast<char>(byte.get<std::uint64_t>()));
  }
  return text;
}

double numberOf(const Json& j) {
  if (j.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (!j.is_number()) refuse("a number");
  return j.get<double>();
}

double finiteOf(const Json& j) {
  const double value = numberOf(j);
  if (!std::isfinite(value)) refuse("a number");
  return value;
}

std::uint64_t countOf(const Json& j, std::uint64_t most) {
  if (!j.is_number_unsigned() || j.get<std::uint64_t>() > most) refuse("a count");
  return j.get<std::uint64_t>();
}

bool flagOf(const Json& j) {
  if (!j.is_boolean()) refuse("a flag");
  return j.get<bool>();
}

glm::dvec3 vecOf(const Json& j) {
  if (!j.is_array() || j.size() != 3) refuse("a vector");
  return {numberOf(j[0]), numberOf(j[1]), numberOf(j[2])};
}

glm::dvec3 finiteVecOf(const Json& j) {
  const glm::dvec3 v = vecOf(j);
  if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) refuse("a vector");
  return v;
}

template <std::size_t kCount>
int choiceOf(const Json& j, const char* const (&names)[kCount]) {
  const std::string name = textOf(j);
  const auto found = std::find(std::begin(names), std::end(names), name);
  if (found == std::end(names)) refuse("a choice");
  return static_cast<int>(found - std::begin(names));
}

ScanInfo infoOf(const Json& j) {
  ScanInfo info;
  info.pointCount = countOf(j.at("points"), std::numeric_limits<std::uint64_t>::max());
  if (const Json& bounds = j.at("bounds_m"); !bounds.is_null()) info.bounds.min = vecOf(bounds.at("min")), info.bounds.max = vecOf(bounds.at("max"));
  info.crs = textOf(j.at("crs"));
  info.scale = vecOf(j.at("scale_m")), info.offset = vecOf(j.at("offset_m"));
  for (const Json& name : j.at("attributes")) info.attributes.push_back(textOf(name));
  for (const Json& s : j.at("stations")) {
    Station station;
    station.name = textOf(s.at("name"));
    const Json& q = s.at("rotation_wxyz");
    if (!q.is_array() || q.size() != 4) refuse("a rotation");
    station.worldFromScanner.rotation = glm::dquat(numberOf(q[0]), numberOf(q[1]), numberOf(q[2]), numberOf(q[3]));
    station.worldFromScanner.translation = vecOf(s.at("position_m"));
    station.rows = static_cast<std::uint32_t>(countOf(s.at("rows"), 0xffffffffu));
    station.columns = static_cast<std::uint32_t>(countOf(s.at("columns"), 0xffffffffu));
    info.stations.push_back(station);
  }
  info.details = textOf(j.at("details"));
  return info;
}

std::vector<std::byte> bytesOf(const Json& j) {
  const std::string text = textOf(j);
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c < 'a' || c > 'f') refuse("a digit");
    return c - 'a' + 10;
  };
  if (text.size() % 2 != 0) refuse("a digit");
  std::vector<std::byte> bytes(text.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(digit(text[2 * i]) * 16 + digit(text[2 * i + 1]));
  return bytes;
}

ColumnMeaning::Triple tripleOf(const Json& j) {
  if (!j.is_array() || j.size() != 3) refuse("a triple");
  ColumnMeaning::Triple triple;
  for (std::size_t i = 0; i < 3; ++i) triple[i] = countOf(j[i], std::numeric_limits<std::uint64_t>::max());
  return triple;
}

/// Every field may be absent.
ScanNotes notesOf(const Json& j) {
  ScanNotes notes;
  if (j.contains("columns"))
    for (const Json& c : j.at("columns")) {
      ColumnMeaning meaning;
      meaning.column = textOf(c.at("column")), meaning.description = textOf(c.at("description"));
      meaning.given = static_cast<std::uint8_t>(countOf(c.at("given"), 0x1F));
      meaning.noData = tripleOf(c.at("no_data")), meaning.least = tripleOf(c.at("least")), meaning.largest = tripleOf(c.at("largest"));
      meaning.scale = vecOf(c.at("scale")), meaning.offset = vecOf(c.at("offset"));
      notes.columns.push_back(std::move(meaning));
    }
  if (j.contains("gps_time")) notes.gpsTime = static_cast<GpsTimeKind>(choiceOf(j.at("gps_time"), kTimeNames));
  if (j.contains("records"))
    for (const Json& r : j.at("records"))
      notes.records.push_back({textOf(r.at("user")), static_cast<std::uint16_t>(countOf(r.at("id"), 65535)), textOf(r.at("description")),
                               bytesOf(r.at("payload"))});
  if (j.contains("degrees")) notes.degrees = flagOf(j.at("degrees"));
  return notes;
}

Lattice latticeOf(const Json& j) {
  Lattice lattice;
  lattice.exact = static_cast<ExactCoordinates>(choiceOf(j.at("exact"), kExactNames));
  lattice.step = finiteOf(j.at("step_m"));
  if (!(lattice.step > 0)) refuse("a step");
  lattice.scale = finiteVecOf(j.at("scale_m")), lattice.offset = finiteVecOf(j.at("offset_m"));
  const Json& corner = j.at("corner");
  if (!corner.is_array() || corner.size() != 3) refuse("a corner");
  for (int axis = 0; axis < 3; ++axis) {
    if (!corner[static_cast<std::size_t>(axis)].is_number_integer()) refuse("a corner");
    lattice.corner[axis] = corner[static_cast<std::size_t>(axis)].get<std::int64_t>();
  }
  return lattice;
}

ColumnShape columnOf(const Json& j) {
  ColumnShape column;
  column.name = textOf(j.at("name"));
  column.type = static_cast<NumberType>(choiceOf(j.at("type"), kTypeNames));
  column.components = static_cast<int>(countOf(j.at("components"), 1 << 16));
  column.extra = flagOf(j.at("extra"));
  column.ordinal = static_cast<int>(countOf(j.at("ordinal"), 1 << 16));
  if (column.components < 1 || (!column.extra && !isOwnColumn(column))) refuse("a column");
  return column;
}

PartManifest partOf(const Json& j, std::size_t number) {
  PartManifest part;
  part.folder = textOf(j.at("folder"));
  // No other name, and so no way out of the store's folder.
  if (part.folder != partFolderName(number)) refuse("a folder");
  part.source = textOf(j.at("source")), part.identity = textOf(j.at("identity"));
  part.info = infoOf(j.at("scan"));
  if (j.contains("notes")) part.notes = notesOf(j.at("notes"));
  part.lattice = latticeOf(j.at("lattice"));
  part.schema.rgbWhite = static_cast<std::uint16_t>(countOf(j.at("rgb_white"), 65535));
  if (part.schema.rgbWhite != 255 && part.schema.rgbWhite != 65535) refuse("a brightness");
  for (const Json& column : j.at("columns")) {
    const ColumnShape shape = columnOf(column);
    if (std::ranges::find(part.schema.columns, shape) != part.schema.columns.end()) refuse("a column");
    part.schema.columns.push_back(shape);
  }
  const Json& levels = j.at("levels");
  part.levelKind = static_cast<LevelKind>(choiceOf(levels.at("kind"), kLevelNames));
  part.law.dimensions = static_cast<int>(countOf(levels.at("dimensions"), 16));
  part.law.deepest = static_cast<int>(countOf(levels.at("deepest"), 64));
  part.lawShift = finiteOf(levels.at("shift"));
  part.seed = static_cast<std::uint32_t>(countOf(levels.at("seed"), 0xffffffffu));
  part.pointCount = countOf(j.at("points"), kMostPoints / std::max<std::uint64_t>(1, part.schema.bytes()));
  part.dropped = countOf(j.at("dropped"), std::numeric_limits<std::uint64_t>::max());
  const Json &nodes = j.at("nodes"), &tables = j.at("tables");
  part.nodeCount = countOf(nodes.at("count"), std::numeric_limits<std::int32_t>::max());
  part.nodesChecksum = countOf(nodes.at("checksum"), std::numeric_limits<std::uint64_t>::max());
  part.tableCount = countOf(tables.at("count"), kMostPoints);
  part.tablesChecksum = countOf(tables.at("checksum"), std::numeric_limits<std::uint64_t>::max());
  part.purpose = countOf(j.at("purpose"), std::numeric_limits<std::uint64_t>::max());
  return part;
}

std::uint64_t checksumOfParts(const Json& parts) {
  const std::string text = parts.dump();
  return checksumOf(std::as_bytes(std::span(text)));
}

}  // namespace

std::string partFolderName(std::size_t number) {
  return fmt::format("part-{:04}", number);
}

std::size_t PartManifest::columnWidth(std::size_t column) const {
  if (column == PartSink::kPoints) return sizeof(DisplayPoint);
  if (column == PartSink::kExact) return lattice.exactBytes();
  return schema.columns[column - PartSink::kFirstAttribute].bytes();
}

std::string manifestText(const std::vector<PartManifest>& parts) {
  Json all = Json::array();
  for (const PartManifest& part : parts) all.push_back(partJson(part));
  const std::uint64_t checksum = checksumOfParts(all);
  const Json manifest = {{"format", kManifestFormat}, {"version", kVersion}, {"checksum", checksum}, {"parts", std::move(all)}};
  return manifest.dump(1, ' ') + "\n";
}

Result<std::vector<PartManifest>> parseManifest(std::string_view text, const std::string& path, std::size_t first) {
  constexpr const char* kAdvice = "Index the scans again";
  try {
    const Json manifest = Json::parse(text);
    if (textOf(manifest.at("format")) != kManifestFormat) return fail("The file is no point store's manifest", path, kAdvice);
    if (const std::uint64_t version = countOf(manifest.at("version"), 1 << 30); version != kVersion)
      return fail(fmt::format("The point store is of version {}, and only version {} is read", version, kVersion), path, kAdvice);
    const Json& all = manifest.at("parts");
    if (!all.is_array()) refuse("a list of parts");
    if (countOf(manifest.at("checksum"), std::numeric_limits<std::uint64_t>::max()) != checksumOfParts(all))
      return fail("The point store's manifest is damaged: its checksum is wrong", path, kAdvice);
    std::vector<PartManifest> parts;
    for (const Json& part : all) parts.push_back(partOf(part, first + parts.size()));
    return parts;
  } catch (const Json::exception&) {
    return fail("The point store's manifest is damaged", path, kAdvice);
  } catch (const std::runtime_error& wrong) {
    return fail(fmt::format("The point store's manifest is damaged: it lacks {}", wrong.what()), path, kAdvice);
  }
}

Result<std::vector<PartManifest>> readManifest(const std::string& path, std::size_t first) {
  auto file = MappedFile::open(path);
  if (!file) return fail(file.error());
  if (file->bytes().size() > kMostManifestBytes)
    return fail("The point store's manifest is larger than any can be", path, "Index the scans again");
  return parseManifest({reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size()}, path, first);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trajectory/pose_table_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_set>

#include <fmt/format.h>

#include "geometry/attitude.h"
#include "plugin_api/import_slip.h"
#include "plugin_api/text_file.h"
#include "trajectory/pose_rows.h"

namespace alidade {

namespace {

const std::string kAdvice = "Name the columns: name,x,y,z and omega_deg,phi_deg,kappa_deg or yaw_deg,pitch_deg,roll_deg";

enum class Angles { None, OmegaPhiKappa, YawPitchRoll, Gimbal };

/// A header field, its unit taken off: "Kappa [gon]" is kappa in gon.
struct Column {
  std::string name;
  std::string unit;
};

Column columnOf(std::string_view field) {
  std::string text = lowerCase(trimmed(field));
  std::erase(text, '"');
  for (char& c : text)
    if (c == '[' || c == ']' || c == '(' || c == ')' || c == ' ' || c == '-') c = '_';
  while (text.ends_with('_')) text.pop_back();
  while (text.starts_with('_')) text.erase(0, 1);
  if (const std::size_t at = text.rfind('_'); at != std::string::npos) {
    const std::string tail = text.substr(at + 1);
    for (const char* unit : {"deg", "degree", "degrees", "°", "gon", "grad", "rad", "radian", "radians", "m", "metre", "meter", "ft", "feet", "s", "sec"})
      if (tail == unit) {
        std::string name = text.substr(0, at);
        while (name.ends_with('_')) name.pop_back();
        return {name, tail};
      }
  }
  return {text, {}};
}

struct Layout {
  char separator = ',';
  int name = -1, time = -1;
  std::array<int, 3> position{-1, -1, -1}, angles{-1, -1, -1};
  Angles kind = Angles::None;
  double radiansPerUnit = std::numbers::pi / 180;
  bool unitAssumed = false;
};

/// Runs of blanks separate as one.
std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  if (separator == ' ') {
    FieldReader reader(line);
    for (std::string_view word; reader.next(word);) fields.push_back(word);
    return fields;
  }
  for (;;) {
    const std::size_t end = std::min(line.find(separator), line.size());
    std::string_view field = trimmed(line.substr(0, end));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    fields.push_back(field);
    if (end == line.size()) return fields;
    line.remove_prefix(end + 1);
  }
}

char separatorOf(std::string_view line) {
  for (const char c : {';', '\t', ','})
    if (line.find(c) != std::string_view::npos) return c;
  return ' ';
}

bool isOneOf(const std::string& name, std::initializer_list<const char*> names) {
  return std::any_of(names.begin(), names.end(), [&](const char* each) { return name == each; });
}

/// Where a column goes; false where it is of no use here.
bool place(const std::string& name, int index, Layout& layout, std::array<std::array<int, 3>, 3>& angles) {
  const auto set = [&](int& slot) {
    if (slot < 0) slot = index;
    return true;
  };
  if (isOneOf(name, {"name", "label", "image", "image_name", "imagename", "filename", "file", "file_name", "photo", "picture"})) return set(layout.name);
  if (isOneOf(name, {"time", "timestamp", "t"})) return set(layout.time);
  if (isOneOf(name, {"x", "e", "easting", "east"})) return set(layout.position[0]);
  if (isOneOf(name, {"y", "n", "northing", "north"})) return set(layout.position[1]);
  if (isOneOf(name, {"z", "h", "height", "up", "elevation", "altitude", "alt"})) return set(layout.position[2]);
  static constexpr const char* kNames[3][3] = {
      {"omega", "phi", "kappa"}, {"yaw", "pitch", "roll"}, {"gimbal_yaw", "gimbal_pitch", "gimbal_roll"}};
  for (std::size_t kind = 0; kind < 3; ++kind)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (name == kNames[kind][axis]) return set(angles[kind][axis]);
  return false;
}

bool complete(const std::array<int, 3>& columns) {
  return std::all_of(columns.begin(), columns.end(), [](int c) { return c >= 0; });
}

Result<Layout> layoutOf(std::string_view header, const std::string& where) {
  Layout layout;
  if (header.starts_with('#')) header.remove_prefix(1);
  layout.separator = separatorOf(trimmed(header));
  std::array<std::array<int, 3>, 3> angles{{{-1, -1, -1}, {-1, -1, -1}, {-1, -1, -1}}};
  std::vector<Column> columns;
  for (const std::string_view field : split(trimmed(header), layout.separator)) {
    Column column = columnOf(field);
    if (isOneOf(column.name, {"latitude", "longitude", "lat", "lon", "long", "lng"}))
      return fail("The table has the column " + quotedWords(field) + ": geographic coordinates are not read", where,
                  "Transform the positions to the survey's coordinate system, in metres");
    if (place(column.name, static_cast<int>(columns.size()), layout, angles) && isOneOf(column.unit, {"ft", "feet"}))
      return fail("The column " + quotedWords(field) + " is in feet", where, "Convert the table to metres");
    columns.push_back(std::move(column));
  }
  if (layout.name < 0 && layout.time < 0) return fail("The table has no column of names and none of times", where, kAdvice);
  if (!complete(layout.position)) return fail("The table lacks a column of x, y or z", where, kAdvice);
  constexpr Angles kKinds[] = {Angles::OmegaPhiKappa, Angles::YawPitchRoll, Angles::Gimbal};
  for (std::size_t kind = 0; kind < 3; ++kind) {
    if (std::all_of(angles[kind].begin(), angles[kind].end(), [](int c) { return c < 0; })) continue;
    if (!complete(angles[kind])) return fail("One of the three angles is missing", where, kAdvice);
    if (layout.kind != Angles::None)
      return fail("The table has two kinds of angles", where, "Leave either omega, phi, kappa or yaw, pitch, roll in it");
    layout.kind = kKinds[kind];
    layout.angles = angles[kind];
  }
  if (layout.kind == Angles::None) return fail("The table has no angles", where, kAdvice);

  const std::string& unit = columns[std::size_t(layout.angles[0])].unit;
  for (const int column : layout.angles)
    if (columns[std::size_t(column)].unit != unit) return fail("The three angles have different units", where, "Give all three the same unit");
  if (isOneOf(unit, {"gon", "grad"})) layout.radiansPerUnit = std::numbers::pi / 200;
  else if (isOneOf(unit, {"rad", "radian", "radians"})) layout.radiansPerUnit = 1;
  layout.unitAssumed = unit.empty();
  return layout;
}

glm::dquat rotationOf(const Layout& layout, const glm::dvec3& angles) {
  const glm::dvec3 a = layout.radiansPerUnit * angles;
  switch (layout.kind) {
    case Angles::OmegaPhiKappa: return worldFromCameraRotation(OmegaPhiKappa{a.x, a.y, a.z});
    case Angles::Gimbal: return worldFromNoseCamera({a.x, a.y, a.z});
    default: return worldFromFloorCamera({a.x, a.y, a.z});
  }
}

std::string_view kindWords(Angles kind) {
  switch (kind) {
    case Angles::OmegaPhiKappa: return "omega, phi, kappa";
    case Angles::Gimbal: return "a gimbal's yaw, pitch, roll (0 looks level)";
    default: return "yaw, pitch, roll (0 looks straight down)";
  }
}

/// One row; Error where a number is missing or impossible.
Result<PosedPicture> poseOf(std::string_view line, const Layout& layout, const std::string& where) {
  const std::vector<std::string_view> words = split(line, layout.separator);
  const auto field = [&](int column) { return std::size_t(column) < words.size() ? words[std::size_t(column)] : std::string_view(); };
  const auto numbers = [&](const std::array<int, 3>& columns) -> Result<glm::dvec3> {
    glm::dvec3 v(0);
    for (int i = 0; i < 3; ++i) {
      const auto number = parseNumber(field(columns[std::size_t(i)]));
      if (!number) return fail("A number is expected, not " + quotedWords(field(columns[std::size_t(i)])), where, kAdvice);
      if (!std::isfinite(*number) || std::abs(*number) > 1e9) return fail("A number is not finite or beyond 1e9", where, kAdvice);
      v[i] = *number;
    }
    return v;
  };
  const auto position = numbers(layout.position), angles = numbers(layout.angles);
  if (!position) return fail(position.error());
  if (!angles) return fail(angles.error());
  PosedPicture picture;
  if (layout.name >= 0) {
    picture.name = std::string(field(layout.name));
    if (picture.name.empty()) return fail("The row has no name", where, kAdvice);
  }
  if (layout.time >= 0) {
    const auto time = parseNumber(field(layout.time));
    if (!time || !std::isfinite(*time)) return fail("The time is no number", where, "Give times in seconds");
    picture.timeSecs = *time;
    picture.hasTime = true;
  }
  picture.cameraFromWorld = RigidTransform{rotationOf(layout, *angles), *position}.inverse();
  return picture;
}

/// The first line that is no remark; a header may stand behind #.
std::string_view headerOf(LineReader& lines) {
  std::string_view line;
  while (lines.next(line)) {
    const std::string_view words = trimmed(line);
    if (words.empty()) continue;
    if (!words.starts_with('#')) return words;
    const std::string lower = lowerCase(words);
    if (lower.find("omega") != std::string::npos || lower.find("yaw") != std::string::npos) return words;
  }
  return {};
}

}  // namespace

Result<CameraSet> parsePoseTable(std::string_view text, const std::string& path, const Progress& progress) {
  LineReader lines(text);
  const std::string_view header = headerOf(lines);
  const auto layout = layoutOf(header, placeInFile(path, lines.number()));
  if (!layout) return fail(layout.error());
  CameraSet set;
  ImportSlip twice;
  std::unordered_set<std::string> names;
  const auto read = forPoseRows(lines, path, progress, [&](std::string_view line, const std::string& where) -> Result<void> {
    auto pose = poseOf(line, *layout, where);
    if (!pose) return fail(pose.error());
    if (!pose->name.empty() && !names.insert(pose->name).second) twice.note(where);
    set.pictures.push_back(std::move(*pose));
    return {};
  });
  if (!read) return fail(read.error());
  if (set.pictures.empty()) return fail("The table holds no pose", path, kAdvice);
  twice.tell(set.warnings, twice.count == 1 ? "name comes twice" : "names come twice");
  if (layout->unitAssumed) set.warnings.push_back({"The header names no unit of the angles: degrees are assumed", path});
  set.details = fmt::format("Table of poses: {} with {}", set.pictures.size(), kindWords(layout->kind));
  return set;
}

ReaderDescription PoseTableReader::description() const { return {"pose-table", "Table of camera poses", {"csv", "txt"}}; }

int PoseTableReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder || (probe.extension != "csv" && probe.extension != "txt")) return 0;
  LineReader lines({reinterpret_cast<const char*>(probe.head.data()), probe.head.size()});
  const std::string lower = lowerCase(headerOf(lines));
  const auto has = [&](const char* word) { return lower.find(word) != std::string::npos; };
  return (has("omega") && has("phi") && has("kappa")) || (has("yaw") && has("pitch") && has("roll")) ? 85 : 0;
}

Result<CameraSet> PoseTableReader::inspect(const std::string& path) const { return read(path, Progress()); }

Result<CameraSet> PoseTableReader::read(const std::string& path, const Progress& progress) const {
  const auto text = readTextFile(path);
  if (!text) return fail(text.error());
  return parsePoseTable(*text, path, progress);
}

}  // namespace alidade

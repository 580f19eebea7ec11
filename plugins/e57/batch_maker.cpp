// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/batch_maker.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

namespace alidade {

namespace {

// No survey reaches past this; what does is damage.
constexpr double kLargestCoordinate = 1e12;

std::uint16_t to16(double value) {
  return value > 0 ? static_cast<std::uint16_t>(std::min(value, 65535.0) + 0.5) : std::uint16_t(0);
}

/// Calls `each(i, value)` for the values of a column, whole or real, as doubles.
template <class F>
void forValues(const FieldColumn& column, std::size_t count, F&& each) {
  if (!column.real.empty())
    for (std::size_t i = 0; i < count; ++i) each(i, column.real[i]);
  else
    for (std::size_t i = 0; i < count; ++i) each(i, static_cast<double>(column.whole[i]));
}

template <class T>
void fillWhole(const FieldColumn& column, std::size_t count, double add, std::vector<T>& out) {
  out.resize(count);
  const double most = static_cast<double>(std::numeric_limits<T>::max());
  forValues(column, count, [&](std::size_t i, double value) { out[i] = static_cast<T>(std::clamp(value + add, 0.0, most)); });
}

NumberType typeFor(const E57Field& field) {
  if (field.kind == E57Field::Kind::Single) return NumberType::F32;
  if (field.kind != E57Field::Kind::Integer) return NumberType::F64;
  const auto holds = [&](auto least, auto most) { return field.minimum >= least && field.maximum <= most; };
  if (holds(0, 255)) return NumberType::U8;
  if (holds(-128, 127)) return NumberType::I8;
  if (holds(0, 65535)) return NumberType::U16;
  if (holds(-32768, 32767)) return NumberType::I16;
  if (holds(0, std::int64_t(UINT32_MAX))) return NumberType::U32;
  if (holds(INT32_MIN, INT32_MAX)) return NumberType::I32;
  return NumberType::I64;
}

template <class T, class From>
void store(const std::vector<From>& values, std::size_t count, std::vector<std::byte>& out) {
  out.resize(count * sizeof(T));
  for (std::size_t i = 0; i < count; ++i) {
    const T value = static_cast<T>(values[i]);
    std::memcpy(out.data() + i * sizeof(T), &value, sizeof(T));
  }
}

ExtraColumn extraColumn(const E57Field& field, const FieldColumn& column, std::size_t count) {
  ExtraColumn extra{field.name, typeFor(field), 1, {}};
  switch (extra.type) {
    case NumberType::F32: store<float>(column.real, count, extra.data); break;
    case NumberType::F64: store<double>(column.real, count, extra.data); break;
    case NumberType::U8: store<std::uint8_t>(column.whole, count, extra.data); break;
    case NumberType::I8: store<std::int8_t>(column.whole, count, extra.data); break;
    case NumberType::U16: store<std::uint16_t>(column.whole, count, extra.data); break;
    case NumberType::I16: store<std::int16_t>(column.whole, count, extra.data); break;
    case NumberType::U32: store<std::uint32_t>(column.whole, count, extra.data); break;
    case NumberType::I32: store<std::int32_t>(column.whole, count, extra.data); break;
    default: store<std::int64_t>(column.whole, count, extra.data); break;
  }
  return extra;
}

template <class T>
void keepOnly(std::vector<T>& values, const std::vector<std::uint32_t>& kept) {
  if (values.empty()) return;
  for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
  values.resize(kept.size());
}

}  // namespace

BatchMaker::BatchMaker(const E57Scan& scan, std::uint16_t scanner, std::uint16_t rgbWhite)
    : m_scan(&scan), m_scanner(scanner), m_white(rgbWhite) {
  m_fieldOf.fill(-1);
}

Result<BatchMaker> BatchMaker::make(const E57Scan& scan, std::uint16_t scanner, std::uint16_t rgbWhite) {
  BatchMaker made(scan, scanner, rgbWhite);
  const auto take = [&](std::initializer_list<std::pair<Role, const char*>> fields) {
    // Triples are of use only whole.
    for (const auto& [role, name] : fields) {
      const int index = scan.fieldNamed(name);
      if (index < 0 || scan.fields[static_cast<std::size_t>(index)].kind == E57Field::Kind::String) return false;
    }
    for (const auto& [role, name] : fields) made.m_fieldOf[role] = scan.fieldNamed(name);
    return true;
  };
  if (take({{X, "cartesianX"}, {Y, "cartesianY"}, {Z, "cartesianZ"}})) {
    take({{Invalid, "cartesianInvalidState"}});
  } else if (take({{X, "sphericalRange"}, {Y, "sphericalAzimuth"}, {Z, "sphericalElevation"}})) {
    made.m_spherical = true;
    take({{Invalid, "sphericalInvalidState"}});
  } else if (scan.recordCount > 0) {
    return fail(fmt::format("The points of '{}' have neither cartesian nor spherical coordinates", scan.name), {},
                "Export the scan again with coordinates");
  }
  take({{Intensity, "intensity"}});
  take({{Red, "colorRed"}, {Green, "colorGreen"}, {Blue, "colorBlue"}});
  take({{Row, "rowIndex"}, {Column, "columnIndex"}});
  take({{ReturnIndex, "returnIndex"}});
  take({{ReturnCount, "returnCount"}});
  take({{Time, "timeStamp"}});
  take({{Nx, "nor:normalX"}, {Ny, "nor:normalY"}, {Nz, "nor:normalZ"}});
  take({{Class, "las:classification"}});
  take({{Source, "las:pointSourceId"}});
  for (std::size_t i = 0; i < scan.fields.size(); ++i) {
    const bool used = std::find(made.m_fieldOf.begin(), made.m_fieldOf.end(), static_cast<int>(i)) != made.m_fieldOf.end();
    const bool raw = made.has(Intensity) && made.m_fieldOf[Intensity] == static_cast<int>(i) && made.keepsRawIntensity();
    if ((!used || raw) && scan.fields[i].kind != E57Field::Kind::String) made.m_extra.push_back(static_cast<int>(i));
  }
  return made;
}

std::vector<std::string> BatchMaker::attributes() const {
  std::vector<std::string> names;
  const auto add = [&](Role role, const char* name) {
    if (has(role)) names.push_back(name);
  };
  add(Red, "rgb");
  add(Intensity, "intensity");
  add(Class, "classification");
  add(ReturnIndex, "return_number");
  add(ReturnCount, "return_count");
  add(Time, "gps_time");
  add(Nx, "normal");
  add(Source, "point_source");
  names.push_back("scanner");
  if (hasGrid()) names.insert(names.end(), {"row", "column"});
  for (const int extra : m_extra)
    if (extra != m_fieldOf[Intensity]) names.push_back(m_scan->fields[static_cast<std::size_t>(extra)].name);
  return names;
}

std::uint32_t BatchMaker::gridSize(bool rows) const {
  if (!hasGrid()) return 0;
  const auto& bounds = rows ? m_scan->rowBounds : m_scan->columnBounds;
  if (!bounds) return 0;
  const std::uint64_t size = static_cast<std::uint64_t>(bounds->second) - static_cast<std::uint64_t>(bounds->first) + 1;
  return size <= INT32_MAX ? static_cast<std::uint32_t>(size) : 0;
}

const E57Field* BatchMaker::cartesian(int axis) const {
  return m_spherical || !has(X) ? nullptr : &field(static_cast<Role>(X + axis));
}

E57Limits BatchMaker::intensityRange() const {
  if (m_scan->intensityLimits) return *m_scan->intensityLimits;
  const auto range = field(Intensity).range();
  return range ? E57Limits{range->first, range->second} : E57Limits{0, field(Intensity).isFloat() ? 1.0 : 65535.0};
}

bool BatchMaker::keepsRawIntensity() const {
  const E57Limits range = intensityRange();
  const bool as16Bits = field(Intensity).kind == E57Field::Kind::Integer && range.minimum == 0 && range.maximum == 65535 &&
                        field(Intensity).minimum >= 0 && field(Intensity).maximum <= 65535;
  return !as16Bits;
}

E57Limits BatchMaker::colourRange(int channel) const {
  if (m_scan->colourLimits[channel]) return *m_scan->colourLimits[channel];
  const E57Field& of = field(static_cast<Role>(Red + channel));
  const auto range = of.range();
  return range ? E57Limits{range->first, range->second} : E57Limits{0, of.isFloat() ? 1.0 : 255.0};
}

bool BatchMaker::hasDeepColour(const E57Scan& scan) {
  const auto maker = make(scan, 0, 255);
  if (!maker || !maker->has(Red)) return false;
  for (int channel = 0; channel < 3; ++channel) {
    const E57Limits range = maker->colourRange(channel);
    if (range.minimum != 0 || range.maximum != 255 || maker->field(static_cast<Role>(Red + channel)).kind != E57Field::Kind::Integer) return true;
  }
  return false;
}

std::size_t BatchMaker::dropInvalid(RecordColumns& columns, std::size_t count) {
  std::vector<std::uint8_t> bad(count, 0);
  std::uint64_t marked = 0, unusable = 0;
  if (has(Invalid))
    forValues(columns[static_cast<std::size_t>(m_fieldOf[Invalid])], count, [&](std::size_t i, double state) {
      if (state == 0) return;  // 1: a direction alone; 2: nothing
      bad[i] = 1;
      ++marked;
    });
  for (int axis = 0; axis < 3; ++axis)
    forValues(columns[static_cast<std::size_t>(m_fieldOf[axis])], count, [&](std::size_t i, double value) {
      if (std::abs(value) <= kLargestCoordinate || bad[i]) return;  // false for NaN
      bad[i] = 1;
      ++unusable;
    });
  m_withoutReturn += marked;
  m_unusable += unusable;
  if (marked + unusable == 0) return count;
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < count; ++i)
    if (!bad[i]) kept.push_back(static_cast<std::uint32_t>(i));
  for (FieldColumn& column : columns) {
    keepOnly(column.real, kept);
    keepOnly(column.whole, kept);
  }
  return kept.size();
}

void BatchMaker::fillPositions(const RecordColumns& columns, std::size_t count, PointBatch& batch) const {
  batch.position.resize(count);
  for (int axis = 0; axis < 3; ++axis)
    forValues(columns[static_cast<std::size_t>(m_fieldOf[axis])], count, [&](std::size_t i, double value) { batch.position[i][axis] = value; });
  if (m_spherical)
    for (glm::dvec3& p : batch.position) {
      const double range = p.x, azimuth = p.y, elevation = p.z;
      p = range * glm::dvec3(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    }
  // Coordinates of scans that did not move stay what the file gives them, bit for bit.
  if (!m_scan->hasPose || (m_scan->worldFromScanner.rotation == glm::dquat(1, 0, 0, 0) && m_scan->worldFromScanner.translation == glm::dvec3(0)))
    return;
  const glm::dmat3 rotation = m_scan->worldFromScanner.rotationMatrix();
  const glm::dvec3 translation = m_scan->worldFromScanner.translation;
  for (glm::dvec3& p : batch.position) p = rotation * p + translation;
}

void BatchMaker::fillColours(const RecordColumns& columns, std::size_t count, PointBatch& batch) const {
  batch.rgbWhite = m_white;
  batch.rgb.resize(count);
  for (int channel = 0; channel < 3; ++channel) {
    const E57Limits range = colourRange(channel);
    const double factor = m_white / (range.maximum - range.minimum), white = m_white;
    forValues(columns[static_cast<std::size_t>(m_fieldOf[Red + channel])], count, [&](std::size_t i, double value) {
      batch.rgb[i][channel] = to16(std::min((value - range.minimum) * factor, white));
    });
  }
}

void BatchMaker::fillNormals(const RecordColumns& columns, std::size_t count, PointBatch& batch) const {
  const glm::dmat3 rotation = m_scan->worldFromScanner.rotationMatrix();
  std::vector<glm::dvec3> local(count);
  for (int axis = 0; axis < 3; ++axis)
    forValues(columns[static_cast<std::size_t>(m_fieldOf[Nx + axis])], count, [&](std::size_t i, double value) { local[i][axis] = value; });
  batch.normal.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double length = glm::length(local[i]);
    batch.normal[i] = length > 0 && std::isfinite(length) ? glm::vec3(rotation * (local[i] / length)) : glm::vec3(0, 0, 1);
  }
}

void BatchMaker::fillExtra(const RecordColumns& columns, std::size_t count, PointBatch& batch) const {
  for (const int extra : m_extra) {
    const auto index = static_cast<std::size_t>(extra);
    batch.extra.push_back(extraColumn(m_scan->fields[index], columns[index], count));
  }
}

void BatchMaker::fill(RecordColumns& columns, std::size_t count, PointBatch& batch) {
  batch.clear();
  count = dropInvalid(columns, count);
  const auto of = [&](Role role) -> const FieldColumn& { return columns[static_cast<std::size_t>(m_fieldOf[role])]; };
  fillPositions(columns, count, batch);
  if (has(Red)) fillColours(columns, count, batch);
  if (has(Nx)) fillNormals(columns, count, batch);
  if (has(Intensity)) {
    const E57Limits range = intensityRange();
    const double factor = 65535.0 / (range.maximum - range.minimum);
    batch.intensity.resize(count);
    forValues(of(Intensity), count, [&](std::size_t i, double value) { batch.intensity[i] = to16((value - range.minimum) * factor); });
  }
  if (has(Class)) fillWhole(of(Class), count, 0, batch.classification);
  if (has(ReturnIndex)) fillWhole(of(ReturnIndex), count, 1, batch.returnNumber);  // the file counts from 0 …
  if (has(ReturnCount)) {
    fillWhole(of(ReturnCount), count, 0, batch.returnCount);
    // … or should: las2e57 counts from 1.
    for (std::size_t i = 0; i < batch.returnNumber.size(); ++i)
      if (batch.returnCount[i] > 0) batch.returnNumber[i] = std::min(batch.returnNumber[i], batch.returnCount[i]);
  }
  if (has(Source)) fillWhole(of(Source), count, 0, batch.pointSource);
  if (hasGrid()) {
    fillWhole(of(Row), count, m_scan->rowBounds ? -static_cast<double>(m_scan->rowBounds->first) : 0.0, batch.row);
    fillWhole(of(Column), count, m_scan->columnBounds ? -static_cast<double>(m_scan->columnBounds->first) : 0.0, batch.column);
  }
  if (has(Time)) {
    batch.gpsTime.resize(count);
    forValues(of(Time), count, [&](std::size_t i, double value) { batch.gpsTime[i] = value; });
  }
  batch.scanner.assign(count, m_scanner);
  fillExtra(columns, count, batch);
}

}  // namespace alidade

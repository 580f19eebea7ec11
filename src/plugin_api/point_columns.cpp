// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plugin_api/point_columns.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace alidade {

namespace {

// No survey reaches past this; what does is damage.
constexpr double kLargestCoordinate = 1e12;

template <class T>
T clamped(double value) {
  if (!(value > 0)) return 0;
  return value >= static_cast<double>(std::numeric_limits<T>::max()) ? std::numeric_limits<T>::max()
                                                                     : static_cast<T>(value);
}

bool isFloat(NumberType type) {
  return type == NumberType::F32 || type == NumberType::F64;
}

bool usable(double coordinate) {
  return std::abs(coordinate) <= kLargestCoordinate;  // false for NaN
}

}  // namespace

int PointColumns::roleOf(const std::string& lowerCaseName) {
  static const std::array<std::vector<const char*>, kRoles> kNames = {{
      {"x"}, {"y"}, {"z"},
      {"red", "r", "diffuse_red"}, {"green", "g", "diffuse_green"}, {"blue", "b", "diffuse_blue"}, {"rgb", "rgba"},
      {"intensity", "scalar_intensity", "reflectance", "scalar_reflectance"},
      {"classification", "scalar_classification", "class"},
      {"return_number", "returnnumber", "scalar_return_number"},
      {"gps_time", "gpstime", "scalar_gps_time", "scalar_gpstime"},
      {"nx", "normal_x", "normalx"}, {"ny", "normal_y", "normaly"}, {"nz", "normal_z", "normalz"},
      {"scanner", "point_source_id", "pointsourceid", "scalar_point_source_id"},
      {"row"}, {"column"},
  }};
  for (int role = 0; role < kRoles; ++role)
    for (const char* name : kNames[role])
      if (lowerCaseName == name) return role;
  return -1;
}

Result<PointColumns> PointColumns::make(const std::vector<Column>& columns) {
  PointColumns made;
  made.m_columnOf.fill(-1);
  std::string names;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::string name = columns[i].name;
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
    if (names.size() < 200) names += (names.empty() ? "" : ", ") + columns[i].name;
    const int role = roleOf(name);
    if (role < 0 || made.m_columnOf[role] >= 0) continue;
    made.m_columnOf[role] = static_cast<int>(i);
    made.m_typeOf[role] = columns[i].type;
  }
  if (!made.has(X) || !made.has(Y) || !made.has(Z))
    return fail("The points have no x, y and z; their columns are: " + (names.empty() ? "none" : names), {},
                "Export the file again with coordinates named x, y and z");
  return made;
}

bool PointColumns::ignores(std::size_t column) const {
  return std::find(m_columnOf.begin(), m_columnOf.end(), static_cast<int>(column)) == m_columnOf.end();
}

std::vector<std::string> PointColumns::attributes() const {
  std::vector<std::string> names;
  if (hasRgb()) names.push_back("rgb");
  if (has(Intensity)) names.push_back("intensity");
  if (has(Class)) names.push_back("classification");
  if (has(Return)) names.push_back("return_number");
  if (has(Time)) names.push_back("gps_time");
  if (has(Nx) && has(Ny) && has(Nz)) names.push_back("normal");
  if (has(Scanner)) names.push_back("scanner");
  if (has(Row) && has(Col)) names.insert(names.end(), {"row", "column"});
  return names;
}

void PointColumns::addRow(const double* values) {
  if (!usable(values[m_columnOf[X]]) || !usable(values[m_columnOf[Y]]) || !usable(values[m_columnOf[Z]])) {
    ++m_dropped;
    return;
  }
  for (int role = 0; role < kRoles; ++role)
    if (m_columnOf[role] >= 0) m_values[role].push_back(values[m_columnOf[role]]);
  ++m_rowCount;
}

double PointColumns::largest(Role role) const {
  double most = 0;
  for (const double value : m_values[role])
    if (value > most) most = value;
  return most;
}

void PointColumns::learnRanges() {
  m_learned = true;
  if (has(Red) && has(Green) && has(Blue)) {
    const double most = std::max({largest(Red), largest(Green), largest(Blue)});
    if (isFloat(m_typeOf[Red]) && most <= 1.0) m_colourFactor = 255.0;
    if (most > 255.0) m_colourFactor = 1.0 / 256.0;
  }
  if (has(Intensity)) {
    const double most = largest(Intensity);
    if (isFloat(m_typeOf[Intensity]) && most <= 1.0)
      m_intensityFactor = 65535.0;
    else if (most <= 255.0)
      m_intensityFactor = 257.0;
  }
}

void PointColumns::takeColours() {
  if (!hasRgb()) return;
  m_batch.rgb.resize(m_rowCount);
  for (std::size_t i = 0; i < m_rowCount; ++i) {
    if (has(Packed)) {
      const auto bits = clamped<std::uint32_t>(m_values[Packed][i]);
      m_batch.rgb[i] = {bits >> 16 & 255, bits >> 8 & 255, bits & 255};
    } else {
      const auto channel = [&](Role role) { return clamped<std::uint8_t>(m_values[role][i] * m_colourFactor + 1e-6); };
      m_batch.rgb[i] = {channel(Red), channel(Green), channel(Blue)};
    }
  }
}

void PointColumns::takeNormals() {
  if (!has(Nx) || !has(Ny) || !has(Nz)) return;
  m_batch.normal.resize(m_rowCount);
  for (std::size_t i = 0; i < m_rowCount; ++i) {
    const glm::dvec3 normal(m_values[Nx][i], m_values[Ny][i], m_values[Nz][i]);
    const double length = glm::length(normal);
    m_batch.normal[i] = length > 0 && std::isfinite(length) ? glm::vec3(normal / length) : glm::vec3(0, 0, 1);
  }
}

PointBatch& PointColumns::take() {
  if (!m_learned && m_rowCount > 0) learnRanges();
  m_batch.clear();
  m_batch.position.resize(m_rowCount);
  for (std::size_t i = 0; i < m_rowCount; ++i)
    m_batch.position[i] = {m_values[X][i], m_values[Y][i], m_values[Z][i]};
  takeColours();
  takeNormals();
  const auto copy = [&]<class T>(Role role, std::vector<T>& to, double factor) {
    if (!has(role)) return;
    to.resize(m_rowCount);
    for (std::size_t i = 0; i < m_rowCount; ++i) to[i] = clamped<T>(m_values[role][i] * factor);
  };
  copy(Intensity, m_batch.intensity, m_intensityFactor);
  copy(Class, m_batch.classification, 1);
  copy(Return, m_batch.returnNumber, 1);
  copy(Scanner, m_batch.scanner, 1);
  if (has(Row) && has(Col)) {
    copy(Row, m_batch.row, 1);
    copy(Col, m_batch.column, 1);
  }
  if (has(Time)) m_batch.gpsTime = m_values[Time];
  for (auto& values : m_values) values.clear();
  m_rowCount = 0;
  return m_batch;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "text-scan/text_layout.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr double kLargestCoordinate = 1e12;

const std::map<std::string, TextRole, std::less<>>& rolesByName() {
  using enum TextRole;
  static const std::map<std::string, TextRole, std::less<>> roles = {
      {"x", X}, {"e", X}, {"east", X}, {"easting", X}, {"y", Y}, {"n", Y}, {"north", Y}, {"northing", Y}, {"z", Z}, {"h", Z},
      {"height", Z}, {"elevation", Z}, {"i", Intensity}, {"intensity", Intensity}, {"scalar_intensity", Intensity},
      {"reflectance", Intensity}, {"scalar_reflectance", Intensity}, {"r", Red}, {"red", Red}, {"g", Green}, {"green", Green},
      {"b", Blue}, {"blue", Blue}, {"nx", Nx}, {"normal_x", Nx}, {"normalx", Nx}, {"ny", Ny}, {"normal_y", Ny}, {"normaly", Ny},
      {"nz", Nz}, {"normal_z", Nz}, {"normalz", Nz}, {"c", Class}, {"class", Class}, {"classification", Class},
      {"scalar_classification", Class}, {"return_number", Return}, {"returnnumber", Return}, {"scalar_return_number", Return},
      {"return_count", ReturnCount}, {"number_of_returns", ReturnCount}, {"scalar_number_of_returns", ReturnCount}, {"t", Time},
      {"time", Time}, {"gps_time", Time}, {"gpstime", Time}, {"scalar_gps_time", Time}, {"point_source_id", Source},
      {"scalar_point_source_id", Source}, {"-", Skip}, {"skip", Skip}};
  return roles;
}

bool all(const std::vector<std::vector<double>>& sample, std::size_t column, auto&& holds) {
  return std::all_of(sample.begin(), sample.end(), [&](const auto& row) { return column < row.size() && holds(row[column]); });
}

bool whole(double value) { return value == std::floor(value); }

bool threeWhole(const std::vector<std::vector<double>>& sample, std::size_t first, double most) {
  for (std::size_t k = 0; k < 3; ++k)
    if (!all(sample, first + k, [&](double v) { return v >= 0 && v <= most && whole(v); })) return false;
  return true;
}

bool unitNormals(const std::vector<std::vector<double>>& sample, std::size_t first) {
  return std::all_of(sample.begin(), sample.end(), [&](const auto& row) {
    return first + 2 < row.size() && std::abs(std::hypot(row[first], row[first + 1], row[first + 2]) - 1) < 0.02;
  });
}

bool colours(const std::vector<std::vector<double>>& sample, std::size_t first) {
  if (threeWhole(sample, first, 255) || threeWhole(sample, first, 65535)) return !unitNormals(sample, first) || sample.empty();
  if (unitNormals(sample, first)) return false;
  for (std::size_t k = 0; k < 3; ++k)
    if (!all(sample, first + k, [](double v) { return v >= 0 && v <= 1; })) return false;
  return true;
}

double largest(const std::vector<std::vector<double>>& sample, std::size_t column) {
  double most = 0;
  for (const auto& row : sample)
    if (column < row.size() && row[column] > most) most = row[column];
  return most;
}

template <class T>
void fill(const std::vector<double>* from, std::vector<T>& to) {
  if (!from) return;
  to.resize(from->size());
  const double most = static_cast<double>(std::numeric_limits<T>::max());
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = (*from)[i] > 0 ? static_cast<T>(std::min((*from)[i], most)) : T(0);
}

ExtraColumn extraOf(const std::string& name, const std::vector<double>& values) {
  ExtraColumn extra{name, NumberType::F64, 1, {}};
  extra.data.resize(values.size() * sizeof(double));
  if (!values.empty()) std::memcpy(extra.data.data(), values.data(), extra.data.size());
  return extra;
}

}  // namespace

int TextLayout::columnOf(TextRole role) const {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].role == role) return static_cast<int>(i);
  return -1;
}

std::vector<std::string> TextLayout::attributes() const {
  std::vector<std::string> names;
  const auto add = [&](TextRole role, const char* name) {
    if (has(role)) names.push_back(name);
  };
  using enum TextRole;
  if (has(Red) && has(Green) && has(Blue)) names.push_back("rgb");
  add(Intensity, "intensity");
  add(Class, "classification");
  add(Return, "return_number");
  add(ReturnCount, "return_count");
  add(Time, "gps_time");
  if (has(Nx) && has(Ny) && has(Nz)) names.push_back("normal");
  add(Source, "point_source");
  for (const TextColumn& column : columns)
    if (column.role == Extra) names.push_back(column.name);
  return names;
}

std::string TextLayout::words() const {
  static constexpr const char* kNames[] = {"x", "y", "z", "intensity", "red", "green", "blue", "normal x", "normal y", "normal z",
                                           "class", "return", "returns", "time", "source", "", "(left out)"};
  std::string words;
  for (const TextColumn& column : columns) {
    words += words.empty() ? "" : ", ";
    words += column.role == TextRole::Extra ? quotedWords(column.name) : std::string(kNames[static_cast<int>(column.role)]);
    if (column.role == TextRole::Intensity) words += fmt::format(" ({:g} to {:g})", intensityMin, intensityMax);
    if (column.role == TextRole::Blue) words += fmt::format(" (0 to {:g})", colourMax);
  }
  return words;
}

std::optional<std::vector<TextColumn>> columnsNamed(const std::vector<std::string_view>& words) {
  std::vector<TextColumn> columns;
  for (const std::string_view word : words) {
    std::string name = lowerCase(word);
    // "X [m]" and "Easting(m)": the unit is the survey's own.
    if (const auto open = name.find_first_of("[("); open != std::string::npos && open > 0) name = std::string(trimmed(name.substr(0, open)));
    const auto found = rolesByName().find(name);
    TextColumn column{found == rolesByName().end() ? TextRole::Extra : found->second, std::string(word)};
    const bool twice = column.role != TextRole::Skip && column.role != TextRole::Extra &&
                       std::any_of(columns.begin(), columns.end(), [&](const TextColumn& c) { return c.role == column.role; });
    if (twice) column.role = TextRole::Extra;
    columns.push_back(std::move(column));
  }
  TextLayout layout;
  layout.columns = columns;
  if (!layout.has(TextRole::X) || !layout.has(TextRole::Y) || !layout.has(TextRole::Z)) return std::nullopt;
  return columns;
}

std::vector<TextColumn> columnsGuessed(std::size_t columns, const std::vector<std::vector<double>>& sample) {
  using enum TextRole;
  std::vector<TextColumn> guessed = {{X, {}}, {Y, {}}, {Z, {}}};
  bool hasColour = false, hasNormal = false, hasIntensity = false;
  for (std::size_t at = 3; at < columns;) {
    const std::size_t left = columns - at;
    // PTS's own order, where an intensity among the colours could be taken for one of them.
    const bool intensityFirst = left >= 4 && !hasColour && !hasIntensity && colours(sample, at + 1);
    if (left >= 3 && !hasColour && !intensityFirst && colours(sample, at)) {
      for (const TextRole role : {Red, Green, Blue}) guessed.push_back({role, {}});
      hasColour = true;
      at += 3;
    } else if (left >= 3 && !hasNormal && !sample.empty() && unitNormals(sample, at)) {
      for (const TextRole role : {Nx, Ny, Nz}) guessed.push_back({role, {}});
      hasNormal = true;
      at += 3;
    } else if (!hasIntensity) {
      guessed.push_back({Intensity, {}});
      hasIntensity = true;
      ++at;
    } else {
      guessed.push_back({Extra, fmt::format("column {}", at + 1)});
      ++at;
    }
  }
  return guessed;
}

void learnRanges(TextLayout& layout, const std::vector<std::vector<double>>& sample) {
  if (layout.has(TextRole::Red) && layout.has(TextRole::Green) && layout.has(TextRole::Blue)) {
    double most = 0;
    bool fractions = false;
    for (const TextRole role : {TextRole::Red, TextRole::Green, TextRole::Blue}) {
      const auto column = static_cast<std::size_t>(layout.columnOf(role));
      most = std::max(most, largest(sample, column));
      fractions = fractions || !all(sample, column, [](double v) { return whole(v); });
    }
    layout.colourMax = most <= 1 && fractions ? 1 : most > 255 ? 65535 : 255;
  }
  if (const int column = layout.columnOf(TextRole::Intensity); column >= 0) {
    const auto at = static_cast<std::size_t>(column);
    double least = 0;
    for (const auto& row : sample)
      if (at < row.size()) least = std::min(least, row[at]);
    const double most = largest(sample, at);
    layout.intensityMin = 0;
    if (least < 0) {
      const bool pts = least >= -2048 && most <= 2047;  // Leica's convention
      layout.intensityMin = pts ? -2048 : least;
      layout.intensityMax = pts ? 2047 : std::max(most, least + 1);
    } else {
      layout.intensityMax = most <= 1 ? 1 : most <= 255 ? 255 : most <= 65535 ? 65535 : most;
    }
    layout.keepsIntensity = layout.intensityMin != 0 || layout.intensityMax != 65535 || !all(sample, at, [](double v) { return whole(v); });
  }
}

RowBatch::RowBatch(TextLayout layout) : m_layout(std::move(layout)), m_values(m_layout.columns.size()) {
  assert(m_layout.has(TextRole::X) && m_layout.has(TextRole::Y) && m_layout.has(TextRole::Z));
  m_x = static_cast<std::size_t>(m_layout.columnOf(TextRole::X));
  m_y = static_cast<std::size_t>(m_layout.columnOf(TextRole::Y));
  m_z = static_cast<std::size_t>(m_layout.columnOf(TextRole::Z));
}

void RowBatch::add(const double* row) {
  for (const std::size_t axis : {m_x, m_y, m_z})
    if (!(std::abs(row[axis]) <= kLargestCoordinate)) {
      ++m_dropped;
      return;
    }
  for (std::size_t i = 0; i < m_values.size(); ++i)
    if (m_layout.columns[i].role != TextRole::Skip) m_values[i].push_back(row[i]);
  ++m_size;
}

const std::vector<double>* RowBatch::column(TextRole role) const {
  const int at = m_layout.columnOf(role);
  return at < 0 ? nullptr : &m_values[static_cast<std::size_t>(at)];
}

void RowBatch::takeColours(PointBatch& batch) const {
  const std::vector<double>* channels[] = {column(TextRole::Red), column(TextRole::Green), column(TextRole::Blue)};
  if (!channels[0] || !channels[1] || !channels[2]) return;
  batch.rgbWhite = m_layout.colourMax > 255 ? 65535 : 255;
  batch.rgb.resize(m_size);
  const double factor = batch.rgbWhite / m_layout.colourMax, most = batch.rgbWhite;
  for (int k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < m_size; ++i) {
      const double value = (*channels[k])[i] * factor;
      batch.rgb[i][k] = value > 0 ? static_cast<std::uint16_t>(std::min(value, most) + 0.5) : std::uint16_t(0);
    }
}

void RowBatch::takeIntensity(PointBatch& batch) const {
  const std::vector<double>* raw = column(TextRole::Intensity);
  if (!raw) return;
  const double factor = 65535 / (m_layout.intensityMax - m_layout.intensityMin);
  batch.intensity.resize(m_size);
  for (std::size_t i = 0; i < m_size; ++i) {
    const double value = ((*raw)[i] - m_layout.intensityMin) * factor;
    batch.intensity[i] = value > 0 ? static_cast<std::uint16_t>(std::min(value, 65535.0) + 0.5) : std::uint16_t(0);
  }
  if (m_layout.keepsIntensity) batch.extra.push_back(extraOf("intensity", *raw));
}

void RowBatch::takeNormals(PointBatch& batch) const {
  const auto *x = column(TextRole::Nx), *y = column(TextRole::Ny), *z = column(TextRole::Nz);
  if (!x || !y || !z) return;
  batch.normal.resize(m_size);
  for (std::size_t i = 0; i < m_size; ++i) {
    const glm::dvec3 normal((*x)[i], (*y)[i], (*z)[i]);
    const double length = glm::length(normal);
    batch.normal[i] = length > 0 && std::isfinite(length) ? glm::vec3(normal / length) : glm::vec3(0, 0, 1);
  }
}

PointBatch RowBatch::take() {
  PointBatch batch;
  batch.position.resize(m_size);
  for (std::size_t i = 0; i < m_size; ++i) batch.position[i] = {m_values[m_x][i], m_values[m_y][i], m_values[m_z][i]};
  takeColours(batch);
  takeIntensity(batch);
  takeNormals(batch);
  fill(column(TextRole::Class), batch.classification);
  fill(column(TextRole::Return), batch.returnNumber);
  fill(column(TextRole::ReturnCount), batch.returnCount);
  fill(column(TextRole::Source), batch.pointSource);
  if (const auto* time = column(TextRole::Time)) batch.gpsTime = *time;
  for (std::size_t i = 0; i < m_values.size(); ++i) {
    if (m_layout.columns[i].role == TextRole::Extra) batch.extra.push_back(extraOf(m_layout.columns[i].name, m_values[i]));
    m_values[i].clear();
  }
  m_size = 0;
  return batch;
}

}  // namespace alidade

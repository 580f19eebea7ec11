// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/scanner_grid.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace alidade {

namespace {

/// A grid of so many cells a return and more is none.
constexpr std::uint64_t kCellsPerReturn = 16, kSpareCells = 4096;
constexpr float kFarthestMedian = 3000.0f;
/// A step in range of so many angular steps is a surface seen at less than one degree, or two surfaces.
constexpr float kSteepest = 60.0f;
/// Standard deviations that noise may explain.
constexpr float kSigmas = 4.0f;
constexpr std::size_t kSamples = 200'000;

float median(std::vector<float>& values, float otherwise) {
  if (values.empty()) return otherwise;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<ScannerGrid> ScannerGrid::from(const std::vector<GridReturn>& returns) {
  if (returns.size() < 4) return std::nullopt;
  std::uint32_t row0 = ~0u, row1 = 0, column0 = ~0u, column1 = 0;
  std::vector<float> ranges;
  const std::size_t every = returns.size() / kSamples + 1;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    row0 = std::min(row0, returns[i].row), row1 = std::max(row1, returns[i].row);
    column0 = std::min(column0, returns[i].column), column1 = std::max(column1, returns[i].column);
    if (i % every == 0) ranges.push_back(glm::length(returns[i].position));
  }
  const std::uint64_t rows = std::uint64_t{row1} - row0 + 1, columns = std::uint64_t{column1} - column0 + 1;
  const std::uint64_t most = kCellsPerReturn * returns.size() + kSpareCells;
  // Both below 2^33: the product cannot wrap once the quotient is known to be small.
  if (rows < 2 || columns < 2 || rows > most / columns || rows > 1u << 30 || columns > 1u << 30)
    return std::nullopt;
  if (!(median(ranges, 0.0f) < kFarthestMedian)) return std::nullopt;

  ScannerGrid grid;
  grid.m_rows = static_cast<int>(rows);
  grid.m_columns = static_cast<int>(columns);
  grid.m_position.assign(rows * columns, glm::vec3(0));
  grid.m_range.assign(rows * columns, 0.0f);
  for (const GridReturn& r : returns) {
    const float range = glm::length(r.position);
    if (!(range > 1e-3f && std::isfinite(range))) continue;
    const std::size_t i =
        grid.index(static_cast<int>(r.row - row0), static_cast<int>(r.column - column0));
    if (grid.m_range[i] > 0 && grid.m_range[i] <= range) continue;
    grid.m_range[i] = range;
    grid.m_position[i] = r.position;
  }
  grid.measureSteps();
  grid.close();
  grid.measureNoise();
  grid.join();
  return grid;
}

void ScannerGrid::measureSteps() {
  std::vector<float> down, across;
  const std::size_t every = m_range.size() / kSamples + 1;
  for (std::size_t i = 0; i < m_range.size(); i += every) {
    const int column = static_cast<int>(i / m_rows), row = static_cast<int>(i % m_rows);
    if (!has(row, column)) continue;
    if (has(row + 1, column)) down.push_back(glm::length(direction(row + 1, column) - direction(row, column)));
    if (has(row, column + 1))
      across.push_back(glm::length(direction(row, column + 1) - direction(row, column)));
  }
  m_stepDown = median(down, 1e-3f);
  m_stepAcross = median(across, m_stepDown);
}

void ScannerGrid::close() {
  std::vector<float> gap;
  for (int row = 0; row < m_rows; ++row) {
    if (!has(row, 0) || !has(row, m_columns - 1)) continue;
    const float inside = has(row, 1) ? glm::length(direction(row, 1) - direction(row, 0)) : m_stepAcross;
    gap.push_back(glm::length(direction(row, m_columns - 1) - direction(row, 0)) / std::max(inside, 1e-6f));
  }
  m_closed = m_columns > 3 && median(gap, 1e9f) < 1.75f;
}

void ScannerGrid::measureNoise() {
  // On a plane the inverse range is linear in small angles; what three in a row differ by is noise, on most
  // of what is scanned.
  std::vector<float> noise;
  const std::size_t every = m_range.size() / kSamples + 1;
  for (std::size_t i = 0; i < m_range.size(); i += every) {
    const int column = static_cast<int>(i / m_rows), row = static_cast<int>(i % m_rows);
    if (!has(row - 1, column) || !has(row, column) || !has(row + 1, column)) continue;
    const float r = rangeAt(row, column);
    const float bend = 1 / rangeAt(row - 1, column) - 2 / r + 1 / rangeAt(row + 1, column);
    noise.push_back(std::abs(bend) * r * r / (0.6745f * std::sqrt(6.0f)));
  }
  m_noise = std::clamp(median(noise, 0.002f), 0.0005f, 0.01f);
}

void ScannerGrid::join() {
  m_joins.assign(m_range.size(), 0);
  parallelFor(static_cast<std::size_t>(m_columns), 16, [&](std::size_t first, std::size_t last, int) {
    for (auto column = static_cast<int>(first); column < static_cast<int>(last); ++column) {
      for (int row = 0; row < m_rows; ++row) {
        if (range(row, column) <= 0) continue;
        std::uint8_t joins = 0;
        if (isJoined(row, column, 1, 0)) joins |= kDown;
        if (isJoined(row, column, 0, 1)) joins |= kAcross;
        m_joins[index(row, column)] = joins;
      }
    }
  });
}

bool ScannerGrid::isJoined(int row, int column, int down, int across) const {
  const int nextRow = row + down, nextColumn = column + across;
  if (!has(nextRow, nextColumn)) return false;
  const float a = rangeAt(row, column), b = rangeAt(nextRow, nextColumn);
  const float nearer = std::min(a, b), jump = std::abs(a - b);
  const float angle = glm::length(direction(nextRow, nextColumn) - direction(row, column));
  // A hole in the grid's directions: no neighbours.
  if (angle > 4 * std::max(m_stepDown, m_stepAcross)) return false;
  const float noise = kSigmas * noiseAt(nearer);
  if (jump <= noise + nearer * angle) return true;
  if (jump > kSteepest * nearer * angle) return false;
  const float wa = 1 / a, wb = 1 / b;
  // Twice one less the other: the noise of three returns.
  const float allowed = 2.45f * noise * wa * wb;
  const auto predicts = [&](int outerRow, int outerColumn, const glm::vec3& innerDirection, float inner,
                            float wanted) {
    if (!has(outerRow, outerColumn)) return false;
    const float outer = 1 / rangeAt(outerRow, outerColumn);
    const float gap = glm::length(direction(outerRow, outerColumn) - innerDirection);
    if (gap < 0.25f * angle || gap > 4 * angle) return false;
    return std::abs(inner + (inner - outer) * (angle / gap) - wanted) <= allowed;
  };
  return predicts(row - down, column - across, direction(row, column), wa, wb) ||
         predicts(nextRow + down, nextColumn + across, direction(nextRow, nextColumn), wb, wa);
}

glm::vec3 ScannerGrid::step(int row, int column, int down, int across) const {
  const bool after = has(row + down, column + across), before = has(row - down, column - across);
  const glm::vec3 here = direction(row, column);
  if (after && before)
    return 0.5f * (direction(row + down, column + across) - direction(row - down, column - across));
  if (after) return direction(row + down, column + across) - here;
  if (before) return here - direction(row - down, column - across);
  // Alone: the grid's usual step, along or across the vertical.
  const glm::vec3 level = glm::cross(glm::vec3(0, 0, 1), here);
  const float length = glm::length(level);
  const glm::vec3 east = length > 1e-4f ? level / length : glm::vec3(1, 0, 0);
  return down ? m_stepDown * glm::cross(here, east) : m_stepAcross * east;
}

}  // namespace alidade

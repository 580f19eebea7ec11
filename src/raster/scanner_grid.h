// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace alidade {

/// A return in a scanner's grid; metres from the scanner, world axes.
struct GridReturn {
  std::uint32_t row = 0, column = 0;
  glm::vec3 position{0};
};

/// The returns of one station in the order in which they were measured, and which neighbours lie on one
/// surface.
class ScannerGrid {
 public:
  /// Nothing where the returns fill too little of the grid to be one, or lie too far from the station to
  /// have been measured from there.
  static std::optional<ScannerGrid> from(const std::vector<GridReturn>& returns);

  int rows() const { return m_rows; }
  int columns() const { return m_columns; }
  /// Column 0 stands beside the last one: cells go all the way around.
  bool isClosed() const { return m_closed; }
  int cellColumns() const { return m_closed ? m_columns : m_columns - 1; }

  bool has(int row, int column) const { return contains(row, column) && range(row, wrapped(column)) > 0; }
  const glm::vec3& at(int row, int column) const { return m_position[index(row, wrapped(column))]; }
  float rangeAt(int row, int column) const { return range(row, wrapped(column)); }

  /// To the next row, to the next column.
  bool joinedDown(int row, int column) const { return has(row, column) && joins(row, column) & kDown; }
  bool joinedAcross(int row, int column) const { return has(row, column) && joins(row, column) & kAcross; }
  /// All four returns of cell (row, column) are there and joined.
  bool isFull(int row, int column) const {
    return joinedDown(row, column) && joinedDown(row, column + 1) && joinedAcross(row, column) &&
           joinedAcross(row + 1, column);
  }
  bool isEnclosed(int row, int column) const {
    return isFull(row - 1, column - 1) && isFull(row - 1, column) && isFull(row, column - 1) &&
           isFull(row, column);
  }

  /// What a step of a row or a column turns the ray by, as a vector for a ray of length 1.
  glm::vec3 stepDown(int row, int column) const { return step(row, column, 1, 0); }
  glm::vec3 stepAcross(int row, int column) const { return step(row, column, 0, 1); }

  /// One sigma along the ray at a distance, metres.
  float noiseAt(float rangeMeters) const { return std::max(m_noise, 0.0002f * rangeMeters); }

 private:
  static constexpr std::uint8_t kDown = 1, kAcross = 2;

  bool contains(int row, int column) const {
    return row >= 0 && row < m_rows && (m_closed || (column >= 0 && column < m_columns));
  }
  int wrapped(int column) const {
    return column < 0 ? column + m_columns : column >= m_columns ? column - m_columns : column;
  }
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(column) * m_rows + row;
  }
  float range(int row, int column) const { return m_range[index(row, column)]; }
  std::uint8_t joins(int row, int column) const { return m_joins[index(row, wrapped(column))]; }
  glm::vec3 direction(int row, int column) const { return at(row, column) / rangeAt(row, column); }

  void measureSteps();
  void measureNoise();
  void close();
  void join();
  bool isJoined(int row, int column, int down, int across) const;
  glm::vec3 step(int row, int column, int down, int across) const;

  int m_rows = 0, m_columns = 0;
  bool m_closed = false;
  float m_noise = 0.001f;
  float m_stepDown = 0, m_stepAcross = 0;  ///< median angles
  std::vector<glm::vec3> m_position;
  std::vector<float> m_range;  ///< 0 where nothing came back
  std::vector<std::uint8_t> m_joins;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "raster/triangle_kernel.h"

namespace alidade {

/// Which primitives touch which tile of a picture, each tile's in drawing order. Counted and filled in runs
/// of primitives, several at a time: a run's share of each tile's list is known before anything is written.
class TileBins {
 public:
  struct Tile {
    int left = 0, top = 0;
    const std::uint32_t* list = nullptr;
    std::uint32_t count = 0;
  };

  void reset(int width, int height) {
    m_columns = (width + kTileSize - 1) / kTileSize;
    m_rows = (height + kTileSize - 1) / kTileSize;
    m_start.assign(tileCount() + 1, 0);
    m_list.clear();
  }
  int columns() const { return m_columns; }
  int rows() const { return m_rows; }
  std::size_t tileCount() const { return static_cast<std::size_t>(m_columns) * m_rows; }
  Tile tile(std::size_t index) const {
    const int column = static_cast<int>(index) % m_columns, row = static_cast<int>(index) / m_columns;
    return {column * kTileSize, row * kTileSize, m_list.data() + m_start[index],
            m_start[index + 1] - m_start[index]};
  }

  /// `prepare(first, last)` makes a run's primitives ready, once; `box(i)` gives their pixels and
  /// `touches(i, left, top)` whether one reaches a tile of its box.
  template <class Prepare, class Box, class Touches>
  void fill(std::size_t count, const Prepare& prepare, const Box& box, const Touches& touches) {
    constexpr std::size_t run = 4096;
    const std::size_t runs = (count + run - 1) / run, tiles = tileCount();
    m_runs.resize(runs * tiles);
    const auto visit = [&](std::size_t i, const auto& put) {
      const auto& p = box(i);
      if (p.right < p.left || p.bottom < p.top) return;
      const int x0 = p.left / kTileSize, x1 = p.right / kTileSize, y0 = p.top / kTileSize,
                y1 = p.bottom / kTileSize;
      const bool isSmall = x0 == x1 && y0 == y1;
      for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x)
          if (isSmall || touches(i, x * kTileSize, y * kTileSize))
            put(static_cast<std::size_t>(y) * m_columns + x);
    };
    parallelFor(count, run, [&](std::size_t first, std::size_t last, int) {
      prepare(first, last);
      std::uint32_t* counts = m_runs.data() + first / run * tiles;
      std::fill_n(counts, tiles, 0u);
      for (std::size_t i = first; i < last; ++i) visit(i, [&](std::size_t tile) { ++counts[tile]; });
    });
    std::uint32_t total = 0;
    for (std::size_t tile = 0; tile < tiles; ++tile) {
      m_start[tile] = total;
      for (std::size_t r = 0; r < runs; ++r) {
        const std::uint32_t mine = m_runs[r * tiles + tile];
        m_runs[r * tiles + tile] = total;
        total += mine;
      }
    }
    m_start[tiles] = total;
    m_list.resize(total);
    parallelFor(count, run, [&](std::size_t first, std::size_t last, int) {
      std::uint32_t* next = m_runs.data() + first / run * tiles;
      for (std::size_t i = first; i < last; ++i)
        visit(i, [&](std::size_t tile) { m_list[next[tile]++] = static_cast<std::uint32_t>(i); });
    });
  }

 private:
  int m_columns = 0, m_rows = 0;
  std::vector<std::uint32_t> m_start, m_list, m_runs;
};

}  // namespace alidade

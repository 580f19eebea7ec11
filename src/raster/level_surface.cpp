// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/level_surface.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"

namespace alidade {

namespace {

constexpr std::size_t kRowsPerBand = 32;

}  // namespace

LevelSurface::LevelSurface(int columns, int rows, bool hasPayload)
    : columns(columns), inverse(columns + static_cast<int>(SurfaceCells::kMore), rows, Uncleared{}), hasCells(static_cast<std::size_t>(rows), 0) {
  if (hasPayload) payload = Image<std::uint32_t>(inverse.width(), rows, Uncleared{});
}

template <class Pixel>
void SurfaceRows<Pixel>::Row::fit(std::size_t columns, bool hasPayload) {
  m_inverse.assign(columns + 2 * kReach + SurfaceCells::kMore, 0.0f);
  if (hasPayload) m_payload.assign(m_inverse.size(), 0);
}

template <class Pixel>
void SurfaceRows<Pixel>::Row::clearBorders(std::size_t columns) {
  std::fill_n(m_inverse.data(), kReach, 0.0f);
  std::fill_n(m_inverse.data() + kReach + columns, kReach, 0.0f);
}

template <class Pixel>
SurfaceRows<Pixel>::SurfaceRows(const SplatPlanes<Pixel>& planes, const SplatLevels& levels, int level, bool closeHoles, SurfacePayload kind,
                                const LevelSurface* coarser, const LevelSurface* finer)
    : m_planes(planes), m_start(static_cast<std::size_t>(levels.start[level])), m_columns(static_cast<std::size_t>(levels.columns[level])),
      m_height(levels.rows[level]), m_margin(level == 0 ? 0 : SplatLevels::kMargin), m_closeHoles(closeHoles), m_kind(kind),
      m_coarser(coarser), m_finer(finer) {
  const bool hasPayload = kind != SurfacePayload::None;
  for (Row& row : m_rows) row.fit(m_columns, hasPayload);
  if (finer)
    for (Row& row : m_withFiner) row.fit(m_columns, hasPayload);
  m_closed.fit(m_columns, hasPayload);
  if (level > 0 && kind == SurfacePayload::Colour)
    for (Row& row : m_fallen) row.fit(m_columns, true);
}

/// Points lie anywhere in their cells, and the nearest of a cell on the near side of it: on a slope all would come out too near.
template <class Pixel>
void SurfaceRows<Pixel>::takeAtMiddles(int y, const SurfaceRow& row) {
  const auto fallen = [&](int number) -> Row& { return m_fallen[(number + 3) % 3]; };
  m_nextFallen = std::max(m_nextFallen, y - 1);
  for (; m_nextFallen <= y + 1; ++m_nextFallen) {
    const SurfaceRow to = fallen(m_nextFallen).row();
    if (m_nextFallen < 0 || m_nextFallen >= m_height) {
      std::fill_n(to.inverse, m_columns, 0.0f);
      continue;
    }
    takeNearest(m_planes, m_start + static_cast<std::size_t>(m_nextFallen) * m_columns, m_columns, [&](std::size_t first, std::size_t count, const Pixel* pixels) {
      if constexpr (sizeof(Pixel) == 8) {
        if (pixels == nullptr) {
          std::fill_n(to.inverse + first, count, 0.0f);
        } else {
          surfaceKernel().takePixels(pixels, count, {to.inverse + first, nullptr});
          surfaceKernel().takePlaces(pixels, count, to.payload + first);
        }
      }
    });
  }
  surfaceKernel().toMiddles({fallen(y - 1).cells(), fallen(y).cells(), fallen(y + 1).cells()}, m_columns, row.inverse);
}

/// Cell c of this level lies in the coarser one's cell c >> 1, its even half towards the cell before.
template <class Pixel>
void SurfaceRows<Pixel>::takeCoarser(int y, Row& row) {
  const int cell = y - m_margin, own = (cell >> 1) + SplatLevels::kMargin, across = (cell & 1) != 0 ? own + 1 : own - 1;
  if (m_coarser->hasCells[static_cast<std::size_t>(own)] == 0) return;
  row.hasCells = true;
  const auto inner = [&](int number) {  // the outermost cells have none beside them
    const SurfaceCells cells = m_coarser->cells(number);
    return SurfaceCells{cells.inverse + 1, cells.payload ? cells.payload + 1 : nullptr};
  };
  // The first inner one has this level's cells 2 (1 - kMargin) and the next: in the border of level 0, at the start of others.
  const int first = 2 * (1 - SplatLevels::kMargin) + m_margin;
  const SurfaceRow from{row.row().inverse + first, row.row().payload ? row.row().payload + first : nullptr};
  surfaceKernel().takeCoarser(inner(own), inner(across), m_kind == SurfacePayload::Colour, static_cast<std::size_t>(m_coarser->columns - 2), from);
}

template <class Pixel>
void SurfaceRows<Pixel>::join(int y) {
  Row& row = at(m_rows, y);
  const bool isInside = y >= 0 && y < m_height;
  const SurfaceKernel& kernel = surfaceKernel();
  const SurfaceRow to = row.row();
  row.hasCells = isInside && takeNearest(m_planes, m_start + static_cast<std::size_t>(y) * m_columns, m_columns, [&](std::size_t first, std::size_t count, const Pixel* pixels) {
    if (pixels == nullptr) {
      std::fill_n(to.inverse + first, count, 0.0f);
    } else if constexpr (sizeof(Pixel) == 8) {
      (m_kind == SurfacePayload::Colour ? kernel.takeColours : kernel.takePixels)(pixels, count, {to.inverse + first, to.payload ? to.payload + first : nullptr});
    } else {
      kernel.takeDepths(pixels, count, to.inverse + first);
    }
  });
  if (!isInside) std::fill_n(to.inverse, m_columns, 0.0f);
  if (row.hasCells && m_margin > 0 && m_kind == SurfacePayload::Colour) takeAtMiddles(y, to);
  if (m_coarser && isInside) takeCoarser(y, row);
  row.clearBorders(m_columns);
  if (!m_finer) return;
  Row& withFiner = at(m_withFiner, y);
  withFiner.hasCells = row.hasCells || (isInside && m_finer->hasCells[static_cast<std::size_t>(y)] != 0);
  if (withFiner.hasCells) kernel.takeNearer(row.cells(), m_finer->cells(y), m_columns, withFiner.row());
  else std::fill_n(withFiner.row().inverse, m_columns, 0.0f);
  withFiner.clearBorders(m_columns);
}

template <class Pixel>
SurfaceCells SurfaceRows<Pixel>::row(int y) {
  const int reach = m_closeHoles ? kReach : 0;
  if (m_next < 0) m_next = y - reach;
  for (; m_next <= y + reach; ++m_next) join(m_next);
  const SurfaceCells own = at(m_rows, y).cells();
  m_hasCells = at(m_rows, y).hasCells;
  if (!m_closeHoles) return own;
  Rows& rows = m_finer ? m_withFiner : m_rows;
  m_hasCells = std::ranges::any_of(rows, &Row::hasCells);
  if (!m_hasCells) return own;
  const auto cellsOf = [&](int number) { return at(rows, number).cells(); };
  surfaceKernel().closeHoles({cellsOf(y - 2), cellsOf(y - 1), cellsOf(y), cellsOf(y + 1), cellsOf(y + 2)}, own, m_columns, m_closed.row());
  return m_closed.cells();
}

namespace {

/// A level's cells with the nearest of the four finer ones in each; the outermost have none.
template <class Pixel>
LevelSurface pulledUp(const SplatPlanes<Pixel>& planes, const SplatLevels& levels, int level, SurfacePayload kind) {
  const int finer = level - 1, columns = levels.columns[level];
  // On either side: level 0 has no margin that would lie in this one's.
  const int bare = finer == 0 ? SplatLevels::kMargin : 1;
  LevelSurface surface(columns, levels.rows[level], kind != SurfacePayload::None);
  parallelFor(static_cast<std::size_t>(levels.rows[level]), kRowsPerBand, [&](std::size_t first, std::size_t last, int) {
    SurfaceRows<Pixel> rows(planes, levels, finer, false, kind, nullptr);
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      const SurfaceRow row = surface.row(y);
      std::fill_n(row.inverse, columns, 0.0f);
      for (int from = std::max(0, 2 * (y - bare)); from < std::min(2 * (y - bare) + 2, levels.rows[finer]); ++from) {
        const SurfaceCells cells = rows.row(from);
        if (!rows.hasCells()) continue;
        surface.hasCells[static_cast<std::size_t>(y)] = 1;
        surfaceKernel().pull(cells, static_cast<std::size_t>(columns - 2 * bare), {row.inverse + bare, row.payload ? row.payload + bare : nullptr});
      }
      std::fill_n(row.inverse + columns - bare, bare, 0.0f);
    }
  });
  return surface;
}

}  // namespace

template <class Pixel>
std::optional<LevelSurface> coarseSurface(const SplatPlanes<Pixel>& planes, const SplatLevels& levels, bool closeHoles, int firstPulled, SurfacePayload kind) {
  std::optional<LevelSurface> coarser;
  for (int level = levels.count - 1; level > 0; --level) {
    const auto columns = static_cast<std::size_t>(levels.columns[level]);
    std::optional<LevelSurface> finer;
    if (closeHoles && level >= firstPulled) finer = pulledUp(planes, levels, level, kind);
    LevelSurface surface(levels.columns[level], levels.rows[level], kind != SurfacePayload::None);
    parallelFor(static_cast<std::size_t>(levels.rows[level]), kRowsPerBand, [&](std::size_t first, std::size_t last, int) {
      SurfaceRows<Pixel> rows(planes, levels, level, closeHoles, kind, coarser ? &*coarser : nullptr, finer ? &*finer : nullptr);
      for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
        const SurfaceCells cells = rows.row(y);
        const SurfaceRow row = surface.row(y);
        std::copy_n(cells.inverse, columns, row.inverse);
        if (row.payload) std::copy_n(cells.payload, columns, row.payload);
        surface.hasCells[static_cast<std::size_t>(y)] = rows.hasCells();
      }
    });
    coarser = std::move(surface);
  }
  return coarser;
}

template class SurfaceRows<std::uint32_t>;
template class SurfaceRows<std::uint64_t>;
template std::optional<LevelSurface> coarseSurface(const SplatPlanes<std::uint32_t>&, const SplatLevels&, bool, int, SurfacePayload);
template std::optional<LevelSurface> coarseSurface(const SplatPlanes<std::uint64_t>&, const SplatLevels&, bool, int, SurfacePayload);

}  // namespace alidade

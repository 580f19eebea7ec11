// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/image.h"
#include "raster/splat_levels.h"
#include "raster/splat_merge.h"
#include "raster/surface_kernel.h"

namespace alidade {

// Surfaces of points that are wider apart than a pixel: coarse where they are coarse, smooth between them, fine where there are finer
// points. After the pull-push of Grossman and Dally (1998), "Point Sample Rendering", with points on the levels that their spacing
// asks for, and so without a guess what is a hole.

/// What of 64-bit pixels is taken beside their depth.
enum class SurfacePayload {
  None,    ///< nothing, as there is nothing in 32-bit pixels
  Colour,  ///< RGB565, in a surface 8-bit RGBA that is blended between a coarser level's cells
  Other,   ///< 32 bits that are not to be mixed
};

/// A level's cells, margins included.
struct LevelSurface {
  int columns = 0;               ///< the pictures are wider: room for what kernels read beyond a row
  Image<float> inverse;          ///< inverse depth, 1/m, which is linear on the screen along a plane; 0 where nothing is
  Image<std::uint32_t> payload;  ///< empty without one
  std::vector<std::uint8_t> hasCells;  ///< by row: 0 where there is nothing

  LevelSurface(int columns, int rows, bool hasPayload);
  SurfaceRow row(int y) { return {inverse.row(y), payload.empty() ? nullptr : payload.row(y)}; }
  SurfaceCells cells(int y) const { return {inverse.row(y), payload.empty() ? nullptr : payload.row(y)}; }
};

/// A level's cells, row by row: the nearest of the threads' planes, with colours moved along the surface from where its point fell to the
/// middle of its cell; where there is none, or one that lies behind, what the coarser
/// surface has there, linear between its cells. A point of the level is seen if it does not lie behind the farthest of the four coarser
/// cells around it: a surface shows its finer dots, and nothing shows through it, be it the other side of a wall. Then holes are closed, where asked, as
/// SurfaceKernel::closeHoles says; what reaches beyond two cells on any side stays open: edges, gaps between posts, the sky.
///
/// Pixel: 32 bits of depth, or 64 with a payload below. Rows may be asked for from any thread, each with an object of its own.
template <class Pixel>
class SurfaceRows {
 public:
  /// `level` of `levels` in the planes. `coarser`: the surface of the next level. `finer`: the points of the level below, pulled up
  /// here: where they are too few to close their own level's holes, they do it here. Both null for none; they must outlive this.
  SurfaceRows(const SplatPlanes<Pixel>& planes, const SplatLevels& levels, int level, bool closeHoles, SurfacePayload kind,
              const LevelSurface* coarser, const LevelSurface* finer = nullptr);

  /// Row y, which must be the one after the row before; valid until the next.
  SurfaceCells row(int y);
  /// Whether there may be anything in the row before that was asked for.
  bool hasCells() const { return m_hasCells; }

 private:
  static constexpr int kReach = 2, kRows = 2 * kReach + 1;  // what takeCoarser() writes before a row's first cell lies in its border
  class Row {
   public:
    void fit(std::size_t columns, bool hasPayload);
    SurfaceRow row() { return {m_inverse.data() + kReach, m_payload.empty() ? nullptr : m_payload.data() + kReach}; }
    SurfaceCells cells() const { return {m_inverse.data() + kReach, m_payload.empty() ? nullptr : m_payload.data() + kReach}; }
    /// Nothing beside the row's cells: kernels may have written there.
    void clearBorders(std::size_t columns);
    bool hasCells = false;

   private:
    std::vector<float> m_inverse;  ///< with a border of kReach cells of nothing
    std::vector<std::uint32_t> m_payload;
  };
  using Rows = Row[kRows];
  static Row& at(Rows& rows, int y) { return rows[(y + kRows) % kRows]; }
  void join(int y);
  void takeAtMiddles(int y, const SurfaceRow& row);
  void takeCoarser(int y, Row& row);

  const SplatPlanes<Pixel>& m_planes;
  std::size_t m_start, m_columns;
  int m_height, m_margin;
  bool m_closeHoles;
  SurfacePayload m_kind;
  const LevelSurface* m_coarser;
  const LevelSurface* m_finer;
  int m_next = -1;  ///< the row to join next; -1: none yet
  Rows m_rows, m_withFiner;
  Row m_closed;
  bool m_hasCells = false;
  /// Of a coarser level with colours: inverse depths where the points fell, and their places in their cells, of three rows.
  Row m_fallen[3];
  int m_nextFallen = -1;
};

/// The surface of level 1 with all above it; nothing if there is level 0 alone. Where holes are closed, points of the levels from
/// `firstPulled` - 1 on are pulled up for it. On all cores.
template <class Pixel>
std::optional<LevelSurface> coarseSurface(const SplatPlanes<Pixel>& planes, const SplatLevels& levels, bool closeHoles, int firstPulled, SurfacePayload kind);

extern template class SurfaceRows<std::uint32_t>;
extern template class SurfaceRows<std::uint64_t>;
extern template std::optional<LevelSurface> coarseSurface(const SplatPlanes<std::uint32_t>&, const SplatLevels&, bool, int, SurfacePayload);
extern template std::optional<LevelSurface> coarseSurface(const SplatPlanes<std::uint64_t>&, const SplatLevels&, bool, int, SurfacePayload);

}  // namespace alidade

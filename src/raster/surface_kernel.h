// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>

namespace alidade {

/// Cells of a surface side by side: inverse depth, 0 where nothing is, and a payload each, which means nothing there (see
/// raster/level_surface.h).
struct SurfaceCells {
  /// Kernels go some cells at a time: what they read or write has room for so many more.
  static constexpr std::size_t kMore = 40;
  const float* inverse;
  const std::uint32_t* payload;  ///< null with depth alone
};
struct SurfaceRow {
  float* inverse;
  std::uint32_t* payload;  ///< null with depth alone
};

/// What rows of surfaces are made with, in the registers of one instruction set. All give the same bits.
struct SurfaceKernel {
  /// Of pixels of depth alone, and of those with a payload below, which is taken as it is or as RGB565 in full bytes, opaque; r in the
  /// lowest, as Rgba8 lies in memory.
  void (*takeDepths)(const std::uint32_t* pixels, std::size_t count, float* inverse);
  void (*takePixels)(const std::uint64_t* pixels, std::size_t count, const SurfaceRow& row);
  void (*takeColours)(const std::uint64_t* pixels, std::size_t count, const SurfaceRow& row);

  /// Moves the inverse depths of the middle one of three rows from where their points fell, as PlaceInCell tells below pixels that
  /// were taken by takePlaces, to the middles of their cells: along the lesser of the slopes to the cells on either side.
  void (*takePlaces)(const std::uint64_t* pixels, std::size_t count, std::uint32_t* places);
  void (*toMiddles)(const SurfaceCells (&rows)[3], std::size_t count, float* inverse);

  /// Cell i takes the nearest of itself and of the finer cells 2i and 2i + 1.
  void (*pull)(const SurfaceCells& finer, std::size_t count, const SurfaceRow& row);
  void (*takeNearer)(const SurfaceCells& a, const SurfaceCells& b, std::size_t count, const SurfaceRow& row);

  /// A row of the next finer level takes the coarser surface where it has nothing, or something that lies behind the farthest of the four
  /// coarser cells about it by more than the scan's noise and their slope explain. Two cells of the row, from its first on, lie in each of `own`, in its half towards the row `across`. They
  /// take three quarters of the nearer cell and one of the farther along each axis, but for cells of another surface, which count
  /// as the cell itself; nothing at the corners of a staircase, where the three about a quarter have nothing and the cell
  /// opposite has something. Cells beside both ends are read. Payloads are blended byte by byte, or the cell's own.
  void (*takeCoarser)(const SurfaceCells& own, const SurfaceCells& across, bool blends, std::size_t count, const SurfaceRow& row);

  /// Closes the holes of `own`, the middle one of five rows, which are read two cells beyond both ends: where a cell has nothing, or
  /// something likewise behind, and nearer ones lie within two cells on each of its four sides. It takes the inverse depth between two that
  /// face each other, those that differ least, and the payload of the nearer to it; between two surfaces those of the farther
  /// one. The rows may have more than `own` has; what the middle one has more is taken only where it is so surrounded.
  void (*closeHoles)(const SurfaceCells (&rows)[5], const SurfaceCells& own, std::size_t count, const SurfaceRow& closed);
};

extern const SurfaceKernel kScalarSurfaceKernel;
#if defined(__x86_64__)
extern const SurfaceKernel kAvx2SurfaceKernel;
extern const SurfaceKernel kAvx512SurfaceKernel;
#endif

/// Of the same instruction set as splatKernel().
const SurfaceKernel& surfaceKernel();

}  // namespace alidade

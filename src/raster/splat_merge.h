// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "raster/splat_pass.h"

namespace alidade {

/// The threads' planes, row by row from the top: nearest wins. Where asked, holes are closed: a pixel without depth, or
/// whose depth lies behind, that has nearer ones within two pixels to the left, to the right, above and below was
/// missed by the points of the surface around it. It takes the depth between two that face each other, 1/z linear, and the
/// payload of one of them. What reaches beyond two pixels on any side stays open: edges, gaps between posts, the sky.
///
/// Pixel: 32 bits of depth, or 64 with a payload below. Rows may be asked for from any thread, each with an object of its own.
template <class Pixel>
class MergedRows {
 public:
  MergedRows(const SplatPlanes<Pixel>& planes, int width, int height, bool closeHoles);

  /// Row y, which must be the one after the row asked for before. All ones where nothing was drawn; valid until the next call.
  const Pixel* row(int y);

  /// Where holes are closed: raises each column's depth to that behind which nothing shows in row y, in the same order of rows.
  void addFarthest(int y, float* columns);

 private:
  static constexpr int kReach = 2, kRows = 2 * kReach + 1;
  struct Row {
    std::vector<Pixel> pixels;
    std::vector<float> depth;  ///< with a border of kReach pixels; +inf where nothing was drawn
  };
  Row& slot(int y) { return m_rows[static_cast<std::size_t>((y + kRows) % kRows)]; }
  const float* depthOf(int y) { return slot(y).depth.data() + kReach; }
  void join(int y);
  void joinAround(int y);
  void closeHoles(int y);
  void close(int y, int x);

  const SplatPlanes<Pixel>& m_planes;
  int m_width, m_height;
  bool m_closeHoles;
  int m_joined = -1;  ///< rows before it are; -1: none yet
  Row m_rows[kRows];
  std::vector<Pixel> m_closed;
  std::vector<std::uint8_t> m_isHole;
};

extern template class MergedRows<std::uint32_t>;
extern template class MergedRows<std::uint64_t>;

}  // namespace alidade

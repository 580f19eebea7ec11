// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "base/image.h"
#include "raster/splat_kernel.h"

namespace alidade {

/// A picture of dots on the way to a picture of surfaces, in inverse depth, where a plane in space
/// is linear on the screen.
struct DotImage {
  DotImage(int width, int height)
      : inverseDepth(width, height), spacingPx(width, height), place(width, height) {}

  Image<float> inverseDepth;   ///< 1/metres; 0 where nothing is known
  Image<float> spacingPx;      ///< pixels between neighbours on the dot's surface
  Image<std::uint16_t> place;  ///< where in its pixel the dot lies, as PlaceInPixel reads it
};

/// Blanks dots that shine through a nearer surface.
///
/// Each dot covers a cell of the pyramid level at which its surface has about four dots a cell
/// (log2 of its spacing in pixels, plus one). A cell is walled in by what is nearest in the eight cells
/// around: by as much as three of the four opposite pairs hold at both ends. A plane, however
/// steep, never walls itself in; only what lies behind such a wall is blanked (after the screen-space
/// hidden-point operators of Katz 2007 and Pintus 2011).
void removeHiddenDots(DotImage& dots);

/// Blanks dots behind a surface that its own dots show only together: the block of cells around a cell is
/// peeled, whatever lies behind the mean plane dropped again and again, until a tight plane is left.
void peelToFront(DotImage& dots);

/// Fills between dots from fine cells to coarse ones: a plane in inverse depth is fitted to the dots of 3×3
/// cells, or of a quarter of them where an edge spoils the whole; a pixel is filled where the fit
/// is tight and dots lie around it. Cells coarser than the dots' own spacing asks for fill nothing: a
/// hole in a dense surface stays a hole. What is left near edges is filled by the surfaces of its block one
/// by one, nearest first, where a surface's own dots lie in every quadrant about the pixel and the nearest of
/// all dots is the surface's. Dots are moved from where they lie in their pixels to the centre along the
/// plane; where a fit is as tight as the scan's noise, its plane takes the place of the dots.
void fillBetweenDots(DotImage& dots);

}  // namespace alidade

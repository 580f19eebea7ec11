// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>

#include "raster/triangle_kernel.h"

namespace alidade {

/// In ScreenTriangle::mark beside the key's six bits: somewhere on the triangle a highlight can be seen.
inline constexpr int kShines = 64;

/// Look of an element as the painting kernels read it; colours 0 to 255.
struct PaintStyle {
  float colour[3];
  float opacity;
  std::uint32_t selected, edgesAlone;
  float rank;  ///< see element_shape.h
  std::uint32_t unused = 0;
};
static_assert(sizeof(PaintStyle) == 32);

/// All that the CPU device's painting is made of: the twin of resources/shaders/overlay_frame.glsl and of the
/// pictures that pass from one shader to the next. Pixels are RGBA bytes in a word, red lowest. What is read
/// by index has 16 bytes to spare at its end.
struct PaintFrame {
  int width, height;
  const std::uint32_t* image;  ///< null: none
  int imageWidth, imageHeight;
  bool imageFits;  ///< image and result agree in size
  bool grayImage, grayDesign;
  const float* scanDepth;       ///< null: nothing hides; not >= 0: unknown
  float tolerance;              ///< metres
  int hiddenStyle;              ///< HiddenStyle
  const std::uint32_t* points;  ///< null: pass off
  float light[3];               ///< the way it travels, camera axes
  float specular, shininess;
  bool drawsFaces, drawsEdges, hasHiddenLayer;
  float edgeHalfWidth, casingHalfWidth, scale;  ///< pixels; lines.xyz of the shaders
  float edgeSlack, pixelsAtOneMetre;
  const PaintStyle* styles;
  const ScreenTriangle* triangles;

  // The front layer: written by `resolve`, read with its neighbours by the others.
  std::uint32_t* faceColour;  ///< alpha: opacity
  std::uint8_t* key;          ///< as keyOf() in overlay_frame.glsl
  std::uint32_t* element;     ///< 0 where none
  float* faceDepth;           ///< infinite where none
  std::uint8_t* state;
  // The hidden layer.
  std::uint32_t* hiddenElement;
  float* hiddenDepth;

  std::uint32_t* colour;  ///< the picture
};

/// Which elements the hidden layer of a tile shows: a bit for each remainder. A bit that is not set proves
/// that the element is not there.
struct HiddenSet {
  static constexpr int kBits = 2048, kWords = kBits / 64;
};

/// An edge on the screen, from its start along (ux, uy).
struct alignas(64) ScreenEdge {
  float x, y, ux, uy, length;  ///< pixels
  float w0, dw;                ///< inverse depth at the start and its slope a pixel
  float q0, dq;                ///< metres along, times inverse depth
  float rank;
  std::uint32_t element, mark;
  std::int16_t left = 0, right = -1, top = 0, bottom = -1;
};
static_assert(sizeof(ScreenEdge) == 64);

/// One thread's edges of a tile: rows of kTileSize, kTilePixels and 16 pixels more. `cover` is how much line
/// and casing cover where seen, then where hidden, a byte each.
struct EdgeTile {
  std::uint32_t* cover = nullptr;
  std::uint32_t* element = nullptr;
  float* depth = nullptr;
};

/// A pixel that an edge without faces takes for its element. Written last, when no neighbour asks any more.
struct EdgePixel {
  std::uint32_t pixel, element;
  float depth;
  std::uint8_t state;
};

enum class EdgeLayer { Front, Behind };

struct PaintKernel {
  /// Colours, elements, depths and keys of a tile's front layer; `second` is made ready where not null.
  void (*resolve)(const PaintFrame& frame, const VisibilityTile& tile, std::uint32_t* secondOwner,
                  float* secondKey);
  /// Elements and depths of its hidden layer.
  void (*resolveSecond)(const PaintFrame& frame, const SecondLayerTile& tile, std::uint64_t* shown);
  /// `shown`: what the hidden layer shows in this tile and those around it.
  void (*drawEdges)(const PaintFrame& frame, const ScreenEdge* edges, const std::uint32_t* list,
                    std::uint32_t count, EdgeLayer layer, const std::uint64_t* shown, int left, int top,
                    const EdgeTile& tile);
  /// The picture's pixels; returns how many were added to `taken` (room for a tile). `tile` may lack its
  /// arrays.
  std::uint32_t (*compose)(const PaintFrame& frame, int left, int top, const EdgeTile& tile,
                           EdgePixel* taken);
};

extern const PaintKernel kScalarPaintKernel;
#if defined(__x86_64__)
extern const PaintKernel kAvx2PaintKernel;
extern const PaintKernel kAvx512PaintKernel;
#endif

}  // namespace alidade

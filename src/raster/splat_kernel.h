// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>

#include "camera/lens_kernel.h"
#include "raster/reciprocal.h"
#include "raster/splat_levels.h"

namespace alidade {

/// What a run of points of one node is drawn with. Floats, relative to the eye: the sums that lose
/// digits were done in double when this was filled.
struct SplatView {
  float m[9];  ///< row by row: camera axes from node steps, metres a step
  float t[3];  ///< the node's origin in the camera's frame, metres
  Lens<float> lens;
  float fx, fy, cx, cy;
  float foldBackSquared;
  /// A lens need not fold back at one radius all around. Runs that reach beyond surelyInsideSquared ask
  /// inDomain(camera, x, y) for each point out there; the others do not pay for it.
  bool checkDomain;
  float surelyInsideSquared;
  const void* camera;
  bool (*inDomain)(const void* camera, float x, float y);
  int width, height;
  /// Footprint in pixels: clamp(sizeTimesDepth / z - sizeLess, smallest, largest).
  float sizeTimesDepth, sizeLess, smallest, largest;
  /// Four floats a cell as CellNormals has them, with its cells' first step and size; null: footprints face
  /// the eye.
  const float* cellNormals;
  std::int32_t cellLow[3], cellShift;
  bool onePixel;  ///< every footprint is one pixel
  /// Where points fall into cells as wide as sizeTimesDepth / z pixels or wider by less than an octave; null: they are footprints.
  const SplatLevels* levels;
  bool round;
  Reciprocal reciprocal;
  float twoOverR, overRSquared;          ///< of MultiplyAdd
  float pixelsPerRadius, pictureRadius;  ///< what decides for it, see splat_pass.cpp
};

/// What is kept beside the depth in a 64-bit pixel.
enum class SplatPayload {
  None,    ///< 32-bit pixels: depth alone
  Index,   ///< payloadBase + the point's place in the run
  Colour,  ///< the point's RGB565; above it, in coarser levels, PlaceInCell
  Place,   ///< payloadBase + where in the pixel the point fell, as PlaceInPixel reads it
};

/// Pixels from a pixel's centre to the point that SplatPayload::Place tells of: 6 bits each of u and v.
struct PlaceInPixel {
  static constexpr std::uint32_t kBits = 12;
  float u, v;
  explicit PlaceInPixel(std::uint32_t payload)
      : u((static_cast<float>(payload >> 6 & 63) - 31.5f) / 64.0f),
        v((static_cast<float>(payload & 63) - 31.5f) / 64.0f) {}
};

/// One thread's pixels, width × height, or all levels'. Depth is a positive float's bits, which order
/// as unsigned integers do; in 64-bit pixels it stands above the payload, so that the nearest wins
/// and equal depths are settled by the payload, whatever the order of drawing.
struct SplatTarget {
  std::uint32_t* depth = nullptr;   ///< payload None
  std::uint64_t* packed = nullptr;  ///< the others
  std::uint8_t* touched = nullptr;  ///< by SplatPlane's pieces, set where anything is drawn
  SplatPayload payload = SplatPayload::None;
  std::uint32_t payloadBase = 0;
};

struct SplatKernel {
  const char* name;
  /// `points` are DisplayPoints: x, y, z, rgb565, 16 bits each.
  void (*draw)(const SplatView& view, const std::uint16_t* points, std::uint32_t count,
               const SplatTarget& target);
};

extern const SplatKernel kScalarSplatKernel;
#if defined(__x86_64__)
extern const SplatKernel kAvx2SplatKernel;
extern const SplatKernel kAvx512SplatKernel;
#endif

/// The fastest that this processor runs, or the one that ALIDADE_SIMD names.
const SplatKernel& splatKernel();

}  // namespace alidade

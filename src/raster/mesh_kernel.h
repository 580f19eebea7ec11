// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>

#include "camera/lens_kernel.h"
#include "raster/occluder_mesh.h"

namespace alidade {

/// What packs of quads are drawn with; floats relative to the eye.
struct MeshView {
  float m[9];  ///< row by row: camera axes from the pack's
  float t[3];  ///< the pack's origin in the camera's frame, metres
  Lens<float> lens;
  float fx, fy, cx, cy;
  float insideSquared;  ///< within this radius the lens maps one to one
  int width, height;
  float nearest;      ///< metres: what lies before this plane is cut
  float largestPart;  ///< pixels: what is larger on screen must be cut into parts, else the lens would sag
};

/// One thread's pixels: inverse depth, 0 where nothing is. Rows of `stride` floats, at least
/// kMeshRowSlack more than the width.
inline constexpr int kMeshRowSlack = 16;
struct MeshTarget {
  float* inverseDepth = nullptr;
  int stride = 0;
};

struct MeshKernel {
  /// Draws what can be drawn as it is; writes the places of the other quads, pack * 16 + lane, to `left`
  /// (room for all) and returns how many. A pixel is covered where its centre lies in the quad; inverse
  /// depth is linear over the quad on the screen.
  std::uint32_t (*draw)(const MeshView& view, const OccluderPack* packs, std::uint32_t count,
                        const MeshTarget& target, std::uint32_t* left);
};

extern const MeshKernel kScalarMeshKernel;
#if defined(__x86_64__)
extern const MeshKernel kAvx2MeshKernel;
extern const MeshKernel kAvx512MeshKernel;
#endif

/// Of the same instruction set as splatKernel().
const MeshKernel& meshKernel();

}  // namespace alidade

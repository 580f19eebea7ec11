// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/progress.h"

namespace alidade {

struct DemoOptions {
  std::uint64_t points = 4'000'000;  ///< of the scan, over all stations
  int frames = 45;                   ///< of the video, at 15 Hz
  std::uint32_t seed = 1;
  int width = 1280, height = 960;                          ///< of the video
  bool colour = true;                                      ///< false: a grayscale camera
  glm::dvec3 siteOrigin{2'683'500.0, 1'247'800.0, 412.0};  ///< Swiss LV95-like; world metres
  bool truth = true;                                       ///< write truth/ beside it
  double clockOffsetSecs = 0;  ///< of the trajectory's clock: pose clock minus picture clock
  double readoutSecs = 0;      ///< of a rolling shutter; a frame's time is that of its middle row

  Result<void> validate() const;
};

/// What was written, absolute paths.
struct DemoSite {
  std::string scan;              ///< LAS 1.4 with scanner, row and column as extra bytes
  std::string images;            ///< folder of PNG frames
  std::string cameras;           ///< COLMAP text model folder (poses and lens)
  std::string design;            ///< IFC4
  std::string designMesh;        ///< OBJ of the same
  std::string stakePoints;       ///< CSV
  std::string controlPoints;     ///< CSV
  std::string truth;             ///< folder; see writeDemoSite
  std::string stations;          ///< JSON: worldFromScanner and grid of each scanner station
  std::string perturbedCameras;  ///< COLMAP text model with poses off by about 2 cm and 0.2 degrees
  std::string trajectory;        ///< TUM: the exact poses at 60 Hz, on a clock of their own (DemoOptions::clockOffsetSecs)
  std::string calibration;       ///< OpenCV YAML: the lens
  std::string observations;      ///< CSV: control points in frame 0, with 0.3 px noise
  std::uint64_t pointCount = 0;
  int frameCount = 0;
};

/// Makes a half-built site from a seed: ground, slab, columns, walls with openings, scaffold poles,
/// material heaps; a terrestrial scan from several stations with noise, shadows and uneven density; a
/// posed video through a distorting lens; the design as it should be; stake and control points; and
/// known defects (a shifted column, a tilted wall, a missing opening). The same options give the same
/// bytes. Streams: memory does not grow with `points`.
///
/// truth/ holds truth.json (exact poses, defects with their amounts, lens), and a frame's exact
/// depth.NNNN.f32 (row-major float metres, +inf for sky), designdepth.NNNN.f32 and
/// visibility.NNNN.u8 (0 no design, 1 visible, 2 hidden).
Result<DemoSite> writeDemoSite(const std::string& folder, const DemoOptions& options,
                               const Progress& progress);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "simulate/demo_site.h"
#include "simulate/frame_renderer.h"
#include "simulate/point_lists.h"
#include "simulate/scanner.h"
#include "simulate/site_model.h"

namespace alidade {

/// Everything that truth.json tells.
struct DemoTruth {
  const SiteModel* site = nullptr;
  const DemoOptions* options = nullptr;
  ScannerModel scanner;
  ScanSummary scan;
  Intrinsics intrinsics;
  std::vector<RigidTransform> cameraFromWorld;
  std::vector<SeenControlPoint> controlInFirstFrame;
  int truthEvery = 1;  ///< depth is kept of every n-th frame
};

/// Poses of the stations as JSON, beside the scan.
Result<void> writeStations(const std::string& path, const ScanSummary& scan);

Result<void> writeTruth(const std::string& path, const DemoTruth& truth);

/// depth.NNNN.f32, designdepth.NNNN.f32 and visibility.NNNN.u8 into `folder`.
Result<void> writeFrameTruth(const std::string& folder, int frame, const FrameTruth& truth);

}  // namespace alidade

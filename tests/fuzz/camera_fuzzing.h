// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "plugin_api/reader.h"

namespace alidade::testing {

/// Holds what a camera reader hands over to its promises: cameras that are valid, indices that lead
/// somewhere, numbers that are finite, a message with every failure; a broken one aborts.
inline void checkCameraSet(const Result<CameraSet>& set, std::size_t inputSize) {
  if (!set) {
    if (set.error().what.empty()) std::abort();
    return;
  }
  for (const Intrinsics& camera : set->cameras)
    if (!camera.validate()) std::abort();
  for (const PosedPicture& picture : set->pictures) {
    if (picture.camera < -1 || picture.camera >= static_cast<int>(set->cameras.size())) std::abort();
    if (picture.cameraFromWorld && !picture.cameraFromWorld->isFinite()) std::abort();
    if (!std::isfinite(picture.timeSecs)) std::abort();
  }
  for (const TiePoint& point : set->tiePoints) {
    for (int a = 0; a < 3; ++a)
      if (!std::isfinite(point.world[a])) std::abort();
    for (const auto& [picture, pixel] : point.seenIn) {
      if (picture < 0 || picture >= static_cast<int>(set->pictures.size())) std::abort();
      if (!std::isfinite(pixel.x) || !std::isfinite(pixel.y)) std::abort();
    }
  }
  // Nothing takes less than two characters, and no slip brings more than a warning or two.
  if (set->cameras.size() + set->pictures.size() + set->tiePoints.size() > inputSize) std::abort();
  if (set->warnings.size() > 2 * inputSize + 8) std::abort();
}

}  // namespace alidade::testing

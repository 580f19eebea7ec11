// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "base/image.h"

namespace alidade {

struct ImageComparison {
  bool same = false;
  double differing = 0;  ///< fraction of pixels that differ by more than `perChannel` in some channel
  std::string report;    ///< says what differs and where picture and difference were saved
};

struct ImageTolerance {
  int perChannel = 12;      ///< of 255: drivers round and rasterise edges differently
  double fraction = 0.004;  ///< of the pixels
};

/// Holds a picture to the baseline of that name. Where they differ, the picture and the difference (bright
/// where it is large) are saved in the build folder. ALIDADE_UPDATE_BASELINES=1 writes the baseline.
ImageComparison compareToBaseline(const ColourImage& picture, const std::string& name,
                                  const ImageTolerance& tolerance = {});

}  // namespace alidade

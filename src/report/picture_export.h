// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <map>
#include <string>

#include "base/error.h"
#include "base/image.h"

namespace alidade {

/// What the title block under an exported picture says; the same goes into the PNG's text chunks.
struct TitleBlock {
  std::string project;
  std::string frame;
  std::string time;         ///< "14.27 s"
  std::string camera;       ///< "FC6310R, OPENCV, 5472 × 3648"
  std::string poseSource;   ///< "Refined, 3 mm at 10 m"
  std::string hidden;       ///< "Hidden parts: ghost; 62 % visible, 30 % hidden, 8 % unknown"
  std::string coordinates;  ///< CRS and camera position
  std::string software;     ///< "Alidade 0.1.0"
  double metresPerPixelAtCentre = 0;  ///< for the scale bar; 0: the bar has no meaning
  double scaleDepthM = 0;             ///< the depth the bar holds for
};

/// The picture with the title block below it, as it will be saved. Needs a QGuiApplication for text.
ColourImage withTitleBlock(const ColourImage& picture, const TitleBlock& title);

/// The title block as PNG text chunks ("Alidade:frame" …).
std::map<std::string, std::string> titleText(const TitleBlock& title);

}  // namespace alidade

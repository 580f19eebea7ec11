// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Inside overlay/ only: where the marks over the picture stand. Shared by the painter and the hit test.

#pragma once

#include <optional>

#include <QFont>
#include <QRectF>
#include <QStringList>

#include "overlay/frame_description.h"
#include "raster/occlusion.h"

namespace alidade {

/// Pixels of the raw picture to pixels of the result, centres at whole numbers in both.
glm::dvec2 resultFromRaw(const FrameDescription& frame, const Camera& scaledCamera, const glm::dvec2& rawPx);
/// The factor for lengths.
double resultPerRaw(const FrameDescription& frame, const Camera& scaledCamera);

/// A text in lines of readable length and the room it takes.
struct TextBlock {
  QStringList lines;
  QSizeF size;  ///< pixels, with `padding` on all sides
  double padding = 0;
};

/// True where texts can be measured and drawn: fonts need a QGuiApplication.
bool hasFonts();
QFont overlayFont(double scale, bool bold = false);
TextBlock layOutText(const std::string& text, const QFont& font);

struct AnnotationLayout {
  glm::dvec2 tip{0};   ///< what it points at
  glm::dvec2 tail{0};  ///< where the text or the arrow's end is
  double depth = 0;    ///< metres; 0 for one tied to the picture
  TextBlock text;
  QRectF box;  ///< of the text; empty where there is none
};

/// Nothing where the annotation cannot be seen: behind the camera, beyond the lens, or its tip farther
/// out of the picture than the text could reach back.
std::optional<AnnotationLayout> layOutAnnotation(const Annotation& annotation, const FrameDescription& frame,
                                                 const Camera& scaledCamera);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "overlay/frame_description.h"

namespace alidade {

class TextSprites;

/// Draws stake points (symbol, tolerance circle, label), annotations, residual vectors over the
/// finished picture, in this order, hidden ones as HiddenStyle asks. Needs a QGuiApplication for text.
void paintAnnotations(OverlayPicture& picture, const FrameDescription& frame, const Camera& scaledCamera, TextSprites& texts);

/// The annotation whose text or arrow is under a pixel of the result; none: id 0.
AnnotationId annotationAt(const FrameDescription& frame, const Camera& scaledCamera, const glm::dvec2& pixel);

}  // namespace alidade

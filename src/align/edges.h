// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>

#include "base/image.h"

namespace alidade {

/// Edges of scanned surfaces, 0..255: steps in depth and, weaker, folds. What counts is how far 1/z bends over two pixels
/// to either side, relative to the nearest: nothing on a plane, however it is seen. `known` becomes 1 where all of the
/// surroundings have a depth; where `unknownIsFar`, everywhere: what has none lies far behind.
Image<float> depthEdges(const DepthImage& depth, bool unknownIsFar, Image<std::uint8_t>& known);

/// Edges of a photo, 0..255: the gradient of its brightness against the mean gradient, so that exposure and contrast do not
/// count.
Image<float> photoEdges(const Image<float>& luma);

}  // namespace alidade

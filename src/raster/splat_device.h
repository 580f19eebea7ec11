// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <span>

#include "base/error.h"
#include "raster/splat_kernel.h"

namespace alidade {

struct SplatRun;

/// Something else than this processor that draws points: a graphics card. Not thread-safe.
class SplatDevice {
 public:
  virtual ~SplatDevice() = default;

  /// Draws the runs, whose views are of one camera and need no domain check, into the pixels of all levels as
  /// SplatTarget has them: depths of 32 bits for SplatPayload::None, 64-bit pixels for Index and Colour.
  /// Divides whatever reciprocal is asked for. The pixels stay valid until the next call.
  virtual Result<const void*> draw(std::span<const SplatRun* const> runs, const SplatLevels& levels, SplatPayload payload) = 0;
};

}  // namespace alidade

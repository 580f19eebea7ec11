// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>

#include "base/error.h"
#include "gpu/gpu_device.h"
#include "raster/splat_device.h"

namespace alidade {

/// Points in compute shaders: the twin of raster's splat kernels. Points go up anew with every frame, in
/// batches. Pixels are 64-bit atomics; without them (`wide` false) depth and payload take a pass each and the
/// picture is the same.
Result<std::unique_ptr<SplatDevice>> createVulkanSplatter(const std::shared_ptr<GpuDevice>& device,
                                                          bool wide);

}  // namespace alidade

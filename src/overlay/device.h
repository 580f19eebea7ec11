// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <string>

#include "base/error.h"
#include "overlay/draw_list.h"
#include "raster/splat_device.h"

namespace alidade {

/// Turns a draw list into pictures. Two devices exist, one picture comes out: nothing above this
/// interface knows which one runs. Not thread-safe; one frame at a time.
class OverlayDevice {
 public:
  struct Output {
    ColourImage colour;
    DepthImage designDepth;
    IdImage element;
    Image<std::uint8_t> state;
    /// The element of the hidden layer, see OverlayPicture; empty where there is no such layer.
    IdImage hiddenElement;
  };
  virtual ~OverlayDevice() = default;
  virtual std::string name() const = 0;  ///< "Vulkan: llvmpipe (LLVM 15)"
  virtual Result<Output> draw(const DrawList& list) = 0;
  /// What draws the scans' points better than the processor; null where nothing does.
  virtual SplatDevice* splatDevice() { return nullptr; }
};

/// A visibility buffer on the processor: every thread, the widest vectors it has (ALIDADE_SIMD=scalar|avx2
/// holds it back). Needs no driver.
std::unique_ptr<OverlayDevice> createCpuDevice();

/// Vulkan 1.3, off screen. Error where no Vulkan driver is installed or it lacks what is needed. A driver
/// that runs on the processor, as lavapipe does, counts unless `gpuAlone`.
Result<std::unique_ptr<OverlayDevice>> createVulkanDevice(bool gpuAlone = false);

/// Vulkan where there is a GPU, else the processor. ALIDADE_DEVICE=cpu|vulkan decides; error where it names
/// something else, or a Vulkan that is not there.
Result<std::unique_ptr<OverlayDevice>> createOverlayDevice();

}  // namespace alidade

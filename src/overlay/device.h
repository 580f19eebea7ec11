// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <string>

#include "base/error.h"
#include "overlay/draw_list.h"

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
};

/// Vulkan 1.3, off screen. Error where no Vulkan driver is installed or it lacks what is needed.
Result<std::unique_ptr<OverlayDevice>> createVulkanDevice();

}  // namespace alidade

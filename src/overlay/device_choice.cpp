// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdlib>
#include <string>

#include "base/log.h"
#include "overlay/device.h"

namespace alidade {

Result<std::unique_ptr<OverlayDevice>> createOverlayDevice() {
  const char* value = std::getenv("ALIDADE_DEVICE");
  const std::string forced = value ? value : "";
  if (forced == "vulkan") return createVulkanDevice();
  if (!forced.empty() && forced != "cpu")
    return fail("There is no device \"" + forced + "\" to draw with", "ALIDADE_DEVICE",
                "Set it to cpu or vulkan, or unset it");
  if (forced.empty()) {
    auto gpu = createVulkanDevice(true);
    if (gpu) return gpu;
    log(LogLevel::Info, "Drawing on the processor: " + gpu.error().text());
  }
  return createCpuDevice();
}

}  // namespace alidade

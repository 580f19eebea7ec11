// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdlib>
#include <memory>

#include <gtest/gtest.h>

#include "gpu/gpu_device.h"

namespace alidade {

/// Tests draw with validation on, and on lavapipe unless the environment asks for another device.
inline void useTestDevice() {
  setenv("ALIDADE_VULKAN_VALIDATION", "1", 0);
  setenv("ALIDADE_VULKAN_DEVICE", "llvmpipe", 0);
}

}  // namespace alidade

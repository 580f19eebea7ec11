// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Vulkan's functions, found in libvulkan.so.1 when they are first called. Without it VkResults are errors,
// so that GpuDevice::create() fails as it does where no driver is installed.

#include <type_traits>

#include <dlfcn.h>

#include <vulkan/vulkan.h>

namespace {

void* vulkanFunction(const char* name) {
  // Never closed: drivers leave threads behind.
  static void* const library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  return library ? dlsym(library, name) : nullptr;
}

template <class R>
R withoutVulkan() {
  if constexpr (std::is_same_v<R, VkResult>)
    return VK_ERROR_INCOMPATIBLE_DRIVER;
  else
    return R();
}

}  // namespace

// Hidden, so that the loader and its drivers find their own and not these.
#define ALIDADE_FORWARD(Result, name, parameters, arguments)                            \
  extern "C" [[gnu::visibility("hidden")]] VKAPI_ATTR Result VKAPI_CALL name parameters { \
    static const auto call = reinterpret_cast<PFN_##name>(vulkanFunction(#name));       \
    return call ? call arguments : withoutVulkan<Result>();                             \
  }
#include "vulkan_functions.inc"

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "gpu/gpu_device.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "base/log.h"
#include "gpu/vulkan_core.h"

namespace alidade {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

const char* resultName(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "VK_ERROR_OUT_OF_HOST_MEMORY";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "VK_ERROR_OUT_OF_DEVICE_MEMORY";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "VK_ERROR_INITIALIZATION_FAILED";
    case VK_ERROR_DEVICE_LOST:
      return "VK_ERROR_DEVICE_LOST";
    case VK_ERROR_MEMORY_MAP_FAILED:
      return "VK_ERROR_MEMORY_MAP_FAILED";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "VK_ERROR_LAYER_NOT_PRESENT";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "VK_ERROR_EXTENSION_NOT_PRESENT";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "VK_ERROR_FEATURE_NOT_PRESENT";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "VK_ERROR_INCOMPATIBLE_DRIVER";
    case VK_TIMEOUT:
      return "VK_TIMEOUT";
    default:
      return nullptr;
  }
}

const char* adviceFor(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "Choose a smaller picture or show fewer elements";
    case VK_ERROR_DEVICE_LOST:
      return "Restart the program; if it returns, set ALIDADE_VULKAN_DEVICE=llvmpipe";
    default:
      return "Install a Vulkan 1.3 driver; mesa-vulkan-drivers draws without a GPU";
  }
}

bool environmentSays(const char* name) {
  const char* value = std::getenv(name);
  return value && *value && std::strcmp(value, "0") != 0;
}

VKAPI_ATTR VkBool32 VKAPI_CALL onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                         VkDebugUtilsMessageTypeFlagsEXT,
                                         const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  static_cast<VulkanRoot*>(user)->messages.fetch_add(1);
  const bool isError = severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  log(isError ? LogLevel::Error : LogLevel::Warning, data->pMessage ? data->pMessage : "Vulkan validation");
  return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messengerInfo(VulkanRoot& root) {
  auto info =
      stamped<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  info.messageType =
      VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  info.pfnUserCallback = onMessage;
  info.pUserData = &root;
  return info;
}

bool hasValidationLayer() {
  std::uint32_t count = 0;
  if (vkEnumerateInstanceLayerProperties(&count, nullptr) != VK_SUCCESS) return false;
  std::vector<VkLayerProperties> layers(count);
  if (vkEnumerateInstanceLayerProperties(&count, layers.data()) != VK_SUCCESS) return false;
  return std::any_of(layers.begin(), layers.end(),
                     [](const auto& layer) { return std::strcmp(layer.layerName, kValidationLayer) == 0; });
}

Result<void> makeInstance(VulkanRoot& root, bool validated) {
  auto application = stamped<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "Alidade";
  application.apiVersion = VK_API_VERSION_1_3;
  const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  const VkDebugUtilsMessengerCreateInfoEXT messenger = messengerInfo(root);
  auto info = stamped<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;
  if (validated) {
    info.pNext = &messenger;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = &extension;
  }
  if (const VkResult result = vkCreateInstance(&info, nullptr, &root.instance); result != VK_SUCCESS)
    return vulkanFailure("vkCreateInstance", result);
  if (!validated) return {};
  const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(root.instance, "vkCreateDebugUtilsMessengerEXT"));
  if (!create)
    return fail("The validation layer has no messenger", kValidationLayer, "Unset ALIDADE_VULKAN_VALIDATION");
  if (const VkResult result = create(root.instance, &messenger, nullptr, &root.messenger);
      result != VK_SUCCESS)
    return vulkanFailure("vkCreateDebugUtilsMessengerEXT", result);
  return {};
}

struct Candidate {
  VkPhysicalDevice device = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
  std::uint32_t queueFamily = 0;
  std::string missing;  ///< empty: fit for use
};

int rankOf(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return 3;
    default:
      return 4;
  }
}

Candidate examine(VkPhysicalDevice device) {
  Candidate candidate{device, {}, 0, {}};
  vkGetPhysicalDeviceProperties(device, &candidate.properties);
  if (candidate.properties.apiVersion < VK_API_VERSION_1_3) {
    candidate.missing = "Vulkan 1.3";
    return candidate;
  }
  auto features13 =
      stamped<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  auto features = stamped<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
  features.pNext = &features13;
  vkGetPhysicalDeviceFeatures2(device, &features);
  if (!features13.dynamicRendering || !features13.synchronization2) candidate.missing = "dynamic rendering";
  if (!features.features.independentBlend) candidate.missing = "independent blending";
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  const auto drawsAndComputes = [](const VkQueueFamilyProperties& f) {
    return (f.queueFlags & VK_QUEUE_GRAPHICS_BIT) && (f.queueFlags & VK_QUEUE_COMPUTE_BIT);
  };
  const auto family = std::find_if(families.begin(), families.end(), drawsAndComputes);
  if (family == families.end())
    candidate.missing = "a graphics queue";
  else
    candidate.queueFamily = static_cast<std::uint32_t>(family - families.begin());
  return candidate;
}

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// By number in the loader's order, or by a part of the name, case ignored.
bool isWanted(const std::string& wanted, std::size_t index, const char* name) {
  if (wanted.empty() || wanted == std::to_string(index)) return true;
  return lowered(name).find(lowered(wanted)) != std::string::npos;
}

Result<Candidate> pickDevice(VkInstance instance) {
  std::uint32_t count = 0;
  VkResult result = vkEnumeratePhysicalDevices(instance, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  if (result == VK_SUCCESS) result = vkEnumeratePhysicalDevices(instance, &count, devices.data());
  if (result != VK_SUCCESS) return vulkanFailure("vkEnumeratePhysicalDevices", result);
  const char* value = std::getenv("ALIDADE_VULKAN_DEVICE");
  const std::string wanted = value ? value : "";
  std::optional<Candidate> best;
  std::string found;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const Candidate candidate = examine(devices[i]);
    const std::string lack = candidate.missing.empty() ? "" : " (lacks " + candidate.missing + ")";
    found += (found.empty() ? "" : ", ") + std::to_string(i) + ": " + candidate.properties.deviceName + lack;
    if (!candidate.missing.empty() || !isWanted(wanted, i, candidate.properties.deviceName)) continue;
    if (!best || rankOf(candidate.properties.deviceType) < rankOf(best->properties.deviceType))
      best = candidate;
  }
  if (best) return *best;
  if (devices.empty())
    return fail("No Vulkan driver is installed", {}, "Install one; mesa-vulkan-drivers draws without a GPU");
  if (!wanted.empty())
    return fail("No usable Vulkan device matches \"" + wanted + "\"", found,
                "Change or unset ALIDADE_VULKAN_DEVICE");
  return fail("No Vulkan device can draw the overlay", found,
              "Update the driver, or install mesa-vulkan-drivers");
}

bool offersAtomics64(VkPhysicalDevice device) {
  auto features12 =
      stamped<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  auto features = stamped<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
  features.pNext = &features12;
  vkGetPhysicalDeviceFeatures2(device, &features);
  return features.features.shaderInt64 && features12.shaderBufferInt64Atomics;
}

Result<void> makeDevice(GpuDevice::Core& core) {
  const float priority = 1;
  auto queue = stamped<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueFamilyIndex = core.queueFamily;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto features13 =
      stamped<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  features13.dynamicRendering = VK_TRUE;
  features13.synchronization2 = VK_TRUE;
  features13.maintenance4 = VK_TRUE;  // glslc writes LocalSizeId; every 1.3 device has it
  auto features12 =
      stamped<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  core.atomics64 = offersAtomics64(core.physical);
  features12.shaderBufferInt64Atomics = core.atomics64;
  features13.pNext = &features12;
  auto features = stamped<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
  features.pNext = &features13;
  features.features.independentBlend = VK_TRUE;
  features.features.shaderInt64 = core.atomics64;
  auto info = stamped<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.pNext = &features;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  if (const VkResult result = vkCreateDevice(core.physical, &info, nullptr, &core.root.device);
      result != VK_SUCCESS)
    return vulkanFailure("vkCreateDevice", result);
  vkGetDeviceQueue(core.root.device, core.queueFamily, 0, &core.queue);
  return {};
}

Result<SamplerHandle> makeSampler(VkDevice device, VkFilter filter) {
  auto info = stamped<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
  info.magFilter = info.minFilter = filter;
  info.addressModeU = info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  return makeHandle<SamplerHandle>("vkCreateSampler", vkCreateSampler, device, info);
}

Result<void> makeQueueObjects(GpuDevice::Core& core) {
  const VkDevice device = core.root.device;
  auto nearest = makeSampler(device, VK_FILTER_NEAREST);
  if (!nearest) return fail(nearest.error());
  auto linear = makeSampler(device, VK_FILTER_LINEAR);
  if (!linear) return fail(linear.error());
  auto poolInfo = stamped<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  poolInfo.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  poolInfo.queueFamilyIndex = core.queueFamily;
  auto pool = makeHandle<CommandPoolHandle>("vkCreateCommandPool", vkCreateCommandPool, device, poolInfo);
  if (!pool) return fail(pool.error());
  const auto fenceInfo = stamped<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  auto fence = makeHandle<FenceHandle>("vkCreateFence", vkCreateFence, device, fenceInfo);
  if (!fence) return fail(fence.error());
  core.nearestSampler = std::move(*nearest);
  core.linearSampler = std::move(*linear);
  core.commandPool = std::move(*pool);
  core.fence = std::move(*fence);
  auto allocate = stamped<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  allocate.commandPool = core.commandPool.get();
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  if (const VkResult result = vkAllocateCommandBuffers(device, &allocate, &core.commandBuffer);
      result != VK_SUCCESS)
    return vulkanFailure("vkAllocateCommandBuffers", result);
  return {};
}

}  // namespace

tl::unexpected<Error> vulkanFailure(const char* call, VkResult result) {
  const char* name = resultName(result);
  return fail("The graphics driver failed", std::string(call) + ": " + (name ? name : std::to_string(result)),
              adviceFor(result));
}

VulkanRoot::~VulkanRoot() {
  if (device) vkDestroyDevice(device, nullptr);
  if (messenger) {
    const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance, "vkDestroyDebugUtilsMessengerEXT"));
    if (destroy) destroy(instance, messenger, nullptr);
  }
  if (instance) vkDestroyInstance(instance, nullptr);
}

GpuDevice::GpuDevice(std::shared_ptr<Core> core) : m_core(std::move(core)) {}
GpuDevice::~GpuDevice() = default;

Result<std::shared_ptr<GpuDevice>> GpuDevice::create() {
  auto core = std::make_shared<Core>();
  core->validated = environmentSays("ALIDADE_VULKAN_VALIDATION");
  if (core->validated && !hasValidationLayer()) {
    logWarning(
        "Vulkan validation is asked for, but its layer is not installed (package vulkan-validationlayers)");
    core->validated = false;
  }
  if (auto made = makeInstance(core->root, core->validated); !made) return fail(made.error());
  auto picked = pickDevice(core->root.instance);
  if (!picked) return fail(picked.error());
  core->physical = picked->device;
  core->properties = picked->properties;
  core->queueFamily = picked->queueFamily;
  core->name = picked->properties.deviceName;
  vkGetPhysicalDeviceMemoryProperties(core->physical, &core->memory);
  if (auto made = makeDevice(*core); !made) return fail(made.error());
  if (auto made = makeQueueObjects(*core); !made) return fail(made.error());
  return std::shared_ptr<GpuDevice>(new GpuDevice(std::move(core)));
}

const std::string& GpuDevice::name() const {
  return m_core->name;
}
bool GpuDevice::isSoftware() const {
  return m_core->properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
}
bool GpuDevice::isValidated() const {
  return m_core->validated;
}
int GpuDevice::validationMessageCount() const {
  return m_core->root.messages.load();
}
int GpuDevice::maximumImageSize() const {
  return static_cast<int>(std::min<std::uint32_t>(m_core->properties.limits.maxImageDimension2D, 32768));
}
bool GpuDevice::hasAtomics64() const {
  return m_core->atomics64;
}
std::size_t GpuDevice::maximumStorageSize() const {
  return m_core->properties.limits.maxStorageBufferRange;
}

Result<void> GpuDevice::run(const std::function<void(GpuCommands&)>& record) {
  const VkCommandBuffer buffer = m_core->commandBuffer;
  auto begin = stamped<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  if (const VkResult result = vkBeginCommandBuffer(buffer, &begin); result != VK_SUCCESS)
    return vulkanFailure("vkBeginCommandBuffer", result);
  GpuCommands::State state{buffer};
  GpuCommands commands(state);
  record(commands);
  if (const VkResult result = vkEndCommandBuffer(buffer); result != VK_SUCCESS)
    return vulkanFailure("vkEndCommandBuffer", result);
  auto submitted = stamped<VkCommandBufferSubmitInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO);
  submitted.commandBuffer = buffer;
  auto submit = stamped<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &submitted;
  const VkFence fence = m_core->fence.get();
  if (const VkResult result = vkQueueSubmit2(m_core->queue, 1, &submit, fence); result != VK_SUCCESS)
    return vulkanFailure("vkQueueSubmit2", result);
  if (const VkResult result = vkWaitForFences(m_core->root.device, 1, &fence, VK_TRUE, UINT64_MAX);
      result != VK_SUCCESS)
    return vulkanFailure("vkWaitForFences", result);
  if (const VkResult result = vkResetFences(m_core->root.device, 1, &fence); result != VK_SUCCESS)
    return vulkanFailure("vkResetFences", result);
  return {};
}

}  // namespace alidade

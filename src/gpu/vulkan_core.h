// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Inside gpu/ only: what the public handles stand on.

#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <vulkan/vulkan.h>

#include "base/error.h"
#include "gpu/gpu_device.h"

namespace alidade {

/// A Vulkan structure, all zero but for its type.
template <class T>
T stamped(VkStructureType type) {
  T structure{};
  structure.sType = type;
  return structure;
}

/// An owned handle made from a VkDevice and destroyed with `Destroy(device, handle, nullptr)`.
template <class T, auto Destroy>
class DeviceHandle {
 public:
  DeviceHandle() = default;
  DeviceHandle(VkDevice device, T handle) : m_device(device), m_handle(handle) {}
  DeviceHandle(DeviceHandle&& other) noexcept
      : m_device(other.m_device), m_handle(std::exchange(other.m_handle, VK_NULL_HANDLE)) {}
  DeviceHandle& operator=(DeviceHandle&& other) noexcept {
    std::swap(m_device, other.m_device);
    std::swap(m_handle, other.m_handle);
    return *this;
  }
  ~DeviceHandle() {
    if (m_handle != VK_NULL_HANDLE) Destroy(m_device, m_handle, nullptr);
  }
  T get() const { return m_handle; }
  explicit operator bool() const { return m_handle != VK_NULL_HANDLE; }

 private:
  VkDevice m_device = VK_NULL_HANDLE;
  T m_handle = VK_NULL_HANDLE;
};

using BufferHandle = DeviceHandle<VkBuffer, vkDestroyBuffer>;
using ImageHandle = DeviceHandle<VkImage, vkDestroyImage>;
using ImageViewHandle = DeviceHandle<VkImageView, vkDestroyImageView>;
using MemoryHandle = DeviceHandle<VkDeviceMemory, vkFreeMemory>;
using SamplerHandle = DeviceHandle<VkSampler, vkDestroySampler>;
using ShaderHandle = DeviceHandle<VkShaderModule, vkDestroyShaderModule>;
using SetLayoutHandle = DeviceHandle<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout>;
using PipelineLayoutHandle = DeviceHandle<VkPipelineLayout, vkDestroyPipelineLayout>;
using PipelineHandle = DeviceHandle<VkPipeline, vkDestroyPipeline>;
using DescriptorPoolHandle = DeviceHandle<VkDescriptorPool, vkDestroyDescriptorPool>;
using CommandPoolHandle = DeviceHandle<VkCommandPool, vkDestroyCommandPool>;
using FenceHandle = DeviceHandle<VkFence, vkDestroyFence>;

/// "vkCreateImage: VK_ERROR_OUT_OF_DEVICE_MEMORY" with advice that fits the code.
tl::unexpected<Error> vulkanFailure(const char* call, VkResult result);

/// Makes a handle with a vkCreate… call; the call's failure is the error.
template <class Handle, class Vk, class CreateInfo>
Result<Handle> makeHandle(const char* call,
                          VkResult (*create)(VkDevice, const CreateInfo*, const VkAllocationCallbacks*, Vk*),
                          VkDevice device, const CreateInfo& info) {
  Vk handle = VK_NULL_HANDLE;
  if (const VkResult result = create(device, &info, nullptr, &handle); result != VK_SUCCESS)
    return vulkanFailure(call, result);
  return Handle(device, handle);
}

/// Instance, messenger and device; freed in the reverse order by the destructor.
struct VulkanRoot {
  VkInstance instance = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  std::atomic<int> messages{0};

  VulkanRoot() = default;
  VulkanRoot(const VulkanRoot&) = delete;
  VulkanRoot& operator=(const VulkanRoot&) = delete;
  ~VulkanRoot();
};

/// Shared by the device object and by every resource made on it. Members in destruction order.
struct GpuDevice::Core {
  VulkanRoot root;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  std::uint32_t queueFamily = 0;
  VkQueue queue = VK_NULL_HANDLE;
  std::string name;
  bool validated = false;
  bool atomics64 = false;
  SamplerHandle nearestSampler, linearSampler;
  CommandPoolHandle commandPool;
  VkCommandBuffer commandBuffer = VK_NULL_HANDLE;
  FenceHandle fence;
  std::vector<std::weak_ptr<GpuPipeline::State>> pipelines;  ///< for reloading

  Result<MemoryHandle> allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted,
                                VkMemoryPropertyFlags required) const;
};

struct GpuBuffer::State {
  std::shared_ptr<GpuDevice::Core> core;
  std::size_t size = 0;
  MemoryHandle memory;
  BufferHandle buffer;
  std::byte* mapped = nullptr;  ///< unmapped when the memory is freed
};

struct GpuImage::State {
  std::shared_ptr<GpuDevice::Core> core;
  GpuFormat format = GpuFormat::Rgba8;
  int width = 0, height = 0;
  MemoryHandle memory;
  ImageHandle image;
  ImageViewHandle view;
  // Where the last command left it.
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  VkPipelineStageFlags2 stage = VK_PIPELINE_STAGE_2_NONE;
  VkAccessFlags2 access = VK_ACCESS_2_NONE;
};

struct GpuPipeline::State {
  std::shared_ptr<GpuDevice::Core> core;
  std::variant<GpuGraphicsDescription, GpuComputeDescription> description;
  SetLayoutHandle setLayout;
  PipelineLayoutHandle layout;
  PipelineHandle pipeline;
  std::int64_t sourceTime = 0;

  bool isCompute() const { return description.index() == 1; }
  const std::vector<GpuBindingKind>& bindings() const;
  /// Builds `pipeline` anew from its shaders; `fromSource` compiles them first.
  Result<void> build(bool fromSource);
  std::int64_t newestSource() const;
};

struct GpuBindings::State {
  std::shared_ptr<GpuDevice::Core> core;
  std::vector<GpuResource> resources;
  DescriptorPoolHandle pool;
  VkDescriptorSet set = VK_NULL_HANDLE;
};

struct GpuCommands::State {
  VkCommandBuffer commands = VK_NULL_HANDLE;
};

VkFormat vulkanFormat(GpuFormat format);
VkImageAspectFlags aspectOf(GpuFormat format);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "gpu/gpu_resources.h"

#include "gpu/vulkan_core.h"

namespace alidade {

std::size_t bytesPerPixel(GpuFormat format) {
  switch (format) {
    case GpuFormat::R8Uint:
      return 1;
    case GpuFormat::Rg8:
      return 2;
    case GpuFormat::Rgba8:
    case GpuFormat::R32Float:
    case GpuFormat::R32Uint:
    case GpuFormat::Depth32:
      return 4;
  }
  return 0;
}

VkFormat vulkanFormat(GpuFormat format) {
  switch (format) {
    case GpuFormat::Rgba8:
      return VK_FORMAT_R8G8B8A8_UNORM;
    case GpuFormat::Rg8:
      return VK_FORMAT_R8G8_UNORM;
    case GpuFormat::R8Uint:
      return VK_FORMAT_R8_UINT;
    case GpuFormat::R32Float:
      return VK_FORMAT_R32_SFLOAT;
    case GpuFormat::R32Uint:
      return VK_FORMAT_R32_UINT;
    case GpuFormat::Depth32:
      return VK_FORMAT_D32_SFLOAT;
  }
  return VK_FORMAT_UNDEFINED;
}

VkImageAspectFlags aspectOf(GpuFormat format) {
  return format == GpuFormat::Depth32 ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

std::size_t GpuBuffer::size() const {
  return m_state->size;
}
std::byte* GpuBuffer::data() {
  return m_state->mapped;
}
const std::byte* GpuBuffer::data() const {
  return m_state->mapped;
}

int GpuImage::width() const {
  return m_state->width;
}
int GpuImage::height() const {
  return m_state->height;
}
GpuFormat GpuImage::format() const {
  return m_state->format;
}
std::size_t GpuImage::byteCount() const {
  return static_cast<std::size_t>(m_state->width) * m_state->height * bytesPerPixel(m_state->format);
}

namespace {

VkBufferUsageFlags usageOf(GpuBufferUse use) {
  switch (use) {
    case GpuBufferUse::Vertex:
      return VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
    case GpuBufferUse::Index:
      return VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
    case GpuBufferUse::Uniform:
      return VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT;
    case GpuBufferUse::Storage:
      return VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    case GpuBufferUse::DeviceStorage:
      return VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
             VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    case GpuBufferUse::Upload:
      return VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    case GpuBufferUse::Readback:
      return VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  }
  return 0;
}

constexpr VkMemoryPropertyFlags kHost =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

VkImageUsageFlags usageOf(GpuFormat format) {
  const VkImageUsageFlags target = format == GpuFormat::Depth32 ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                                                : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  return target | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
         VK_IMAGE_USAGE_TRANSFER_DST_BIT;
}

}  // namespace

Result<MemoryHandle> GpuDevice::Core::allocate(const VkMemoryRequirements& needs,
                                               VkMemoryPropertyFlags wanted,
                                               VkMemoryPropertyFlags required) const {
  for (const VkMemoryPropertyFlags flags : {wanted | required, required}) {
    for (std::uint32_t type = 0; type < memory.memoryTypeCount; ++type) {
      if (!(needs.memoryTypeBits & (1u << type)) || (memory.memoryTypes[type].propertyFlags & flags) != flags)
        continue;
      auto info = stamped<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
      info.allocationSize = needs.size;
      info.memoryTypeIndex = type;
      return makeHandle<MemoryHandle>("vkAllocateMemory", vkAllocateMemory, root.device, info);
    }
  }
  return fail("The graphics device offers no memory of the kind needed", name,
              "Choose another device with ALIDADE_VULKAN_DEVICE");
}

Result<GpuBuffer> GpuDevice::makeBuffer(GpuBufferUse use, std::size_t bytes) {
  auto state = std::make_shared<GpuBuffer::State>();
  state->core = m_core;
  state->size = std::max<std::size_t>(bytes, 16);
  auto info = stamped<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = state->size;
  info.usage = usageOf(use);
  const VkDevice device = m_core->root.device;
  auto buffer = makeHandle<BufferHandle>("vkCreateBuffer", vkCreateBuffer, device, info);
  if (!buffer) return fail(buffer.error());
  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(device, buffer->get(), &needs);
  const bool isHidden = use == GpuBufferUse::DeviceStorage;
  const VkMemoryPropertyFlags wanted = isHidden                        ? VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT
                                       : use == GpuBufferUse::Readback ? VK_MEMORY_PROPERTY_HOST_CACHED_BIT
                                                                       : 0;
  auto memory = m_core->allocate(needs, wanted, isHidden ? 0 : kHost);
  if (!memory) return fail(memory.error());
  if (const VkResult result = vkBindBufferMemory(device, buffer->get(), memory->get(), 0);
      result != VK_SUCCESS)
    return vulkanFailure("vkBindBufferMemory", result);
  void* mapped = nullptr;
  if (!isHidden)
    if (const VkResult result = vkMapMemory(device, memory->get(), 0, VK_WHOLE_SIZE, 0, &mapped);
        result != VK_SUCCESS)
      return vulkanFailure("vkMapMemory", result);
  state->mapped = static_cast<std::byte*>(mapped);
  state->buffer = std::move(*buffer);
  state->memory = std::move(*memory);
  return GpuBuffer(std::move(state));
}

Result<GpuImage> GpuDevice::makeImage(GpuFormat format, int width, int height) {
  if (width <= 0 || height <= 0 || width > maximumImageSize() || height > maximumImageSize())
    return fail(
        "A picture of " + std::to_string(width) + " × " + std::to_string(height) + " pixels cannot be drawn",
        name(), "Choose a size of 1 to " + std::to_string(maximumImageSize()) + " pixels an edge");
  auto state = std::make_shared<GpuImage::State>();
  state->core = m_core;
  state->format = format;
  state->width = width;
  state->height = height;
  auto info = stamped<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = vulkanFormat(format);
  info.extent = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = usageOf(format);
  const VkDevice device = m_core->root.device;
  auto image = makeHandle<ImageHandle>("vkCreateImage", vkCreateImage, device, info);
  if (!image) return fail(image.error());
  VkMemoryRequirements needs{};
  vkGetImageMemoryRequirements(device, image->get(), &needs);
  auto memory = m_core->allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0);
  if (!memory) return fail(memory.error());
  if (const VkResult result = vkBindImageMemory(device, image->get(), memory->get(), 0); result != VK_SUCCESS)
    return vulkanFailure("vkBindImageMemory", result);
  auto viewInfo = stamped<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  viewInfo.image = image->get();
  viewInfo.viewType = VK_IMAGE_VIEW_TYPE_2D;
  viewInfo.format = info.format;
  viewInfo.subresourceRange = {aspectOf(format), 0, 1, 0, 1};
  auto view = makeHandle<ImageViewHandle>("vkCreateImageView", vkCreateImageView, device, viewInfo);
  if (!view) return fail(view.error());
  state->memory = std::move(*memory);
  state->image = std::move(*image);
  state->view = std::move(*view);
  return GpuImage(std::move(state));
}

Result<GpuBindings> GpuDevice::makeBindings(const GpuPipeline& pipeline,
                                            const std::vector<GpuResource>& resources) {
  const auto& kinds = pipeline.state().bindings();
  auto state = std::make_shared<GpuBindings::State>();
  state->core = m_core;
  state->resources = resources;
  const auto count = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(kinds.size()));
  const std::vector<VkDescriptorPoolSize> sizes{{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, count},
                                                {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, count},
                                                {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, count}};
  auto poolInfo = stamped<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  poolInfo.maxSets = 1;
  poolInfo.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
  poolInfo.pPoolSizes = sizes.data();
  const VkDevice device = m_core->root.device;
  auto pool =
      makeHandle<DescriptorPoolHandle>("vkCreateDescriptorPool", vkCreateDescriptorPool, device, poolInfo);
  if (!pool) return fail(pool.error());
  state->pool = std::move(*pool);
  const VkDescriptorSetLayout layout = pipeline.state().setLayout.get();
  auto allocate = stamped<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  allocate.descriptorPool = state->pool.get();
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &layout;
  if (const VkResult result = vkAllocateDescriptorSets(device, &allocate, &state->set); result != VK_SUCCESS)
    return vulkanFailure("vkAllocateDescriptorSets", result);

  std::vector<VkDescriptorBufferInfo> buffers(kinds.size());
  std::vector<VkDescriptorImageInfo> images(kinds.size());
  std::vector<VkWriteDescriptorSet> writes(
      kinds.size(), stamped<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET));
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    writes[i].dstSet = state->set;
    writes[i].dstBinding = static_cast<std::uint32_t>(i);
    writes[i].descriptorCount = 1;
    if (const auto* buffer = std::get_if<GpuBuffer>(&resources[i])) {
      buffers[i] = {buffer->state().buffer.get(), 0, VK_WHOLE_SIZE};
      writes[i].descriptorType = kinds[i] == GpuBindingKind::Uniform ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
                                                                     : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
      writes[i].pBufferInfo = &buffers[i];
    } else {
      const auto& sampler =
          kinds[i] == GpuBindingKind::SampledLinear ? m_core->linearSampler : m_core->nearestSampler;
      images[i] = {sampler.get(), std::get<GpuImage>(resources[i]).state().view.get(),
                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
      writes[i].descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
      writes[i].pImageInfo = &images[i];
    }
  }
  vkUpdateDescriptorSets(device, static_cast<std::uint32_t>(writes.size()), writes.data(), 0, nullptr);
  return GpuBindings(std::move(state));
}

}  // namespace alidade

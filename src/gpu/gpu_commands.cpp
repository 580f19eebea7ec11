// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "gpu/gpu_commands.h"

#include "gpu/vulkan_core.h"

namespace alidade {

namespace {

struct ImageUse {
  VkImageLayout layout;
  VkPipelineStageFlags2 stage;
  VkAccessFlags2 access;
};

constexpr ImageUse kColourTarget{
    VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
    VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
constexpr ImageUse kDepthTarget{
    VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
constexpr ImageUse kSampled{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                            VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                            VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
constexpr ImageUse kCopySource{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                               VK_ACCESS_2_TRANSFER_READ_BIT};
constexpr ImageUse kCopyTarget{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                               VK_ACCESS_2_TRANSFER_WRITE_BIT};

/// Moves an image to its next use. `discard`: what it holds is no longer wanted.
void moveImage(VkCommandBuffer commands, GpuImage::State& image, const ImageUse& use, bool discard = false) {
  auto barrier = stamped<VkImageMemoryBarrier2>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2);
  barrier.srcStageMask = image.stage;
  barrier.srcAccessMask = image.access;
  barrier.dstStageMask = use.stage;
  barrier.dstAccessMask = use.access;
  barrier.oldLayout = discard ? VK_IMAGE_LAYOUT_UNDEFINED : image.layout;
  barrier.newLayout = use.layout;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.image.get();
  barrier.subresourceRange = {aspectOf(image.format), 0, 1, 0, 1};
  auto dependency = stamped<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &dependency);
  image.layout = use.layout;
  image.stage = use.stage;
  image.access = use.access;
}

/// Makes what one stage wrote seen by another.
void handOver(VkCommandBuffer commands, VkPipelineStageFlags2 stage, VkAccessFlags2 access,
              VkPipelineStageFlags2 toStage, VkAccessFlags2 toAccess) {
  auto barrier = stamped<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
  barrier.srcStageMask = stage;
  barrier.srcAccessMask = access;
  barrier.dstStageMask = toStage;
  barrier.dstAccessMask = toAccess;
  auto dependency = stamped<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &dependency);
}

/// Lets the host read what copies or compute wrote.
void handToHost(VkCommandBuffer commands, VkPipelineStageFlags2 stage, VkAccessFlags2 access) {
  handOver(commands, stage, access, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

constexpr VkAccessFlags2 kStorage =
    VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;

VkBufferImageCopy wholeImage(const GpuImage::State& image) {
  VkBufferImageCopy region{};
  region.imageSubresource = {aspectOf(image.format), 0, 0, 1};
  region.imageExtent = {static_cast<std::uint32_t>(image.width), static_cast<std::uint32_t>(image.height), 1};
  return region;
}

bool isUnsigned(GpuFormat format) {
  return format == GpuFormat::R8Uint || format == GpuFormat::R32Uint;
}

VkRenderingAttachmentInfo attachmentOf(const GpuPassTarget& target, VkImageLayout layout) {
  const GpuImage::State& image = target.image.state();
  auto info = stamped<VkRenderingAttachmentInfo>(VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO);
  info.imageView = image.view.get();
  info.imageLayout = layout;
  info.loadOp = target.clear           ? VK_ATTACHMENT_LOAD_OP_CLEAR
                : target.isOverwritten ? VK_ATTACHMENT_LOAD_OP_DONT_CARE
                                       : VK_ATTACHMENT_LOAD_OP_LOAD;
  info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  if (!target.clear) return info;
  const auto& clear = *target.clear;
  if (image.format == GpuFormat::Depth32)
    info.clearValue.depthStencil.depth = clear[0];
  else if (isUnsigned(image.format))
    for (int i = 0; i < 4; ++i) info.clearValue.color.uint32[i] = static_cast<std::uint32_t>(clear[i]);
  else
    for (int i = 0; i < 4; ++i) info.clearValue.color.float32[i] = clear[i];
  return info;
}

}  // namespace

void GpuCommands::upload(const GpuBuffer& from, const GpuImage& to) {
  moveImage(m_state.commands, to.state(), kCopyTarget, true);
  const VkBufferImageCopy region = wholeImage(to.state());
  vkCmdCopyBufferToImage(m_state.commands, from.state().buffer.get(), to.state().image.get(),
                         VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
}

void GpuCommands::readBack(const GpuImage& from, const GpuBuffer& to) {
  moveImage(m_state.commands, from.state(), kCopySource);
  const VkBufferImageCopy region = wholeImage(from.state());
  vkCmdCopyImageToBuffer(m_state.commands, from.state().image.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                         to.state().buffer.get(), 1, &region);
  handToHost(m_state.commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
}

void GpuCommands::fill(const GpuBuffer& buffer, std::uint32_t word) {
  vkCmdFillBuffer(m_state.commands, buffer.state().buffer.get(), 0, VK_WHOLE_SIZE, word);
  handOver(m_state.commands, VK_PIPELINE_STAGE_2_CLEAR_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
           VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, kStorage);
}

void GpuCommands::copy(const GpuBuffer& from, const GpuBuffer& to) {
  handOver(m_state.commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
           VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT);
  const VkBufferCopy region{0, 0, to.size()};
  vkCmdCopyBuffer(m_state.commands, from.state().buffer.get(), to.state().buffer.get(), 1, &region);
  handToHost(m_state.commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
}

void GpuCommands::toSampled(const GpuImage& image) {
  moveImage(m_state.commands, image.state(), kSampled);
}

void GpuCommands::beginPass(const GpuPass& pass) {
  std::vector<VkRenderingAttachmentInfo> colours;
  VkExtent2D extent{0, 0};
  const auto enter = [&](const GpuPassTarget& target, const ImageUse& use) {
    moveImage(m_state.commands, target.image.state(), use, target.clear.has_value() || target.isOverwritten);
    extent = {static_cast<std::uint32_t>(target.image.width()),
              static_cast<std::uint32_t>(target.image.height())};
    return attachmentOf(target, use.layout);
  };
  for (const GpuPassTarget& target : pass.colours) colours.push_back(enter(target, kColourTarget));
  VkRenderingAttachmentInfo depth{};
  if (pass.depth) depth = enter(*pass.depth, kDepthTarget);

  auto info = stamped<VkRenderingInfo>(VK_STRUCTURE_TYPE_RENDERING_INFO);
  info.renderArea = {{0, 0}, extent};
  info.layerCount = 1;
  info.colorAttachmentCount = static_cast<std::uint32_t>(colours.size());
  info.pColorAttachments = colours.data();
  info.pDepthAttachment = pass.depth ? &depth : nullptr;
  vkCmdBeginRendering(m_state.commands, &info);

  const VkViewport viewport{0, 0, static_cast<float>(extent.width), static_cast<float>(extent.height), 0, 1};
  const VkRect2D scissor{{0, 0}, extent};
  vkCmdSetViewport(m_state.commands, 0, 1, &viewport);
  vkCmdSetScissor(m_state.commands, 0, 1, &scissor);
}

void GpuCommands::endPass() {
  vkCmdEndRendering(m_state.commands);
}

void GpuCommands::bind(const GpuPipeline& pipeline, const GpuBindings& bindings) {
  const VkPipelineBindPoint point =
      pipeline.state().isCompute() ? VK_PIPELINE_BIND_POINT_COMPUTE : VK_PIPELINE_BIND_POINT_GRAPHICS;
  vkCmdBindPipeline(m_state.commands, point, pipeline.state().pipeline.get());
  vkCmdBindDescriptorSets(m_state.commands, point, pipeline.state().layout.get(), 0, 1, &bindings.state().set,
                          0, nullptr);
}

void GpuCommands::bindVertices(const GpuBuffer& vertices) {
  const VkBuffer buffer = vertices.state().buffer.get();
  const VkDeviceSize offset = 0;
  vkCmdBindVertexBuffers(m_state.commands, 0, 1, &buffer, &offset);
}

void GpuCommands::bindIndices(const GpuBuffer& indices) {
  vkCmdBindIndexBuffer(m_state.commands, indices.state().buffer.get(), 0, VK_INDEX_TYPE_UINT32);
}

void GpuCommands::draw(std::uint32_t vertexCount) {
  vkCmdDraw(m_state.commands, vertexCount, 1, 0, 0);
}

void GpuCommands::drawIndexed(std::uint32_t indexCount) {
  vkCmdDrawIndexed(m_state.commands, indexCount, 1, 0, 0, 0);
}

void GpuCommands::dispatch(std::uint32_t groupsX, std::uint32_t groupsY) {
  vkCmdDispatch(m_state.commands, groupsX, groupsY, 1);
  handToHost(m_state.commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
}

}  // namespace alidade

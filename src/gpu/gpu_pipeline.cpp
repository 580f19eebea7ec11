// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>

#include "base/log.h"
#include "gpu/shader_library.h"
#include "gpu/vulkan_core.h"

namespace alidade {

namespace {

VkFormat attributeFormat(GpuVertexAttribute::Kind kind) {
  switch (kind) {
    case GpuVertexAttribute::Kind::Float:
      return VK_FORMAT_R32_SFLOAT;
    case GpuVertexAttribute::Kind::Vec3:
      return VK_FORMAT_R32G32B32_SFLOAT;
    case GpuVertexAttribute::Kind::Uint:
      return VK_FORMAT_R32_UINT;
  }
  return VK_FORMAT_UNDEFINED;
}

VkDescriptorType descriptorType(GpuBindingKind kind) {
  switch (kind) {
    case GpuBindingKind::Uniform:
      return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    case GpuBindingKind::Storage:
      return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    case GpuBindingKind::SampledNearest:
    case GpuBindingKind::SampledLinear:
      return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  }
  return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
}

Result<ShaderHandle> shaderModule(VkDevice device, const std::string& name, bool fromSource) {
  const auto words = fromSource ? compileShader(name) : loadShader(name);
  if (!words) return fail(words.error());
  auto info = stamped<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  info.codeSize = words->size() * sizeof(std::uint32_t);
  info.pCode = words->data();
  return makeHandle<ShaderHandle>("vkCreateShaderModule", vkCreateShaderModule, device, info);
}

/// Specialisation constants by number, from a list of words.
struct Specialisation {
  std::vector<VkSpecializationMapEntry> entries;
  VkSpecializationInfo info{};
  explicit Specialisation(const std::vector<std::uint32_t>& constants) {
    for (std::uint32_t i = 0; i < constants.size(); ++i)
      entries.push_back({i, static_cast<std::uint32_t>(i * sizeof(std::uint32_t)), sizeof(std::uint32_t)});
    info = {static_cast<std::uint32_t>(entries.size()), entries.data(),
            constants.size() * sizeof(std::uint32_t), constants.data()};
  }
};

VkPipelineShaderStageCreateInfo stageOf(VkShaderStageFlagBits stage, const ShaderHandle& shader,
                                        const Specialisation& specialisation) {
  auto info = stamped<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
  info.stage = stage;
  info.module = shader.get();
  info.pName = "main";
  info.pSpecializationInfo = &specialisation.info;
  return info;
}

VkPipelineColorBlendAttachmentState blendOf(const GpuColourTarget& target) {
  VkPipelineColorBlendAttachmentState state{};
  state.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT |
                         VK_COLOR_COMPONENT_A_BIT;
  if (target.blend == GpuBlend::Maximum) {
    state.blendEnable = VK_TRUE;
    state.srcColorBlendFactor = state.dstColorBlendFactor = VK_BLEND_FACTOR_ONE;
    state.srcAlphaBlendFactor = state.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
    state.colorBlendOp = state.alphaBlendOp = VK_BLEND_OP_MAX;
  }
  return state;
}

Result<PipelineHandle> createGraphics(VkDevice device, const GpuGraphicsDescription& what,
                                      VkPipelineLayout layout, const ShaderHandle& vertex,
                                      const ShaderHandle& fragment) {
  const Specialisation specialisation(what.constants);
  const std::array stages{stageOf(VK_SHADER_STAGE_VERTEX_BIT, vertex, specialisation),
                          stageOf(VK_SHADER_STAGE_FRAGMENT_BIT, fragment, specialisation)};
  const VkVertexInputBindingDescription binding{0, what.vertexStride, VK_VERTEX_INPUT_RATE_VERTEX};
  std::vector<VkVertexInputAttributeDescription> attributes;
  for (const GpuVertexAttribute& a : what.attributes)
    attributes.push_back(
        {static_cast<std::uint32_t>(attributes.size()), 0, attributeFormat(a.kind), a.offset});
  auto input = stamped<VkPipelineVertexInputStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
  input.vertexBindingDescriptionCount = what.vertexStride ? 1 : 0;
  input.pVertexBindingDescriptions = &binding;
  input.vertexAttributeDescriptionCount = static_cast<std::uint32_t>(attributes.size());
  input.pVertexAttributeDescriptions = attributes.data();

  auto assembly = stamped<VkPipelineInputAssemblyStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  auto viewport =
      stamped<VkPipelineViewportStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  viewport.viewportCount = viewport.scissorCount = 1;
  auto raster = stamped<VkPipelineRasterizationStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
  raster.cullMode = VK_CULL_MODE_NONE;
  raster.lineWidth = 1;
  auto samples =
      stamped<VkPipelineMultisampleStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  auto depth = stamped<VkPipelineDepthStencilStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
  depth.depthTestEnable = what.depthTest;
  depth.depthWriteEnable = what.depthWrite;
  depth.depthCompareOp = VK_COMPARE_OP_GREATER;
  std::vector<VkPipelineColorBlendAttachmentState> blends;
  std::vector<VkFormat> formats;
  for (const GpuColourTarget& target : what.targets) {
    blends.push_back(blendOf(target));
    formats.push_back(vulkanFormat(target.format));
  }
  auto blend =
      stamped<VkPipelineColorBlendStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blend.attachmentCount = static_cast<std::uint32_t>(blends.size());
  blend.pAttachments = blends.data();
  const std::array dynamicStates{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  auto dynamic =
      stamped<VkPipelineDynamicStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO);
  dynamic.dynamicStateCount = static_cast<std::uint32_t>(dynamicStates.size());
  dynamic.pDynamicStates = dynamicStates.data();
  auto rendering = stamped<VkPipelineRenderingCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO);
  rendering.colorAttachmentCount = static_cast<std::uint32_t>(formats.size());
  rendering.pColorAttachmentFormats = formats.data();
  rendering.depthAttachmentFormat =
      what.depthTest || what.depthWrite ? vulkanFormat(GpuFormat::Depth32) : VK_FORMAT_UNDEFINED;

  auto info = stamped<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  info.pNext = &rendering;
  info.stageCount = static_cast<std::uint32_t>(stages.size());
  info.pStages = stages.data();
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  if (const VkResult result = vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);
      result != VK_SUCCESS)
    return vulkanFailure("vkCreateGraphicsPipelines", result);
  return PipelineHandle(device, pipeline);
}

Result<PipelineHandle> createCompute(VkDevice device, const GpuComputeDescription& what,
                                     VkPipelineLayout layout, const ShaderHandle& shader) {
  const Specialisation specialisation(what.constants);
  auto info = stamped<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage = stageOf(VK_SHADER_STAGE_COMPUTE_BIT, shader, specialisation);
  info.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  if (const VkResult result = vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);
      result != VK_SUCCESS)
    return vulkanFailure("vkCreateComputePipelines", result);
  return PipelineHandle(device, pipeline);
}

/// Layouts follow from the binding kinds; set 0 alone, every stage may use it.
Result<void> makeLayouts(GpuPipeline::State& state) {
  const VkDevice device = state.core->root.device;
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const GpuBindingKind kind : state.bindings()) {
    VkDescriptorSetLayoutBinding binding{};
    binding.binding = static_cast<std::uint32_t>(bindings.size());
    binding.descriptorType = descriptorType(kind);
    binding.descriptorCount = 1;
    binding.stageFlags = state.isCompute() ? VK_SHADER_STAGE_COMPUTE_BIT
                                           : VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    bindings.push_back(binding);
  }
  auto setInfo =
      stamped<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  setInfo.bindingCount = static_cast<std::uint32_t>(bindings.size());
  setInfo.pBindings = bindings.data();
  auto set = makeHandle<SetLayoutHandle>("vkCreateDescriptorSetLayout", vkCreateDescriptorSetLayout, device,
                                         setInfo);
  if (!set) return fail(set.error());
  state.setLayout = std::move(*set);
  const VkDescriptorSetLayout setLayout = state.setLayout.get();
  auto info = stamped<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  info.setLayoutCount = 1;
  info.pSetLayouts = &setLayout;
  auto layout =
      makeHandle<PipelineLayoutHandle>("vkCreatePipelineLayout", vkCreatePipelineLayout, device, info);
  if (!layout) return fail(layout.error());
  state.layout = std::move(*layout);
  return {};
}

std::vector<std::string> shadersOf(const GpuPipeline::State& state) {
  if (const auto* compute = std::get_if<GpuComputeDescription>(&state.description)) return {compute->shader};
  const auto& graphics = std::get<GpuGraphicsDescription>(state.description);
  return {graphics.vertexShader, graphics.fragmentShader};
}

template <class Description>
Result<GpuPipeline> makeFrom(const std::shared_ptr<GpuDevice::Core>& core, const Description& description) {
  auto state = std::make_shared<GpuPipeline::State>();
  state->core = core;
  state->description = description;
  if (auto made = makeLayouts(*state); !made) return fail(made.error());
  state->sourceTime = state->newestSource();
  if (auto built = state->build(false); !built) return fail(built.error());
  core->pipelines.push_back(state);
  return GpuPipeline(std::move(state));
}

}  // namespace

const std::vector<GpuBindingKind>& GpuPipeline::State::bindings() const {
  return std::visit([](const auto& d) -> const std::vector<GpuBindingKind>& { return d.bindings; },
                    description);
}

Result<void> GpuPipeline::State::build(bool fromSource) {
  std::vector<ShaderHandle> shaders;
  for (const std::string& name : shadersOf(*this)) {
    auto shader = shaderModule(core->root.device, name, fromSource);
    if (!shader) return fail(shader.error());
    shaders.push_back(std::move(*shader));
  }
  auto made = isCompute() ? createCompute(core->root.device, std::get<GpuComputeDescription>(description),
                                          layout.get(), shaders[0])
                          : createGraphics(core->root.device, std::get<GpuGraphicsDescription>(description),
                                           layout.get(), shaders[0], shaders[1]);
  if (!made) return fail(made.error());
  pipeline = std::move(*made);
  return {};
}

std::int64_t GpuPipeline::State::newestSource() const {
  std::int64_t newest = 0;
  for (const std::string& name : shadersOf(*this))
    newest = std::max<std::int64_t>(newest, shaderSourceTime(name).time_since_epoch().count());
  return newest;
}

Result<GpuPipeline> GpuDevice::makePipeline(const GpuGraphicsDescription& description) {
  return makeFrom(m_core, description);
}

Result<GpuPipeline> GpuDevice::makePipeline(const GpuComputeDescription& description) {
  return makeFrom(m_core, description);
}

void GpuDevice::reloadChangedShaders() {
  std::erase_if(m_core->pipelines, [](const auto& pipeline) { return pipeline.expired(); });
  for (const auto& entry : m_core->pipelines) {
    const auto pipeline = entry.lock();
    const std::int64_t newest = pipeline->newestSource();
    if (newest <= pipeline->sourceTime) continue;
    pipeline->sourceTime = newest;
    if (auto built = pipeline->build(true); !built) logWarning(built.error().text());
  }
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/parallel.h"
#include "gpu/gpu_device.h"
#include "overlay/device.h"
#include "overlay/frame_uniform.h"
#include "overlay/vulkan_splatter.h"

namespace alidade {

namespace {

void copyInParallel(std::byte* to, const void* from, std::size_t bytes) {
  const auto* source = static_cast<const std::byte*>(from);
  parallelFor(bytes, std::size_t{1} << 20, [&](std::size_t first, std::size_t last, int) {
    std::memcpy(to + first, source + first, last - first);
  });
}

/// NaN does not survive every GPU: unknown goes up as -1.
void copyScanDepth(std::byte* to, const DepthImage& depth) {
  auto* target = reinterpret_cast<float*>(to);
  const float* source = depth.data();
  parallelFor(depth.size(), std::size_t{1} << 18, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) target[i] = source[i] >= 0 ? source[i] : -1.0f;
  });
}

/// A buffer that grows and is otherwise kept from frame to frame.
struct GrowingBuffer {
  GpuBufferUse use;
  GpuBuffer buffer;

  /// True where the buffer was replaced.
  Result<bool> reserve(GpuDevice& device, std::size_t bytes) {
    if (buffer && buffer.size() >= bytes) return false;
    const std::size_t room = std::max<std::size_t>(bytes + bytes / 2, 4096);
    auto made = device.makeBuffer(use, room);
    if (!made) return fail(made.error());
    buffer = std::move(*made);
    return true;
  }
};

/// An image that is filled from the host each frame it is used.
struct UploadedImage {
  GpuImage image;
  GpuBuffer staging;

  Result<bool> ensure(GpuDevice& device, GpuFormat format, int width, int height) {
    if (image && image.width() == width && image.height() == height) return false;
    auto made = device.makeImage(format, width, height);
    if (!made) return fail(made.error());
    auto buffer = device.makeBuffer(GpuBufferUse::Upload, made->byteCount());
    if (!buffer) return fail(buffer.error());
    image = std::move(*made);
    staging = std::move(*buffer);
    return true;
  }
};

/// An image that is drawn into; with a buffer where the host reads it.
struct Target {
  GpuFormat format;
  bool isRead = false;
  GpuImage image;
  GpuBuffer result;

  Result<void> make(GpuDevice& device, int width, int height) {
    auto made = device.makeImage(format, width, height);
    if (!made) return fail(made.error());
    image = std::move(*made);
    if (!isRead) return {};
    auto buffer = device.makeBuffer(GpuBufferUse::Readback, image.byteCount());
    if (!buffer) return fail(buffer.error());
    result = std::move(*buffer);
    return {};
  }
  GpuPassTarget cleared(float value = 0) const {
    return {image, std::array<float, 4>{value, value, value, value}, false};
  }
  GpuPassTarget overwritten() const { return {image, {}, true}; }
  GpuPassTarget kept() const { return {image, {}, false}; }
};

/// Draws faces and edges into pictures of the design alone, then composes them with the camera image,
/// the scan's depth and its points, once a pixel.
class VulkanOverlayDevice final : public OverlayDevice {
 public:
  explicit VulkanOverlayDevice(std::shared_ptr<GpuDevice> device) : m_device(std::move(device)) {}

  Result<void> makePipelines();
  std::string name() const override { return "Vulkan: " + m_device->name(); }
  Result<Output> draw(const DrawList& list) override;
  SplatDevice* splatDevice() override { return m_splatter.get(); }

 private:
  Result<void> ensureTargets(const DrawList& list);
  Result<void> uploadLists(const DrawList& list);
  Result<void> ensureEdgeIndices(std::size_t edges);
  Result<void> rebind();
  void record(GpuCommands& commands, const DrawList& list);
  void recordUploads(GpuCommands& commands, const DrawList& list);
  void drawFaces(GpuCommands& commands, const DrawList& list, const GpuPipeline& pipeline,
                 const GpuBindings& bindings);
  void recordFaces(GpuCommands& commands, const DrawList& list);
  void recordEdges(GpuCommands& commands, const DrawList& list);
  void recordComposite(GpuCommands& commands, const DrawList& list);
  Output collect(const DrawList& list) const;

  std::shared_ptr<GpuDevice> m_device;
  std::unique_ptr<SplatDevice> m_splatter;  ///< of a GPU; a driver on the processor is slower than raster/
  GpuPipeline m_surface, m_maskedSurface, m_hidden, m_maskedHidden;
  GpuPipeline m_edge, m_edgeWithDepth, m_edgeBehind, m_composite;
  GpuBindings m_surfaceBindings, m_hiddenBindings, m_edgeBindings, m_compositeBindings;
  bool m_bindingsStale = true;

  GrowingBuffer m_uniform{GpuBufferUse::Uniform, {}};
  GrowingBuffer m_styles{GpuBufferUse::Storage, {}};
  GrowingBuffer m_vertices{GpuBufferUse::Vertex, {}};
  GrowingBuffer m_indices{GpuBufferUse::Index, {}};
  GrowingBuffer m_edgeVertices{GpuBufferUse::Storage, {}};
  GrowingBuffer m_edgeIndices{GpuBufferUse::Index, {}};
  std::size_t m_edgeIndexCount = 0;

  UploadedImage m_image, m_scanDepth, m_points;
  Target m_faceColour{GpuFormat::Rgba8, false, {}, {}};
  Target m_faceElement{GpuFormat::R32Uint, false, {}, {}};
  Target m_faceDepth{GpuFormat::R32Float, false, {}, {}};
  Target m_faceKey{GpuFormat::R8Uint, false, {}, {}};
  Target m_depthBuffer{GpuFormat::Depth32, false, {}, {}};
  Target m_hiddenElement{GpuFormat::R32Uint, true, {}, {}};
  Target m_hiddenDepth{GpuFormat::R32Float, false, {}, {}};
  Target m_hiddenDepthBuffer{GpuFormat::Depth32, false, {}, {}};
  Target m_edgeCover{GpuFormat::Rgba8, false, {}, {}};
  Target m_edgeElement{GpuFormat::R32Uint, false, {}, {}};
  Target m_edgeDepth{GpuFormat::R32Float, false, {}, {}};
  Target m_colour{GpuFormat::Rgba8, true, {}, {}};
  Target m_element{GpuFormat::R32Uint, true, {}, {}};
  Target m_depth{GpuFormat::R32Float, true, {}, {}};
  Target m_state{GpuFormat::R8Uint, true, {}, {}};
};

Result<void> VulkanOverlayDevice::makePipelines() {
  if (!m_device->isSoftware()) {
    auto splatter = createVulkanSplatter(m_device, m_device->hasAtomics64());
    if (!splatter) return fail(splatter.error());
    m_splatter = std::move(*splatter);
  }
  using Binding = GpuBindingKind;
  using Kind = GpuVertexAttribute::Kind;
  GpuGraphicsDescription surface;
  surface.vertexShader = "design_surface.vert";
  surface.fragmentShader = "design_surface.frag";
  surface.vertexStride = sizeof(SurfaceVertex);
  surface.attributes = {{Kind::Vec3, offsetof(SurfaceVertex, pInCamera)},
                        {Kind::Vec3, offsetof(SurfaceVertex, normal)},
                        {Kind::Uint, offsetof(SurfaceVertex, element)}};
  surface.targets = {{GpuFormat::Rgba8}, {GpuFormat::R32Uint}, {GpuFormat::R32Float}, {GpuFormat::R8Uint}};
  surface.depthTest = surface.depthWrite = true;
  surface.bindings = {Binding::Uniform, Binding::Storage, Binding::SampledNearest};
  surface.constants = {0};
  GpuGraphicsDescription hidden = surface;
  hidden.vertexShader = "hidden_surface.vert";
  hidden.fragmentShader = "hidden_surface.frag";
  hidden.targets = {{GpuFormat::R32Uint}, {GpuFormat::R32Float}};
  hidden.bindings.resize(5, Binding::SampledNearest);
  GpuGraphicsDescription masked = surface, maskedHidden = hidden;
  masked.constants = maskedHidden.constants = {1};

  GpuGraphicsDescription edge;
  edge.vertexShader = "design_edge.vert";
  edge.fragmentShader = "design_edge.frag";
  edge.targets = {{GpuFormat::Rgba8, GpuBlend::Maximum}, {GpuFormat::R32Uint}};
  edge.depthTest = true;  // coarse, so that what stands far behind costs nothing; the shader decides
  edge.bindings = {Binding::Uniform, Binding::Storage, Binding::Storage};
  edge.bindings.resize(9, Binding::SampledNearest);
  edge.constants = {0};
  GpuGraphicsDescription edgeBehind = edge, edgeWithDepth = edge;
  edgeBehind.constants = {1};
  edgeWithDepth.targets.push_back({GpuFormat::R32Float});

  GpuGraphicsDescription composite;
  composite.vertexShader = "composite.vert";
  composite.fragmentShader = "composite.frag";
  composite.targets = {{GpuFormat::Rgba8}, {GpuFormat::R32Uint}, {GpuFormat::R32Float}, {GpuFormat::R8Uint}};
  composite.bindings = {Binding::Uniform, Binding::Storage, Binding::SampledLinear};
  composite.bindings.resize(13, Binding::SampledNearest);

  const std::array<std::pair<GpuPipeline*, const GpuGraphicsDescription*>, 8> wanted{
      {{&m_surface, &surface},
       {&m_maskedSurface, &masked},
       {&m_hidden, &hidden},
       {&m_maskedHidden, &maskedHidden},
       {&m_edge, &edge},
       {&m_edgeWithDepth, &edgeWithDepth},
       {&m_edgeBehind, &edgeBehind},
       {&m_composite, &composite}}};
  for (const auto& [pipeline, description] : wanted) {
    auto made = m_device->makePipeline(*description);
    if (!made) return fail(made.error());
    *pipeline = std::move(*made);
  }
  return {};
}

Result<void> VulkanOverlayDevice::ensureTargets(const DrawList& list) {
  const int w = list.width, h = list.height;
  if (!m_colour.image || m_colour.image.width() != w || m_colour.image.height() != h) {
    m_bindingsStale = true;
    for (Target* target : {&m_faceColour, &m_faceElement, &m_faceDepth, &m_faceKey, &m_depthBuffer,
                           &m_hiddenElement, &m_hiddenDepth, &m_hiddenDepthBuffer, &m_edgeCover,
                           &m_edgeElement, &m_edgeDepth, &m_element, &m_depth, &m_state, &m_colour})
      if (auto made = target->make(*m_device, w, h); !made) return made;
  }
  const bool hasImage = list.image && !list.image->empty();
  const auto ensure = [&](UploadedImage& image, GpuFormat format, int width, int height) -> Result<void> {
    auto replaced = image.ensure(*m_device, format, width, height);
    if (!replaced) return fail(replaced.error());
    m_bindingsStale = m_bindingsStale || *replaced;
    return {};
  };
  if (hasImage || !m_image.image)
    if (auto ok = ensure(m_image, GpuFormat::Rgba8, hasImage ? list.image->width() : 1,
                         hasImage ? list.image->height() : 1);
        !ok)
      return ok;
  if (auto ok = ensure(m_scanDepth, GpuFormat::R32Float, w, h); !ok) return ok;
  return ensure(m_points, GpuFormat::Rgba8, w, h);
}

Result<void> VulkanOverlayDevice::ensureEdgeIndices(std::size_t edges) {
  if (edges * 6 <= m_edgeIndexCount) return {};
  if (auto grown = m_edgeIndices.reserve(*m_device, edges * 6 * sizeof(std::uint32_t)); !grown)
    return fail(grown.error());
  auto* index = reinterpret_cast<std::uint32_t*>(m_edgeIndices.buffer.data());
  m_edgeIndexCount = m_edgeIndices.buffer.size() / (6 * sizeof(std::uint32_t)) * 6;
  for (std::size_t edge = 0; edge < m_edgeIndexCount / 6; ++edge)
    for (const std::uint32_t corner : {0u, 1u, 2u, 2u, 1u, 3u})
      *index++ = static_cast<std::uint32_t>(4 * edge) + corner;
  return {};
}

Result<void> VulkanOverlayDevice::uploadLists(const DrawList& list) {
  const auto put = [&](GrowingBuffer& buffer, const void* data, std::size_t bytes,
                       bool isBound) -> Result<void> {
    auto replaced = buffer.reserve(*m_device, bytes);
    if (!replaced) return fail(replaced.error());
    if (isBound && *replaced) m_bindingsStale = true;
    copyInParallel(buffer.buffer.data(), data, bytes);
    return {};
  };
  std::vector<StyleUniform> styles;
  for (const ElementStyle& style : list.styles)
    styles.push_back(
        {style.colour,
         {style.selected, style.edgesAlone, static_cast<std::uint32_t>(style.winding), style.hiddenRank}});
  const FrameUniform uniform = frameUniform(list);
  if (auto ok = put(m_uniform, &uniform, sizeof uniform, true); !ok) return ok;
  if (auto ok = put(m_styles, styles.data(), styles.size() * sizeof(StyleUniform), true); !ok) return ok;
  if (auto ok = put(m_vertices, list.surface.data(), list.surface.size() * sizeof(SurfaceVertex), false); !ok)
    return ok;
  if (auto ok = put(m_indices, list.triangles.data(), list.triangles.size() * 4, false); !ok) return ok;
  if (auto ok = put(m_edgeVertices, list.edges.data(), list.edges.size() * sizeof(EdgeVertex), true); !ok)
    return ok;
  if (list.image && !list.image->empty())
    copyInParallel(m_image.staging.data(), list.image->data(), list.image->size() * sizeof(Rgba8));
  if (list.scanDepth) copyScanDepth(m_scanDepth.staging.data(), *list.scanDepth);
  if (list.pointColour)
    copyInParallel(m_points.staging.data(), list.pointColour->data(),
                   list.pointColour->size() * sizeof(Rgba8));
  return ensureEdgeIndices(list.edges.size() / 2);
}

Result<void> VulkanOverlayDevice::rebind() {
  if (!m_bindingsStale) return {};
  const GpuBuffer &frame = m_uniform.buffer, &styles = m_styles.buffer;
  const auto make = [&](GpuBindings& bindings, const GpuPipeline& pipeline,
                        const std::vector<GpuResource>& resources) -> Result<void> {
    auto made = m_device->makeBindings(pipeline, resources);
    if (!made) return fail(made.error());
    bindings = std::move(*made);
    return {};
  };
  if (auto ok = make(m_surfaceBindings, m_surface, {frame, styles, m_scanDepth.image}); !ok) return ok;
  if (auto ok = make(m_hiddenBindings, m_hidden,
                     {frame, styles, m_scanDepth.image, m_faceKey.image, m_faceElement.image});
      !ok)
    return ok;
  if (auto ok = make(m_edgeBindings, m_edge,
                     {frame, styles, m_edgeVertices.buffer, m_scanDepth.image, m_faceDepth.image,
                      m_faceKey.image, m_faceElement.image, m_hiddenDepth.image, m_hiddenElement.image});
      !ok)
    return ok;
  if (auto ok = make(m_compositeBindings, m_composite,
                     {frame, styles, m_image.image, m_scanDepth.image, m_points.image, m_faceColour.image,
                      m_faceElement.image, m_faceDepth.image, m_faceKey.image, m_hiddenElement.image,
                      m_edgeCover.image, m_edgeElement.image, m_edgeDepth.image});
      !ok)
    return ok;
  m_bindingsStale = false;
  return {};
}

void VulkanOverlayDevice::recordUploads(GpuCommands& commands, const DrawList& list) {
  if (list.image && !list.image->empty()) commands.upload(m_image.staging, m_image.image);
  if (list.scanDepth) commands.upload(m_scanDepth.staging, m_scanDepth.image);
  if (list.pointColour) commands.upload(m_points.staging, m_points.image);
  for (const UploadedImage* image : {&m_image, &m_scanDepth, &m_points}) commands.toSampled(image->image);
}

void VulkanOverlayDevice::drawFaces(GpuCommands& commands, const DrawList& list, const GpuPipeline& pipeline,
                                    const GpuBindings& bindings) {
  if (list.triangles.empty()) return;
  commands.bind(pipeline, bindings);
  commands.bindVertices(m_vertices.buffer);
  commands.bindIndices(m_indices.buffer);
  commands.drawIndexed(static_cast<std::uint32_t>(list.triangles.size()));
}

void VulkanOverlayDevice::recordFaces(GpuCommands& commands, const DrawList& list) {
  constexpr float nothing = std::numeric_limits<float>::infinity();
  const bool masked = list.lensFolds;
  commands.beginPass({{m_faceColour.overwritten(), m_faceElement.overwritten(), m_faceDepth.cleared(nothing),
                       m_faceKey.cleared()},
                      m_depthBuffer.cleared()});
  drawFaces(commands, list, masked ? m_maskedSurface : m_surface, m_surfaceBindings);
  commands.endPass();
  for (const Target* target : {&m_faceColour, &m_faceElement, &m_faceDepth, &m_faceKey})
    commands.toSampled(target->image);
  if (!drawsHiddenLayer(list)) return;
  commands.beginPass(
      {{m_hiddenElement.cleared(), m_hiddenDepth.cleared(nothing)}, m_hiddenDepthBuffer.cleared()});
  drawFaces(commands, list, masked ? m_maskedHidden : m_hidden, m_hiddenBindings);
  commands.endPass();
}

/// The hidden edges first, so that where both cover a pixel the front one gives its name.
void VulkanOverlayDevice::recordEdges(GpuCommands& commands, const DrawList& list) {
  for (const Target* target : {&m_hiddenDepth, &m_hiddenElement}) commands.toSampled(target->image);
  // Without edges the composition does not look at these.
  if (!drawsEdges(list)) return;
  const auto count = static_cast<std::uint32_t>(list.edges.size() * 3);
  const bool drawsBehind = drawsHiddenLayer(list) && list.display.hidden != HiddenStyle::Hide;
  if (drawsBehind) {
    commands.beginPass({{m_edgeCover.cleared(), m_edgeElement.overwritten()}, m_hiddenDepthBuffer.kept()});
    commands.bind(m_edgeBehind, m_edgeBindings);
    commands.bindIndices(m_edgeIndices.buffer);
    commands.drawIndexed(count);
    commands.endPass();
  }
  const bool needsDepth = std::any_of(list.styles.begin(), list.styles.end(),
                                      [](const ElementStyle& style) { return style.edgesAlone != 0; });
  std::vector<GpuPassTarget> targets{m_edgeCover.cleared(), m_edgeElement.overwritten()};
  if (drawsBehind) targets = {m_edgeCover.kept(), m_edgeElement.kept()};
  if (needsDepth) targets.push_back(m_edgeDepth.overwritten());
  commands.beginPass({targets, m_depthBuffer.kept()});
  commands.bind(needsDepth ? m_edgeWithDepth : m_edge, m_edgeBindings);
  commands.bindIndices(m_edgeIndices.buffer);
  commands.drawIndexed(count);
  commands.endPass();
}

void VulkanOverlayDevice::recordComposite(GpuCommands& commands, const DrawList& list) {
  for (const Target* target : {&m_edgeCover, &m_edgeElement, &m_edgeDepth}) commands.toSampled(target->image);
  commands.beginPass(
      {{m_colour.overwritten(), m_element.overwritten(), m_depth.overwritten(), m_state.overwritten()}, {}});
  commands.bind(m_composite, m_compositeBindings);
  commands.draw(3);
  commands.endPass();
  for (const Target* target : {&m_colour, &m_element, &m_depth, &m_state})
    commands.readBack(target->image, target->result);
  if (drawsHiddenLayer(list)) commands.readBack(m_hiddenElement.image, m_hiddenElement.result);
}

void VulkanOverlayDevice::record(GpuCommands& commands, const DrawList& list) {
  recordUploads(commands, list);
  recordFaces(commands, list);
  recordEdges(commands, list);
  recordComposite(commands, list);
}

OverlayDevice::Output VulkanOverlayDevice::collect(const DrawList& list) const {
  const int width = list.width, height = list.height;
  Output output{ColourImage(width, height), DepthImage(width, height), IdImage(width, height),
                Image<std::uint8_t>(width, height), IdImage()};
  const auto take = [](auto& image, const Target& target) {
    copyInParallel(reinterpret_cast<std::byte*>(image.data()), target.result.data(),
                   target.image.byteCount());
  };
  take(output.colour, m_colour);
  take(output.designDepth, m_depth);
  take(output.element, m_element);
  take(output.state, m_state);
  if (drawsHiddenLayer(list)) {
    output.hiddenElement = IdImage(width, height);
    take(output.hiddenElement, m_hiddenElement);
  }
  return output;
}

Result<OverlayDevice::Output> VulkanOverlayDevice::draw(const DrawList& list) {
  const auto fits = [&](const auto* image) {
    return !image || (image->width() == list.width && image->height() == list.height);
  };
  if (!fits(list.scanDepth) || !fits(list.pointColour))
    return fail("The scan's pictures are not of the result's size", name(),
                "Draw them for the scaled camera");
  m_device->reloadChangedShaders();
  if (auto ok = ensureTargets(list); !ok) return fail(ok.error());
  if (auto ok = uploadLists(list); !ok) return fail(ok.error());
  if (auto ok = rebind(); !ok) return fail(ok.error());
  if (auto ok = m_device->run([&](GpuCommands& commands) { record(commands, list); }); !ok)
    return fail(ok.error());
  return collect(list);
}

}  // namespace

Result<std::unique_ptr<OverlayDevice>> createVulkanDevice(bool gpuAlone) {
  auto device = GpuDevice::create();
  if (!device) return fail(device.error());
  if (gpuAlone && (*device)->isSoftware())
    return fail("Vulkan has no GPU here", (*device)->name(),
                "Set ALIDADE_DEVICE=vulkan to draw with it all the same");
  auto overlay = std::make_unique<VulkanOverlayDevice>(std::move(*device));
  if (auto made = overlay->makePipelines(); !made) return fail(made.error());
  return overlay;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/vulkan_splatter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <vector>

#include <glm/gtc/type_ptr.hpp>

#include "base/parallel.h"
#include "camera/lens_uniform.h"
#include "raster/splat_pass.h"

namespace alidade {

namespace {

constexpr std::uint32_t kChunk = 256;  // points of one group: local_size_x of the shaders
constexpr std::size_t kBatchPoints = std::size_t{1} << 22;
constexpr std::size_t kBatchNormals = std::size_t{1} << 21;
constexpr std::uint32_t kRow = 32768;  // groups along x
constexpr std::uint32_t kNone = 0xffffffffu;

/// FrameBlock of splat_points.glsl.
struct SplatFrameBlock {
  LensUniform lens;
  glm::vec4 fold;
  glm::uvec4 frame;
  std::array<glm::ivec4, SplatLevels::kMost> levels;
};
static_assert(offsetof(SplatFrameBlock, fold) == 176 && sizeof(SplatFrameBlock) == 208 + 16 * SplatLevels::kMost);

/// Run of splat_points.glsl.
struct SplatRunBlock {
  glm::vec4 x, y, z, size;
  glm::ivec4 cells;
  glm::uvec4 what;
};
static_assert(offsetof(SplatRunBlock, cells) == 64 && sizeof(SplatRunBlock) == 96);

/// What goes up at a time.
struct Batch {
  std::vector<const SplatRun*> runs;
  std::vector<std::uint32_t> firstPoint;  ///< of each run, in the run
  std::vector<std::uint32_t> pointCount;
  std::size_t points = 0, normals = 0;
};

std::size_t normalsOf(const SplatRun& run) {
  return run.view.cellNormals ? std::tuple_size_v<decltype(CellNormals::normal)> : 0;
}

std::vector<Batch> batchesOf(std::span<const SplatRun* const> runs) {
  std::vector<Batch> batches(1);
  for (const SplatRun* run : runs) {
    for (std::uint32_t first = 0; first < run->count;) {
      if (batches.back().points >= kBatchPoints || batches.back().normals + normalsOf(*run) > kBatchNormals)
        batches.emplace_back();
      Batch& batch = batches.back();
      const auto count =
          static_cast<std::uint32_t>(std::min<std::size_t>(run->count - first, kBatchPoints - batch.points));
      batch.runs.push_back(run);
      batch.firstPoint.push_back(first);
      batch.pointCount.push_back(count);
      batch.points += count;
      batch.normals += normalsOf(*run);
      first += count;
    }
  }
  if (batches.back().points == 0) batches.pop_back();
  return batches;
}

SplatRunBlock blockOf(const SplatRun& run, std::uint32_t firstPoint, SplatPayload payload,
                      std::uint32_t firstNormal) {
  const SplatView& v = run.view;
  const std::uint32_t base = run.payloadBase + (payload == SplatPayload::Index ? firstPoint : 0);
  return {{v.m[0], v.m[1], v.m[2], v.t[0]},
          {v.m[3], v.m[4], v.m[5], v.t[1]},
          {v.m[6], v.m[7], v.m[8], v.t[2]},
          {v.sizeTimesDepth, v.smallest, v.onePixel ? 0.0f : v.largest, v.round ? 1.0f : 0.0f},
          {v.cellLow[0], v.cellLow[1], v.cellLow[2], v.cellShift},
          {base, v.cellNormals ? firstNormal : kNone, std::bit_cast<std::uint32_t>(v.sizeLess), v.levels ? 1 : 0}};
}

class VulkanSplatter final : public SplatDevice {
 public:
  VulkanSplatter(std::shared_ptr<GpuDevice> device, bool wide) : m_device(std::move(device)), m_wide(wide) {}

  Result<void> makePipelines();
  Result<const void*> draw(std::span<const SplatRun* const> runs, const SplatLevels& levels, SplatPayload payload) override;

 private:
  Result<void> ensure(GpuBuffer& buffer, GpuBufferUse use, std::size_t bytes);
  Result<void> ensurePlanes(std::size_t pixels, bool isPacked);
  Result<void> upload(const Batch& batch, SplatPayload payload);
  Result<void> dispatch(const GpuPipeline& pipeline, const std::vector<GpuBuffer>& planes);
  Result<void> drawBatches(const std::vector<Batch>& batches, SplatPayload payload);
  Result<const void*> collect(std::size_t pixels, bool isPacked);

  std::shared_ptr<GpuDevice> m_device;
  bool m_wide;
  GpuPipeline m_packed, m_depth, m_payload;
  GpuBuffer m_frame, m_points, m_chunks, m_runs, m_normals;
  GpuBuffer m_plane, m_payloads, m_readBack, m_payloadsBack;
  SplatFrameBlock m_frameBlock{};
  std::vector<std::uint64_t> m_joined;  ///< of the two passes
};

Result<void> VulkanSplatter::makePipelines() {
  using Kind = GpuBindingKind;
  std::vector<Kind> kinds{Kind::Uniform, Kind::Storage, Kind::Storage,
                          Kind::Storage, Kind::Storage, Kind::Storage};
  const auto make = [&](GpuPipeline& into, const char* shader,
                        std::vector<std::uint32_t> constants) -> Result<void> {
    auto pipeline = m_device->makePipeline(GpuComputeDescription{shader, kinds, std::move(constants)});
    if (!pipeline) return fail(pipeline.error());
    into = std::move(*pipeline);
    return {};
  };
  if (m_wide)
    if (auto made = make(m_packed, "splat_points_wide.comp", {}); !made) return made;
  kinds.push_back(Kind::Storage);
  if (auto made = make(m_depth, "splat_points.comp", {0}); !made) return made;
  if (m_wide) return {};
  return make(m_payload, "splat_points.comp", {1});
}

Result<void> VulkanSplatter::ensure(GpuBuffer& buffer, GpuBufferUse use, std::size_t bytes) {
  if (buffer && buffer.size() >= bytes) return {};
  if (bytes > m_device->maximumStorageSize())
    return fail("The picture is too large for the graphics card's buffers", m_device->name(),
                "Choose a smaller picture, or set ALIDADE_DEVICE=cpu");
  auto made = m_device->makeBuffer(use, bytes);
  if (!made) return fail(made.error());
  buffer = std::move(*made);
  return {};
}

/// Read-back buffers are exactly as large as what is copied.
Result<void> VulkanSplatter::ensurePlanes(std::size_t pixels, bool isPacked) {
  const bool isOne = m_wide && isPacked;
  const std::size_t bytes = pixels * (isOne ? 8 : 4);
  if (auto ok = ensure(m_plane, GpuBufferUse::DeviceStorage, bytes); !ok) return ok;
  if (m_readBack && m_readBack.size() != bytes) m_readBack = {};
  if (auto ok = ensure(m_readBack, GpuBufferUse::Readback, bytes); !ok) return ok;
  // Bound even where it is not drawn into.
  if (isOne) return {};
  if (auto ok = ensure(m_payloads, GpuBufferUse::DeviceStorage, bytes); !ok) return ok;
  if (m_payloadsBack && m_payloadsBack.size() != bytes) m_payloadsBack = {};
  return ensure(m_payloadsBack, GpuBufferUse::Readback, bytes);
}

Result<void> VulkanSplatter::upload(const Batch& batch, SplatPayload payload) {
  std::vector<glm::uvec4> chunks;
  std::vector<SplatRunBlock> runs;
  std::vector<glm::vec4> normals;
  std::vector<std::size_t> at;
  std::uint32_t points = 0;
  for (std::size_t r = 0; r < batch.runs.size(); ++r) {
    const SplatRun& run = *batch.runs[r];
    runs.push_back(blockOf(run, batch.firstPoint[r], payload, static_cast<std::uint32_t>(normals.size())));
    for (std::size_t i = 0; i < normalsOf(run); ++i)
      normals.push_back(glm::make_vec4(run.view.cellNormals + 4 * i));
    for (std::uint32_t place = 0; place < batch.pointCount[r]; place += kChunk)
      chunks.emplace_back(r, points + place, std::min(kChunk, batch.pointCount[r] - place), place);
    at.push_back(points);
    points += batch.pointCount[r];
  }
  m_frameBlock.frame.w = static_cast<std::uint32_t>(chunks.size());
  const auto send = [&](GpuBuffer& buffer, const auto& values) -> Result<void> {
    const std::size_t bytes = values.size() * sizeof(values[0]);
    if (auto ok = ensure(buffer, GpuBufferUse::Storage, bytes); !ok) return ok;
    std::memcpy(buffer.data(), values.data(), bytes);
    return {};
  };
  if (normals.empty()) normals.emplace_back(0.0f);
  if (auto ok = ensure(m_frame, GpuBufferUse::Uniform, sizeof m_frameBlock); !ok) return ok;
  std::memcpy(m_frame.data(), &m_frameBlock, sizeof m_frameBlock);
  if (auto ok = send(m_chunks, chunks); !ok) return ok;
  if (auto ok = send(m_runs, runs); !ok) return ok;
  if (auto ok = send(m_normals, normals); !ok) return ok;
  if (auto ok = ensure(m_points, GpuBufferUse::Storage, points * sizeof(DisplayPoint)); !ok) return ok;
  parallelFor(batch.runs.size(), 16, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t r = first; r < last; ++r)
      std::memcpy(m_points.data() + at[r] * sizeof(DisplayPoint), batch.runs[r]->points + batch.firstPoint[r],
                  batch.pointCount[r] * sizeof(DisplayPoint));
  });
  return {};
}

Result<void> VulkanSplatter::dispatch(const GpuPipeline& pipeline, const std::vector<GpuBuffer>& planes) {
  std::vector<GpuResource> resources{m_frame, m_points, m_chunks, m_runs, m_normals};
  resources.insert(resources.end(), planes.begin(), planes.end());
  auto bindings = m_device->makeBindings(pipeline, resources);
  if (!bindings) return fail(bindings.error());
  const std::uint32_t groups = m_frameBlock.frame.w;
  return m_device->run([&](GpuCommands& commands) {
    commands.bind(pipeline, *bindings);
    commands.dispatch(std::min(groups, kRow), (groups + kRow - 1) / kRow);
  });
}

Result<void> VulkanSplatter::drawBatches(const std::vector<Batch>& batches, SplatPayload payload) {
  const bool isPacked = payload != SplatPayload::None;
  for (const Batch& batch : batches) {
    if (auto ok = upload(batch, payload); !ok) return ok;
    auto ok = m_wide && isPacked ? dispatch(m_packed, {m_plane}) : dispatch(m_depth, {m_plane, m_payloads});
    if (!ok) return ok;
  }
  if (m_wide || !isPacked) return {};
  for (const Batch& batch : batches) {
    if (batches.size() > 1)
      if (auto ok = upload(batch, payload); !ok) return ok;
    if (auto ok = dispatch(m_payload, {m_plane, m_payloads}); !ok) return ok;
  }
  return {};
}

Result<const void*> VulkanSplatter::collect(std::size_t pixels, bool isPacked) {
  const bool isTwo = isPacked && !m_wide;
  auto ran = m_device->run([&](GpuCommands& commands) {
    commands.copy(m_plane, m_readBack);
    if (isTwo) commands.copy(m_payloads, m_payloadsBack);
  });
  if (!ran) return fail(ran.error());
  if (!isTwo) return static_cast<const void*>(m_readBack.data());
  m_joined.resize(pixels);
  const auto* depths = reinterpret_cast<const std::uint32_t*>(m_readBack.data());
  const auto* payloads = reinterpret_cast<const std::uint32_t*>(m_payloadsBack.data());
  // A depth without a payload is one that the second pass rounded differently: nothing is drawn there.
  for (std::size_t i = 0; i < pixels; ++i)
    m_joined[i] = payloads[i] == kNone ? ~std::uint64_t{0} : std::uint64_t{depths[i]} << 32 | payloads[i];
  return static_cast<const void*>(m_joined.data());
}

Result<const void*> VulkanSplatter::draw(std::span<const SplatRun* const> runs, const SplatLevels& levels, SplatPayload payload) {
  const std::size_t pixels = levels.pixels();
  const bool isPacked = payload != SplatPayload::None;
  if (auto ok = ensurePlanes(pixels, isPacked); !ok) return fail(ok.error());
  m_device->reloadChangedShaders();
  auto cleared = m_device->run([&](GpuCommands& commands) {
    commands.fill(m_plane, kNone);
    if (m_payloads) commands.fill(m_payloads, kNone);
  });
  if (!cleared) return fail(cleared.error());
  if (!runs.empty()) {
    const SplatView& view = runs.front()->view;
    m_frameBlock.lens = lensUniform(*static_cast<const Camera*>(view.camera));
    m_frameBlock.fold = {std::min(view.foldBackSquared, 1e30f), static_cast<float>(levels.count - 1), 0, 0};
    m_frameBlock.frame = {levels.columns[0], levels.rows[0], payload == SplatPayload::Colour ? 1 : 0, 0};
    for (int k = 0; k < levels.count; ++k) {
      const int margin = k == 0 ? 0 : SplatLevels::kMargin;
      m_frameBlock.levels[static_cast<std::size_t>(k)] = {levels.columns[k], levels.rows[k], levels.start[k], margin};
    }
  }
  if (auto ok = drawBatches(batchesOf(runs), payload); !ok) return fail(ok.error());
  return collect(pixels, isPacked);
}

}  // namespace

Result<std::unique_ptr<SplatDevice>> createVulkanSplatter(const std::shared_ptr<GpuDevice>& device,
                                                          bool wide) {
  auto splatter = std::make_unique<VulkanSplatter>(device, wide);
  if (auto made = splatter->makePipelines(); !made) return fail(made.error());
  return splatter;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "gpu/gpu_resources.h"

namespace alidade {

/// A target of a pass: cleared to `clear` where given, else its content is kept, or left undefined
/// where the pass writes every pixel itself.
struct GpuPassTarget {
  GpuImage image;
  std::optional<std::array<float, 4>> clear;  ///< whole numbers for unsigned formats; [0] for depth
  bool isOverwritten = false;
};

struct GpuPass {
  std::vector<GpuPassTarget> colours;
  std::optional<GpuPassTarget> depth;
};

/// Commands of one GpuDevice::run(), in order. Each call that uses an image first moves it to the
/// layout it needs, with the barrier between its last use and this one.
class GpuCommands {
 public:
  struct State;
  explicit GpuCommands(State& state) : m_state(state) {}
  GpuCommands(const GpuCommands&) = delete;
  GpuCommands& operator=(const GpuCommands&) = delete;

  /// Whole image from the start of a buffer of at least its size, rows without padding.
  void upload(const GpuBuffer& from, const GpuImage& to);
  /// Whole image into the start of a buffer; the host may read it after run() returned.
  void readBack(const GpuImage& from, const GpuBuffer& to);

  /// The same word everywhere in a DeviceStorage buffer.
  void fill(const GpuBuffer& buffer, std::uint32_t word);
  /// The start of a DeviceStorage buffer into the whole of a Readback one; see readBack.
  void copy(const GpuBuffer& from, const GpuBuffer& to);

  /// Readies an image for sampling in what follows.
  void toSampled(const GpuImage& image);

  void beginPass(const GpuPass& pass);
  void endPass();
  void bind(const GpuPipeline& pipeline, const GpuBindings& bindings);
  void bindVertices(const GpuBuffer& vertices);
  void bindIndices(const GpuBuffer& indices);  ///< 32-bit
  void draw(std::uint32_t vertexCount);
  void drawIndexed(std::uint32_t indexCount);

  /// Compute; storage buffers that it wrote can be read by the host after run() returned.
  void dispatch(std::uint32_t groupsX, std::uint32_t groupsY = 1);

 private:
  State& m_state;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "gpu/gpu_commands.h"
#include "gpu/gpu_resources.h"

namespace alidade {

/// A Vulkan 1.3 device without a surface: own instance, one queue, one run at a time.
///
/// Prefers a discrete device, then an integrated one, then one on the CPU (lavapipe);
/// ALIDADE_VULKAN_DEVICE picks by number or by a part of the name. ALIDADE_VULKAN_VALIDATION=1
/// switches the validation layer on, whose warnings and errors are logged and counted. Every failed
/// Vulkan call comes back as an Error that names it. Not thread-safe.
class GpuDevice {
 public:
  static Result<std::shared_ptr<GpuDevice>> create();
  ~GpuDevice();

  const std::string& name() const;
  bool isSoftware() const;             ///< runs on the CPU
  bool isValidated() const;            ///< the validation layer is on
  int validationMessageCount() const;  ///< warnings and errors since the device was made
  int maximumImageSize() const;        ///< pixels along an edge

  bool hasAtomics64() const;           ///< 64-bit integers and atomics on them in storage buffers
  std::size_t maximumStorageSize() const;  ///< bytes that a shader sees of one storage buffer

  Result<GpuBuffer> makeBuffer(GpuBufferUse use, std::size_t bytes);
  Result<GpuImage> makeImage(GpuFormat format, int width, int height);
  Result<GpuPipeline> makePipeline(const GpuGraphicsDescription& description);
  Result<GpuPipeline> makePipeline(const GpuComputeDescription& description);
  /// One resource a binding, in order, of the kinds that the pipeline names.
  Result<GpuBindings> makeBindings(const GpuPipeline& pipeline, const std::vector<GpuResource>& resources);

  /// Records, submits and waits. The first failed command is returned.
  Result<void> run(const std::function<void(GpuCommands&)>& record);

  /// Development builds: recompiles shaders whose sources changed on disk and swaps the pipelines that use
  /// them; a shader that does not compile is logged and its old pipeline kept. Does nothing otherwise.
  void reloadChangedShaders();

  struct Core;

 private:
  explicit GpuDevice(std::shared_ptr<Core> core);
  std::shared_ptr<Core> m_core;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "gpu/gpu_types.h"

namespace alidade {

// Handles to things on a GpuDevice: movable, freed with their last owner, and they keep their device
// alive. An empty handle (default-made) may only be assigned to.

/// Memory that both sides see. `data()` stays mapped; the device reads it from the next run() on. DeviceStorage is
/// the device's alone: no data(), filled and copied by commands.
class GpuBuffer {
 public:
  struct State;
  GpuBuffer() = default;
  explicit GpuBuffer(std::shared_ptr<State> state) : m_state(std::move(state)) {}
  explicit operator bool() const { return m_state != nullptr; }

  std::size_t size() const;  ///< bytes
  std::byte* data();
  const std::byte* data() const;
  State& state() const { return *m_state; }

 private:
  std::shared_ptr<State> m_state;
};

/// A two-dimensional picture on the device, one mip level. It remembers the layout it was left in;
/// GpuCommands moves it to the next one.
class GpuImage {
 public:
  struct State;
  GpuImage() = default;
  explicit GpuImage(std::shared_ptr<State> state) : m_state(std::move(state)) {}
  explicit operator bool() const { return m_state != nullptr; }

  int width() const;
  int height() const;
  GpuFormat format() const;
  std::size_t byteCount() const;
  State& state() const { return *m_state; }

 private:
  std::shared_ptr<State> m_state;
};

/// A compiled pass. In development builds it follows its shader sources on disk.
class GpuPipeline {
 public:
  struct State;
  GpuPipeline() = default;
  explicit GpuPipeline(std::shared_ptr<State> state) : m_state(std::move(state)) {}
  explicit operator bool() const { return m_state != nullptr; }
  State& state() const { return *m_state; }

 private:
  std::shared_ptr<State> m_state;
};

/// What a pipeline's bindings point at; keeps those resources alive.
class GpuBindings {
 public:
  struct State;
  GpuBindings() = default;
  explicit GpuBindings(std::shared_ptr<State> state) : m_state(std::move(state)) {}
  explicit operator bool() const { return m_state != nullptr; }
  State& state() const { return *m_state; }

 private:
  std::shared_ptr<State> m_state;
};

using GpuResource = std::variant<GpuBuffer, GpuImage>;

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace alidade {

enum class GpuFormat { Rgba8, Rg8, R8Uint, R32Float, R32Uint, Depth32 };

/// Bytes of one texel.
std::size_t bytesPerPixel(GpuFormat format);

/// What a buffer is for; all but DeviceStorage are visible to the host and stay mapped.
enum class GpuBufferUse { Vertex, Index, Uniform, Storage, DeviceStorage, Upload, Readback };

/// What a shader sees at a binding of set 0.
enum class GpuBindingKind { Uniform, Storage, SampledNearest, SampledLinear };

/// How a colour target takes what is drawn. Maximum keeps the larger value channel by channel, so
/// that overlapping pieces neither darken nor depend on their order.
enum class GpuBlend { Replace, Maximum };

struct GpuColourTarget {
  GpuFormat format = GpuFormat::Rgba8;
  GpuBlend blend = GpuBlend::Replace;
};

struct GpuVertexAttribute {
  enum class Kind { Float, Vec3, Uint };
  Kind kind = Kind::Float;
  std::uint32_t offset = 0;  ///< bytes into the vertex
};

/// A pass's fixed state. Shaders are named as their sources ("design_surface.vert") and come from
/// the shader folder; specialisation constant i takes `constants[i]`.
struct GpuGraphicsDescription {
  std::string vertexShader;
  std::string fragmentShader;
  std::uint32_t vertexStride = 0;              ///< bytes; 0: the vertex shader fetches by itself
  std::vector<GpuVertexAttribute> attributes;  ///< location = index
  std::vector<GpuColourTarget> targets;
  bool depthTest = false;  ///< reversed: greater is nearer
  bool depthWrite = false;
  std::vector<GpuBindingKind> bindings;  ///< binding = index
  std::vector<std::uint32_t> constants;
};

struct GpuComputeDescription {
  std::string shader;
  std::vector<GpuBindingKind> bindings;
  std::vector<std::uint32_t> constants;
};

}  // namespace alidade

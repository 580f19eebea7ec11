// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/noise.h"

#include <cmath>
#include <cstdint>

namespace alidade {

namespace {

inline std::uint32_t hashCell(int x, int y, int z) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8DA6B343u ^
                    static_cast<std::uint32_t>(y) * 0xD8163841u ^ static_cast<std::uint32_t>(z) * 0xCB1AB31Fu;
  h ^= h >> 15;
  h *= 0x2C1B3C6Du;
  h ^= h >> 12;
  h *= 0x297A2D39u;
  return h ^ (h >> 15);
}

/// std::floor is a call on the baseline instruction set; this is two instructions.
inline int floorToInt(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < static_cast<float>(truncated));
}

inline float fade(float t) {
  return t * t * (3.0f - 2.0f * t);
}
inline float mix(float a, float b, float t) {
  return a + (b - a) * t;
}

/// How much of an octave is left at this footprint.
float octaveWeight(float wavelength, float footprint) {
  return footprint <= 0 ? 1.0f : glm::clamp(wavelength / (2.0f * footprint) - 0.5f, 0.0f, 1.0f);
}

inline float toUnit(std::uint32_t hash) {
  return static_cast<float>(hash >> 8) * 0x1.0p-24f;
}

inline float lattice(const glm::vec3& p) {
  const int x = floorToInt(p.x), y = floorToInt(p.y), z = floorToInt(p.z);
  const glm::vec3 t = p - glm::vec3(x, y, z);
  const float fx = fade(t.x), fy = fade(t.y), fz = fade(t.z);
  const auto at = [=](int i, int j, int k) { return toUnit(hashCell(x + i, y + j, z + k)); };
  const float low = mix(mix(at(0, 0, 0), at(1, 0, 0), fx), mix(at(0, 1, 0), at(1, 1, 0), fx), fy);
  const float high = mix(mix(at(0, 0, 1), at(1, 0, 1), fx), mix(at(0, 1, 1), at(1, 1, 1), fx), fy);
  return mix(low, high, fz);
}

inline float lattice(const glm::vec2& p) {
  const int x = floorToInt(p.x), y = floorToInt(p.y);
  const glm::vec2 t = p - glm::vec2(x, y);
  const auto at = [=](int i, int j) { return toUnit(hashCell(x + i, y + j, 911)); };
  const float fx = fade(t.x);
  return mix(mix(at(0, 0), at(1, 0), fx), mix(at(0, 1), at(1, 1), fx), fade(t.y));
}

template <class Vector>
float fractal(Vector p, int octaves, float footprint) {
  float sum = 0.5f;
  float amplitude = 0.5f;
  float wavelength = 1.0f;
  for (int i = 0; i < octaves; ++i) {
    const float weight = octaveWeight(wavelength, footprint);
    if (weight <= 0) break;
    sum += amplitude * weight * (lattice(p) - 0.5f);
    p = p * 2.03f + Vector(17.31f);
    amplitude *= 0.55f;
    wavelength *= 0.4926f;
  }
  return glm::clamp(sum, 0.0f, 1.0f);
}

}  // namespace

float cellNoise(int x, int y, int z) {
  return toUnit(hashCell(x, y, z));
}

float valueNoise(const glm::vec3& p) {
  return lattice(p);
}
float valueNoise(const glm::vec2& p) {
  return lattice(p);
}

float fractalNoise(const glm::vec3& p, int octaves, float footprint) {
  return fractal(p, octaves, footprint);
}
float fractalNoise(const glm::vec2& p, int octaves, float footprint) {
  return fractal(p, octaves, footprint);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/noise.h"

#include <cmath>
#include <cstdint>

namespace alidade {

namespace {

std::uint32_t hashCell(int x, int y, int z) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8DA6B343u ^ static_cast<std::uint32_t>(y) * 0xD8163841u ^
                    static_cast<std::uint32_t>(z) * 0xCB1AB31Fu;
  h ^= h >> 15;
  h *= 0x2C1B3C6Du;
  h ^= h >> 12;
  h *= 0x297A2D39u;
  return h ^ (h >> 15);
}

/// std::floor is a call on the baseline instruction set; this is two instructions.
int floorToInt(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < static_cast<float>(truncated));
}

float fade(float t) { return t * t * (3.0f - 2.0f * t); }
float mix(float a, float b, float t) { return a + (b - a) * t; }

/// How much of an octave is left at this footprint.
float octaveWeight(float wavelength, float footprint) {
  return footprint <= 0 ? 1.0f : glm::clamp(wavelength / (2.0f * footprint) - 0.5f, 0.0f, 1.0f);
}

template <class Vector>
float fractal(Vector p, int octaves, float footprint) {
  float sum = 0.5f;
  float amplitude = 0.5f;
  float wavelength = 1.0f;
  for (int i = 0; i < octaves; ++i) {
    const float weight = octaveWeight(wavelength, footprint);
    if (weight <= 0) break;
    sum += amplitude * weight * (valueNoise(p) - 0.5f);
    p = p * 2.03f + Vector(17.31f);
    amplitude *= 0.55f;
    wavelength *= 0.4926f;
  }
  return glm::clamp(sum, 0.0f, 1.0f);
}

}  // namespace

float cellNoise(int x, int y, int z) { return static_cast<float>(hashCell(x, y, z) >> 8) * 0x1.0p-24f; }

float valueNoise(const glm::vec3& p) {
  const int x = floorToInt(p.x), y = floorToInt(p.y), z = floorToInt(p.z);
  const glm::vec3 t = p - glm::vec3(x, y, z);
  const float fx = fade(t.x), fy = fade(t.y), fz = fade(t.z);
  const float low = mix(mix(cellNoise(x, y, z), cellNoise(x + 1, y, z), fx),
                        mix(cellNoise(x, y + 1, z), cellNoise(x + 1, y + 1, z), fx), fy);
  const float high = mix(mix(cellNoise(x, y, z + 1), cellNoise(x + 1, y, z + 1), fx),
                         mix(cellNoise(x, y + 1, z + 1), cellNoise(x + 1, y + 1, z + 1), fx), fy);
  return mix(low, high, fz);
}

float valueNoise(const glm::vec2& p) {
  const int x = floorToInt(p.x), y = floorToInt(p.y);
  const glm::vec2 t = p - glm::vec2(x, y);
  const float fx = fade(t.x), fy = fade(t.y);
  return mix(mix(cellNoise(x, y, 911), cellNoise(x + 1, y, 911), fx),
             mix(cellNoise(x, y + 1, 911), cellNoise(x + 1, y + 1, 911), fx), fy);
}

float fractalNoise(const glm::vec3& p, int octaves, float footprint) { return fractal(p, octaves, footprint); }
float fractalNoise(const glm::vec2& p, int octaves, float footprint) { return fractal(p, octaves, footprint); }

}  // namespace alidade

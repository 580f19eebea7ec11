// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/lighting.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "simulate/materials.h"
#include "simulate/noise.h"

namespace alidade {

namespace {

const glm::vec3 kSun = glm::vec3(1.0f, 0.93f, 0.80f) * 2.6f;
const glm::vec3 kSkyLight = glm::vec3(0.72f, 0.86f, 1.06f) * 0.85f;
const glm::vec3 kBounce = glm::vec3(0.40f, 0.36f, 0.31f) * 0.55f;
constexpr int kDirections = 56;

/// Even directions over the sphere (Fibonacci lattice).
glm::dvec3 sphereDirection(int i, int count) {
  const double z = 1.0 - 2.0 * (i + 0.5) / count;
  const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

/// The display curve over the square root of the radiance, from 0 to kCurveTop.
constexpr float kCurveSteps = 1024.0f;
constexpr float kCurveTop = 3.0f;

std::vector<float> displayCurve() {
  std::vector<float> curve;
  for (int i = 0; i <= static_cast<int>(kCurveSteps); ++i) {
    const float root = static_cast<float>(i) * kCurveTop / kCurveSteps;
    const float x = root * root * 0.80f;
    const float shouldered = x < 0.6f ? x : 0.6f + 0.4f * (1.0f - std::exp(-(x - 0.6f) / 0.4f));
    curve.push_back(shouldered <= 0.0031308f ? 12.92f * shouldered
                                             : 1.055f * std::pow(shouldered, 1.0f / 2.4f) - 0.055f);
  }
  return curve;
}

float skyWeight(const glm::dvec3& d) {
  return d.z > -0.05 ? 1.0f : 0.28f;
}

}  // namespace

Lighting::Lighting(const RayScene& scene)
    : m_scene(scene), m_towardsSun(glm::normalize(glm::vec3(-0.62f, -0.60f, 0.72f))) {
  bake();
}

void Lighting::bake() {
  const std::size_t count = static_cast<std::size_t>(m_cells.x) * m_cells.y * m_cells.z;
  m_open.assign(count, {});
  parallelFor(count, 256, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      const int x = static_cast<int>(i) % m_cells.x, y = static_cast<int>(i) / m_cells.x % m_cells.y;
      const int z = static_cast<int>(i) / (m_cells.x * m_cells.y);
      const glm::dvec3 centre = glm::dvec3(m_low) + static_cast<double>(m_cell) * glm::dvec3(x, y, z);
      std::array<float, 6> seen{}, all{};
      int fromBehind = 0;
      for (int d = 0; d < kDirections; ++d) {
        const glm::dvec3 direction = sphereDirection(d, kDirections);
        const RayHit hit = m_scene.intersect(centre, direction, 14.0);
        if (hit) {
          const auto& t = m_scene.mesh().triangles[hit.triangle];
          const auto& p = m_scene.mesh().positions;
          fromBehind += glm::dot(glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]), direction) > 0;
        }
        // A far hit still lets most of the light through: the sky beside it and what the surface sends back.
        const float open =
            hit ? 0.16f * static_cast<float>(std::min(1.0, hit.distance / 6.0)) : skyWeight(direction);
        for (int axis = 0; axis < 3; ++axis) {
          const auto cosine = static_cast<float>(direction[axis]);
          const int face = 2 * axis + (cosine < 0);
          seen[face] += std::abs(cosine) * open;
          all[face] += std::abs(cosine);
        }
      }
      for (int face = 0; face < 6; ++face)
        m_open[i][face] = fromBehind > kDirections / 4 ? -1.0f : seen[face] / all[face];
    }
  });
}

float Lighting::openness(const glm::vec3& position, const glm::vec3& normal) const {
  const glm::vec3 q = (position + 0.3f * normal - m_low) / m_cell;
  const glm::vec3 base = glm::floor(q);
  const glm::ivec3 cell(base);
  const glm::vec3 squared = normal * normal;
  const glm::ivec3 face(normal.x < 0, 2 + (normal.y < 0), 4 + (normal.z < 0));
  const float outside = 0.5f * (1.0f + normal.z) + 0.28f * 0.5f * (1.0f - normal.z);
  if (glm::any(glm::lessThan(cell, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(cell + 1, m_cells)))
    return outside;
  const glm::vec3 t = q - base;
  float sum = 0, weights = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
    const glm::ivec3 c = cell + step;
    const auto& open = m_open[static_cast<std::size_t>(c.z) * m_cells.x * m_cells.y + c.y * m_cells.x + c.x];
    if (open[0] < 0) continue;
    const glm::vec3 w = glm::mix(1.0f - t, t, glm::vec3(step));
    const float weight = w.x * w.y * w.z + 1e-4f;
    sum += weight * (squared.x * open[face.x] + squared.y * open[face.y] + squared.z * open[face.z]);
    weights += weight;
  }
  return weights > 0 ? sum / weights : 0.12f;
}

glm::vec3 Lighting::shade(const glm::dvec3& position, const RayHit& hit, const glm::vec3& toViewer,
                          float footprint, bool* sunlit) const {
  const SiteObject& object = m_scene.objectOf(hit.triangle);
  const glm::vec3 albedo = surfaceAlbedo(object, position, hit.faceNormal, footprint);
  const float facing = glm::dot(hit.normal, m_towardsSun);
  const glm::dvec3 lifted = position + 2e-3 * glm::dvec3(hit.faceNormal);
  const bool lit = facing > 0 && glm::dot(hit.faceNormal, m_towardsSun) > 0 &&
                   !m_scene.occluded(lifted, glm::dvec3(m_towardsSun), 150.0);
  if (sunlit) *sunlit = lit;
  const float open = openness(glm::vec3(position), hit.faceNormal);
  glm::vec3 light = kSkyLight * open + kBounce * (0.35f + 0.65f * open);
  if (lit) light += kSun * facing;
  glm::vec3 radiance = albedo * light;
  const glm::vec2 gloss = surfaceGloss(object.material);
  if (gloss.x > 0) {
    const glm::vec3 mirrored = 2.0f * glm::dot(hit.normal, toViewer) * hit.normal - toViewer;
    const float fresnel =
        0.15f + 0.85f * std::pow(1.0f - glm::clamp(glm::dot(hit.normal, toViewer), 0.0f, 1.0f), 4.0f);
    radiance += gloss.x * fresnel * open * sky(mirrored);
    if (lit)
      radiance += gloss.x * 0.6f * std::pow(std::max(0.0f, glm::dot(mirrored, m_towardsSun)), gloss.y) * kSun;
  }
  return radiance;
}

glm::vec3 Lighting::sky(const glm::vec3& direction) {
  const float up = std::max(direction.z, 0.0f);
  glm::vec3 colour =
      glm::mix(glm::vec3(0.92f, 0.96f, 1.0f), glm::vec3(0.20f, 0.40f, 0.78f), std::pow(up, 0.55f));
  if (direction.z > 0.02f) {
    const glm::vec2 plane = glm::vec2(direction) / (direction.z + 0.12f);
    const float cloud = fractalNoise(plane * 0.9f + 3.0f, 5, 0.02f);
    const float cover =
        glm::clamp((cloud - 0.52f) * 5.0f, 0.0f, 1.0f) * glm::clamp(direction.z * 8.0f, 0.0f, 1.0f);
    colour = glm::mix(colour, glm::vec3(1.05f, 1.05f, 1.04f), 0.75f * cover);
  }
  return colour * 1.15f;
}

glm::vec3 displayColour(const glm::vec3& radiance) {
  static const std::vector<float> curve = displayCurve();
  glm::vec3 out;
  for (int i = 0; i < 3; ++i) {
    const float x = glm::clamp(std::sqrt(std::max(0.0f, radiance[i])) * kCurveSteps / kCurveTop, 0.0f,
                               kCurveSteps - 1.001f);
    const int step = static_cast<int>(x);
    out[i] = glm::mix(curve[step], curve[step + 1], x - static_cast<float>(step));
  }
  return out;
}

}  // namespace alidade

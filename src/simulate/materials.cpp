// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/materials.h"

#include <algorithm>
#include <cmath>

#include "simulate/noise.h"

namespace alidade {

namespace {

using glm::vec2;
using glm::vec3;

/// What a texture needs to know of the place: in the object's own axes.
struct Place {
  vec3 p;       ///< metres, object axes
  vec2 face;    ///< coordinates in the face: along and up (walls), x and y (floors)
  vec3 site;    ///< metres, site frame
  vec3 normal;  ///< object axes
  vec3 siteNormal;
  float footprint;
};

float smoothStep(float low, float high, float x) {
  const float t = glm::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

/// Coverage of a line of this width that repeats every `period`, blurred by the footprint.
float lineCover(float x, float period, float width, float footprint) {
  const float d = std::abs(x - period * std::round(x / period));
  const float blur = std::max(footprint, 1e-4f);
  if (blur > period) return width / period;
  const float hard = 1.0f - smoothStep(0.5f * width - 0.5f * blur, 0.5f * width + 0.5f * blur, d);
  return hard * std::min(1.0f, width / blur + 0.15f);
}

vec3 concrete(const Place& at, float tone) {
  const float blotch = fractalNoise(at.p * 0.9f, 4, at.footprint * 0.9f);
  const float grain = fractalNoise(at.p * 14.0f, 2, at.footprint * 14.0f);
  return vec3(0.42f, 0.41f, 0.385f) * tone * (0.68f + 0.50f * blotch + 0.22f * (grain - 0.5f));
}

/// Cast against panels: joints every 1.2 m and 0.9 m, tie holes, faint board lines, rain streaks.
vec3 formedConcrete(const Place& at) {
  vec3 colour = concrete(at, 1.05f);
  if (std::abs(at.normal.z) < 0.7f) {
    const int panelX = static_cast<int>(std::floor(at.face.x / 1.2f)),
              panelY = static_cast<int>(std::floor(at.face.y / 0.9f));
    colour *= 0.93f + 0.14f * cellNoise(panelX, panelY, 3);
    const float joint = std::max(lineCover(at.face.x, 1.2f, 0.006f, at.footprint),
                                 lineCover(at.face.y, 0.9f, 0.006f, at.footprint));
    colour *= 1.0f - 0.5f * joint;
    const vec2 cell(at.face.x - 0.6f, at.face.y - 0.45f);
    const vec2 hole(cell.x - 1.2f * std::round(cell.x / 1.2f), cell.y - 0.9f * std::round(cell.y / 0.9f));
    const float blur = std::max(at.footprint, 0.002f);
    colour *= 1.0f - 0.6f * (1.0f - smoothStep(0.013f - blur * 0.5f, 0.013f + blur, glm::length(hole))) *
                         std::min(1.0f, 0.02f / blur);
    const float streak = fractalNoise(vec2(at.face.x * 6.0f, at.face.y * 0.5f), 3, at.footprint * 6.0f);
    colour *= 0.90f + 0.20f * streak;
  }
  return colour;
}

vec3 screed(const Place& at) {
  vec3 colour = concrete(at, 0.92f);
  const float stain = fractalNoise(vec2(at.site) * 0.45f, 4, at.footprint * 0.45f);
  colour *= 1.0f - 0.35f * smoothStep(0.55f, 0.72f, stain);
  const float dust = fractalNoise(vec2(at.site) * 1.7f + 31.0f, 3, at.footprint * 1.7f);
  return glm::mix(colour, vec3(0.36f, 0.29f, 0.20f), 0.35f * smoothStep(0.55f, 0.8f, dust));
}

vec3 brick(const Place& at) {
  constexpr float course = 0.0775f, length = 0.25f, joint = 0.011f;
  const float row = std::floor(at.face.y / course);
  const float along = at.face.x + (static_cast<int>(row) & 1 ? 0.5f * length : 0.0f);
  const int column = static_cast<int>(std::floor(along / length));
  const float variation = cellNoise(column, static_cast<int>(row), 17);
  const float keep = glm::clamp(1.5f - at.footprint / 0.12f, 0.0f, 1.0f);
  vec3 colour =
      glm::mix(vec3(0.29f, 0.12f, 0.075f), vec3(0.42f, 0.20f, 0.125f), glm::mix(0.5f, variation, keep));
  if (variation > 0.93f) colour *= glm::mix(1.0f, 0.6f, keep);
  colour *= 0.75f + 0.5f * fractalNoise(at.p * 9.0f, 3, at.footprint * 9.0f);
  const float mortar = std::max(lineCover(at.face.y, course, joint, at.footprint),
                                lineCover(along, length, joint, at.footprint));
  return glm::mix(colour, vec3(0.46f, 0.43f, 0.38f), mortar);
}

vec3 gravelPattern(const Place& at, float size, const vec3& dark, const vec3& light) {
  const vec3 q = at.site / size;
  const float fine = fractalNoise(q, 3, at.footprint / size);
  const float coarse = fractalNoise(at.site * 1.1f, 3, at.footprint * 1.1f);
  return glm::mix(dark, light, glm::clamp(1.7f * (fine - 0.5f) + 0.5f + 0.5f * (coarse - 0.5f), 0.0f, 1.0f));
}

/// Stones of some centimetres: each lattice cell has a tone of its own, with dark gaps between.
vec3 gravel(const Place& at) {
  const vec3 n = at.site * 31.0f;
  // The lattice is bent by its own size, or the stones would lie in rows.
  const vec3 bend(valueNoise(n), valueNoise(n + 37.0f), valueNoise(n + 71.0f));
  const vec3 q = at.site / 0.045f + 2.2f * (bend - 0.5f);
  const vec3 base = glm::floor(q);
  const float tone = cellNoise(static_cast<int>(base.x), static_cast<int>(base.y), static_cast<int>(base.z));
  const vec3 inCell = glm::abs(q - base - 0.5f);
  const float gap = smoothStep(0.34f, 0.5f, std::max(inCell.x, inCell.y));
  const float keep = glm::clamp(1.4f - at.footprint / 0.035f, 0.0f, 1.0f);
  const float coarse = fractalNoise(at.site * 1.1f, 3, at.footprint * 1.1f);
  const float mean = 0.42f + 0.20f * (coarse - 0.5f);
  return vec3(1.0f, 0.97f, 0.91f) *
         glm::mix(mean * 0.85f, (0.22f + 0.36f * tone) * (1.0f - 0.6f * gap), keep);
}

vec3 asphalt(const Place& at) {
  vec3 colour = gravelPattern(at, 0.02f, vec3(0.055f, 0.055f, 0.06f), vec3(0.125f, 0.12f, 0.12f));
  const float dirt = fractalNoise(vec2(at.site.x * 0.25f, at.site.y * 0.9f), 4, at.footprint);
  return glm::mix(colour, vec3(0.30f, 0.24f, 0.17f), 0.75f * smoothStep(0.48f, 0.72f, dirt));
}

/// The ground: soil with tracks and puddles, gravel around the building, asphalt on the road, grass far off.
vec3 ground(const Place& at) {
  const vec2 xy(at.site);
  if (xy.y < -10.4f && xy.y > -17.3f) return asphalt(at);
  const float wander = fractalNoise(xy * 0.55f, 4, at.footprint * 0.55f) - 0.5f;
  const float damp = fractalNoise(xy * 0.22f + 7.0f, 4, at.footprint * 0.22f);
  vec3 colour = gravelPattern(at, 0.055f, vec3(0.155f, 0.105f, 0.065f), vec3(0.36f, 0.27f, 0.185f));
  colour *= 1.0f - 0.42f * smoothStep(0.52f, 0.68f, damp);
  const float stones = fractalNoise(at.site * 23.0f, 2, at.footprint * 23.0f);
  colour = glm::mix(colour, vec3(0.42f, 0.40f, 0.36f), 0.55f * smoothStep(0.66f, 0.70f, stones));
  for (const float track : {-12.3f, -13.9f, 10.0f}) {
    const bool alongX = track < 0;
    const float across = (alongX ? xy.y : xy.x) - track + 0.25f * wander;
    const float tread = 1.0f - smoothStep(0.14f, 0.24f, std::abs(across));
    const float lugs = 0.5f + 0.5f * std::sin((alongX ? xy.x : xy.y) * 38.0f) *
                                  glm::clamp(1.4f - at.footprint / 0.05f, 0.0f, 1.0f);
    colour *= 1.0f - tread * (0.18f + 0.22f * lugs);
  }
  const vec2 beyond = glm::max(glm::abs(xy) - vec2(9.0f, 6.0f), vec2(0.0f));
  const float apron = 1.0f - smoothStep(0.9f, 1.7f, glm::length(beyond) + 1.2f * wander);
  if (apron > 0) colour = glm::mix(colour, gravel(at), apron);
  const float road = (1.0f - smoothStep(-10.4f, -10.25f, xy.y)) * smoothStep(-17.6f, -17.3f, xy.y);
  if (road > 0) colour = glm::mix(colour, asphalt(at), road);
  const float meadow =
      smoothStep(21.0f, 24.0f, glm::length(xy * vec2(0.9f, 1.0f)) + 3.0f * wander) * (1.0f - road);
  if (meadow <= 0) return colour;
  const float blades = fractalNoise(xy * 5.0f, 4, at.footprint * 5.0f);
  return glm::mix(colour, glm::mix(vec3(0.09f, 0.14f, 0.04f), vec3(0.24f, 0.28f, 0.09f), blades), meadow);
}

vec3 wood(const Place& at, const vec3& dark, const vec3& light) {
  const vec3 a = glm::abs(at.normal);
  // The grain runs along the longer horizontal axis of the boards.
  const vec3 q(at.p.x * 0.7f, at.p.y * 16.0f, at.p.z * 16.0f);
  const float grain = fractalNoise(a.x > 0.8f ? at.p * 20.0f : q, 3, at.footprint * 12.0f);
  return glm::mix(dark, light, glm::clamp(1.5f * (grain - 0.5f) + 0.5f, 0.0f, 1.0f));
}

vec3 paintedSteel(const Place& at) {
  const float rust = fractalNoise(at.p * 2.3f, 4, at.footprint * 2.3f);
  const float streak = fractalNoise(vec2(at.face.x * 9.0f, at.face.y * 0.7f), 3, at.footprint * 9.0f);
  return glm::mix(vec3(0.82f + 0.36f * (streak - 0.5f)), vec3(0.9f, 0.6f, 0.45f),
                  0.6f * smoothStep(0.66f, 0.78f, rust));
}

/// Two black and two white quadrants within a white rim.
vec3 target(const Place& at) {
  const vec2 q(at.p.x, at.p.y);
  const vec3 white(0.82f), black(0.02f);
  if (std::max(std::abs(q.x), std::abs(q.y)) > 0.105f) return white;
  const float blur = std::max(at.footprint, 1e-4f);
  const float sx = glm::clamp(q.x / blur, -1.0f, 1.0f), sy = glm::clamp(q.y / blur, -1.0f, 1.0f);
  return glm::mix(black, white, 0.5f + 0.5f * sx * sy);
}

vec3 baseColour(Material material, const Place& at) {
  switch (material) {
    case Material::Concrete:
      return concrete(at, 1.0f);
    case Material::FormedConcrete:
      return formedConcrete(at);
    case Material::ScreedConcrete:
      return screed(at);
    case Material::Brick:
      return brick(at);
    case Material::Soil:
      return ground(at);
    case Material::Gravel:
      return gravel(at);
    case Material::Sand:
      return gravelPattern(at, 0.02f, vec3(0.40f, 0.31f, 0.19f), vec3(0.60f, 0.49f, 0.32f));
    case Material::Asphalt:
      return asphalt(at);
    case Material::Grass:
      return vec3(0.16f, 0.22f, 0.07f);
    case Material::Wood:
      return wood(at, vec3(0.26f, 0.17f, 0.09f), vec3(0.52f, 0.38f, 0.22f));
    case Material::Plywood:
      return wood(at, vec3(0.44f, 0.36f, 0.24f), vec3(0.58f, 0.50f, 0.36f));
    case Material::Galvanised:
      return vec3(0.40f, 0.42f, 0.43f) * (0.75f + 0.5f * fractalNoise(at.p * 6.0f, 2, at.footprint * 6.0f));
    case Material::PaintedSteel:
      return paintedSteel(at);
    case Material::Rust:
      return vec3(0.22f, 0.10f, 0.055f) * (0.7f + 0.6f * fractalNoise(at.p * 30.0f, 2, at.footprint * 30.0f));
    case Material::CastIron: {
      const float grid = std::max(lineCover(at.p.x, 0.1f, 0.03f, at.footprint),
                                  lineCover(at.p.y, 0.1f, 0.03f, at.footprint));
      return vec3(0.10f, 0.095f, 0.09f) * (1.0f + 0.9f * grid);
    }
    case Material::Kerb: {
      const float joint = lineCover(at.p.x, 1.0f, 0.012f, at.footprint);
      return gravelPattern(at, 0.012f, vec3(0.40f, 0.40f, 0.41f), vec3(0.62f, 0.61f, 0.60f)) *
             (1.0f - 0.6f * joint);
    }
    case Material::Target:
      return target(at);
    case Material::Render:
      return vec3(0.72f) * (0.86f + 0.28f * fractalNoise(at.p * 0.4f, 4, at.footprint * 0.4f));
    case Material::RoofTile: {
      const float rows = lineCover(at.p.z, 0.14f, 0.035f, at.footprint);
      return vec3(0.33f, 0.13f, 0.08f) * (0.7f + 0.6f * fractalNoise(at.p * 2.0f, 4, at.footprint * 2.0f)) *
             (1.0f - 0.4f * rows);
    }
    case Material::Glass:
      return vec3(0.045f, 0.06f, 0.075f);
    case Material::Foliage: {
      const float leaf = fractalNoise(at.p * 3.2f, 5, at.footprint * 3.2f);
      return glm::mix(vec3(0.025f, 0.05f, 0.012f), vec3(0.16f, 0.24f, 0.06f),
                      glm::clamp(2.2f * (leaf - 0.5f) + 0.5f, 0.0f, 1.0f));
    }
    case Material::WarningPaint: {
      const float stripe = std::sin(8.0f * (at.site.y + at.site.z));
      const float edge = glm::clamp(0.5f + stripe / std::max(0.02f, 16.0f * at.footprint), 0.0f, 1.0f);
      return glm::mix(vec3(0.62f, 0.04f, 0.03f), vec3(0.80f), edge);
    }
    case Material::ClayPipe:
      return vec3(0.40f, 0.17f, 0.09f) * (0.8f + 0.4f * fractalNoise(at.p * 5.0f, 3, at.footprint * 5.0f));
    case Material::Insulation:
      return vec3(0.60f, 0.45f, 0.50f);
  }
  return vec3(0.5f);
}

}  // namespace

glm::vec3 surfaceAlbedo(const SiteObject& object, const glm::dvec3& position, const glm::vec3& normal,
                        float footprint) {
  Place at;
  at.p = vec3(object.textureFromSite * (position - object.textureOrigin));
  at.site = vec3(position);
  at.siteNormal = normal;
  at.normal = vec3(object.textureFromSite * glm::dvec3(normal));
  const vec3 a = glm::abs(at.normal);
  if (a.z > a.x && a.z > a.y)
    at.face = vec2(at.p.x, at.p.y);
  else if (a.y >= a.x)
    at.face = vec2(at.p.x, at.p.z);
  else
    at.face = vec2(at.p.y, at.p.z);
  at.footprint = footprint;
  return glm::clamp(baseColour(object.material, at) * object.tint, vec3(0.0f), vec3(0.95f));
}

float laserReflectance(Material material, const glm::vec3& albedo) {
  const float grey = 0.3f * albedo.r + 0.5f * albedo.g + 0.2f * albedo.b;
  switch (material) {
    case Material::Glass:
      return 0.02f;
    case Material::Foliage:
      return 0.35f + 0.5f * grey;
    case Material::Galvanised:
      return 0.55f;
    case Material::CastIron:
      return 0.12f + 0.5f * grey;
    default:
      return glm::clamp(0.10f + 0.95f * grey, 0.02f, 0.95f);
  }
}

glm::vec2 surfaceGloss(Material material) {
  switch (material) {
    case Material::Glass:
      return {0.6f, 80.0f};
    case Material::Galvanised:
      return {0.35f, 24.0f};
    case Material::PaintedSteel:
      return {0.12f, 30.0f};
    case Material::CastIron:
      return {0.10f, 14.0f};
    case Material::ClayPipe:
      return {0.08f, 24.0f};
    default:
      return {0.0f, 1.0f};
  }
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>

#include "simulate/noise.h"
#include "simulate/random.h"
#include "simulate/site_model.h"

namespace alidade {

namespace {

double smoothStep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// 1 inside the rectangle, 0 from `slope` metres outside on.
double inside(double x, double y, double x0, double x1, double y0, double y1, double slope) {
  return smoothStep(-slope, 0, x - x0) * smoothStep(-slope, 0, x1 - x) * smoothStep(-slope, 0, y - y0) *
         smoothStep(-slope, 0, y1 - y);
}

float noiseAt(std::uint32_t seed, double x, double y, double wavelength, int octaves) {
  const double shift = static_cast<double>(mixBits(seed) % 997);
  return fractalNoise(glm::vec2((x + shift) / wavelength, (y - shift) / wavelength), octaves, 0.0f) - 0.5f;
}

/// Cell borders that are close together around the building and wide far away.
std::vector<double> gradedCuts(double fineLow, double fineHigh, double fine, double far) {
  std::vector<double> cuts;
  for (double x = fineLow; x <= fineHigh + 1e-9; x += fine) cuts.push_back(x);
  for (double step = fine; cuts.back() < far;) cuts.push_back(cuts.back() + (step *= 1.18));
  std::vector<double> low;
  double x = fineLow;
  for (double step = fine; x > -far;) low.push_back(x -= (step *= 1.18));
  std::reverse(low.begin(), low.end());
  low.insert(low.end(), cuts.begin(), cuts.end());
  return low;
}

void addHeap(SiteMesh& mesh, std::uint32_t seed, const char* name, Material material, glm::dvec2 centre,
             double radius, double height, double stretch = 1.0) {
  SiteObject object;
  object.name = name;
  object.material = material;
  mesh.beginObject(object);
  constexpr int cells = 48;
  std::vector<glm::dvec3> grid;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const double u = 2.4 * i / cells - 1.2, v = 2.4 * j / cells - 1.2;
      const double x = centre.x + radius * u, y = centre.y + radius * stretch * v;
      const double r = std::sqrt(u * u + v * v) * (1 + 0.5 * noiseAt(seed + 7, x, y, 1.3, 3));
      // A cone at the angle of repose with a rounded top; its foot sinks below the ground.
      const double cone = height * (1.08 - std::sqrt(r * r + 0.02));
      const double rough = 0.10 * noiseAt(seed + 9, x, y, 0.35, 3);
      grid.emplace_back(x, y, groundHeight(seed, x, y) + std::max(-0.12, cone + (cone > 0 ? rough : 0)));
    }
  mesh.addGrid(grid, cells + 1, cells + 1);
}

}  // namespace

double groundHeight(std::uint32_t seed, double x, double y) {
  const double road = smoothStep(0.0, 0.6, -10.25 - y) * smoothStep(0.0, 0.6, y + 17.5);
  const double pad = inside(x, y, -10, 10, -7, 7, 2.5);
  const double calm = std::max(road, pad);
  const double relief = 0.30 * noiseAt(seed + 1, x, y, 9.0, 3) + 0.10 * noiseAt(seed + 2, x, y, 0.9, 3);
  double z = -0.40 + (1 - 0.93 * calm) * relief;
  z = std::min(z, z * (1 - pad) + pad * std::min(z, -0.36));
  const double far = std::sqrt(x * x + y * y);
  z += 0.9 * smoothStep(35, 90, far) * (1 + noiseAt(seed + 3, x, y, 40, 2));
  const double ditch =
      inside(x, y, 12.2, 14.4, -9.4, 7.5, 0.55 + 0.3 * (0.5 + noiseAt(seed + 4, x, y, 0.8, 2)));
  return z - ditch * (1.42 + 0.12 * noiseAt(seed + 5, x, y, 0.6, 3));
}

void addGround(SiteMesh& mesh, std::uint32_t seed) {
  SiteObject object;
  object.name = "Ground";
  object.material = Material::Soil;
  object.classification = 2;
  mesh.beginObject(object);
  const std::vector<double> xs = gradedCuts(-20, 20, 0.2, 150), ys = gradedCuts(-19, 19, 0.2, 150);
  std::vector<glm::dvec3> grid;
  grid.reserve(xs.size() * ys.size());
  for (const double y : ys)
    for (const double x : xs) grid.emplace_back(x, y, groundHeight(seed, x, y));
  mesh.addGrid(grid, static_cast<int>(ys.size()), static_cast<int>(xs.size()));
  addHeap(mesh, seed, "Gravel heap", Material::Gravel, {-13.6, -4.6}, 2.5, 1.5);
  addHeap(mesh, seed, "Sand heap", Material::Sand, {-13.0, 1.6}, 1.9, 1.2);
  addHeap(mesh, seed, "Spoil heap", Material::Soil, {17.6, 0.5}, 2.0, 1.7, 3.0);
  addHeap(mesh, seed, "Gravel rest", Material::Gravel, {8.1, -8.0}, 0.9, 0.5);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "simulate/noise.h"
#include "simulate/random.h"
#include "simulate/site_model.h"

namespace alidade {

void addGround(SiteMesh& mesh, std::uint32_t seed);

namespace {

constexpr double kUpperFloor = 3.05;

void begin(SiteMesh& mesh, const char* name, Material material, const glm::vec3& tint = glm::vec3(1.0f),
           const glm::dvec3& textureOrigin = glm::dvec3(0.0)) {
  SiteObject object;
  object.name = name;
  object.material = material;
  object.tint = tint;
  object.textureOrigin = textureOrigin;
  mesh.beginObject(object);
}

glm::dmat3 turnAboutZ(double angle) {
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), angle, glm::dvec3(0, 0, 1)));
}

void addScaffold(SiteMesh& mesh, std::uint32_t seed) {
  constexpr double radius = 0.025;
  const std::array<double, 4> xs{-9.15, -6.7, -4.25, -1.8};
  const std::array<double, 2> ys{-7.2, -6.45};
  begin(mesh, "Scaffold", Material::Galvanised);
  for (const double x : xs)
    for (const double y : ys) mesh.addCylinder({x, y, groundHeight(seed, x, y)}, {x, y, 5.4}, radius);
  for (const double z : {1.9, 3.9}) {
    for (const double y : ys)
      mesh.addCylinder({xs[0] - 0.2, y, z - 0.06}, {xs[3] + 0.2, y, z - 0.06}, radius);
    for (const double x : xs)
      mesh.addCylinder({x, ys[0] - 0.1, z - 0.11}, {x, ys[1] + 0.1, z - 0.11}, radius);
    for (const double rail : {0.5, 1.0})
      mesh.addCylinder({xs[0], ys[0], z + rail}, {xs[3], ys[0], z + rail}, radius);
  }
  mesh.addCylinder({xs[0], ys[0] - 0.05, -0.3}, {xs[1], ys[0] - 0.05, 1.8}, radius);
  mesh.addCylinder({xs[1], ys[0] - 0.05, 1.8}, {xs[2], ys[0] - 0.05, 3.8}, radius);
  mesh.addCylinder({xs[3], ys[0] - 0.05, -0.3}, {xs[2], ys[0] - 0.05, 1.8}, radius);
  Random random(seed, 211);
  for (const double z : {1.9, 3.9})
    for (int bay = 0; bay < 3; ++bay)
      for (int plank = 0; plank < 3; ++plank) {
        const double y = ys[0] + 0.03 + 0.24 * plank, slack = random.uniform(0, 0.15);
        begin(mesh, "Plank", Material::Wood, glm::vec3(0.8f + 0.4f * static_cast<float>(random.uniform())),
              {random.uniform(0, 9), random.uniform(0, 9), 0});
        mesh.addBox({xs[bay] - slack, y, z - 0.035}, {xs[bay + 1] + 0.1, y + 0.23, z + 0.005});
      }
  begin(mesh, "Toe board", Material::Wood, glm::vec3(1.1f));
  for (const double z : {1.9, 3.9}) mesh.addBox({xs[0], ys[0] - 0.03, z}, {xs[3], ys[0], z + 0.15});
}

void addRailing(SiteMesh& mesh, const glm::dvec3& from, const glm::dvec3& to) {
  const double length = glm::length(to - from);
  const int posts = static_cast<int>(std::ceil(length / 1.6));
  for (int i = 0; i <= posts; ++i) {
    const glm::dvec3 foot = glm::mix(from, to, static_cast<double>(i) / posts);
    mesh.addCylinder(foot, foot + glm::dvec3(0, 0, 1.1), 0.02, 8);
  }
  for (const double z : {0.55, 1.05})
    mesh.addCylinder(from + glm::dvec3(0, 0, z), to + glm::dvec3(0, 0, z), 0.02, 8);
}

void addRebar(SiteMesh& mesh, std::uint32_t seed) {
  begin(mesh, "Starter bars", Material::Rust);
  Random random(seed, 212);
  const auto cage = [&](double x, double y, double z, double length) {
    for (int i = 0; i < 8; ++i) {
      const double angle = std::numbers::pi * (0.25 + 0.25 * i);
      const double reach = 0.15 * (i % 2 ? 1.0 : 1.38);
      const glm::dvec3 foot(x + reach * std::cos(angle), y + reach * std::sin(angle), z - 0.05);
      const glm::dvec3 lean(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), length);
      mesh.addCylinder(foot, foot + lean, 0.008, 6);
    }
  };
  cage(-8.4, -5.5, kUpperFloor, 0.95);
  cage(-2.8, -5.5, kUpperFloor, 0.95);
  for (const double x : {-8.4, -2.8}) cage(x, 5.5, kUpperFloor + 2.6, 0.7);
  for (const double x : {2.8, 8.4})
    for (const double y : {-5.5, 0.0, 5.5}) cage(x, y, 3.2, 0.75);
  for (int i = 0; i < 16; ++i) {
    const double y = -3.6 + 0.03 * i;
    mesh.addCylinder({4.2 + random.uniform(0, 0.3), y, 0.06 + 0.012 * (i % 3)},
                     {8.0 + random.uniform(0, 0.4), y + random.uniform(-0.05, 0.05), 0.06 + 0.012 * (i % 3)},
                     0.008, 6);
  }
  begin(mesh, "Bearers", Material::Wood);
  for (const double x : {4.8, 7.2}) mesh.addBox({x, -3.8, 0}, {x + 0.1, -2.9, 0.052});
}

void addProps(SiteMesh& mesh) {
  begin(mesh, "Props", Material::PaintedSteel, glm::vec3(0.85f, 0.16f, 0.10f));
  for (const double x : {-7.2, -5.6, -4.0, -1.4})
    for (const double y : {-3.6, -1.6, 1.8, 3.8}) {
      mesh.addCylinder({x, y, 0.01}, {x, y, 1.6}, 0.03, 10);
      mesh.addCylinder({x, y, 1.6}, {x, y, 2.78}, 0.024, 10);
      mesh.addBox({x - 0.08, y - 0.08, 0}, {x + 0.08, y + 0.08, 0.01});
      mesh.addBox({x - 0.08, y - 0.08, 2.79}, {x + 0.08, y + 0.08, 2.8});
    }
}

void addBrickPallet(SiteMesh& mesh, std::uint32_t seed, glm::dvec2 place, double angle, int layers) {
  const glm::dvec3 origin(place.x, place.y, groundHeight(seed, place.x, place.y) + 0.02);
  const glm::dmat3 axes = turnAboutZ(angle);
  begin(mesh, "Pallet", Material::Wood, glm::vec3(0.9f), origin);
  for (const double x : {-0.55, -0.05, 0.45}) mesh.addBox({x, -0.5, -0.1}, {x + 0.1, 0.5, 0.1}, axes, origin);
  for (int i = 0; i < 7; ++i)
    mesh.addBox({-0.6, -0.5 + 0.148 * i, 0.1}, {0.6, -0.4 + 0.148 * i, 0.125}, axes, origin);
  SiteObject object;
  object.name = "Bricks";
  object.material = Material::Brick;
  object.textureOrigin = origin;
  object.textureFromSite = glm::transpose(axes);
  mesh.beginObject(object);
  mesh.addBox({-0.55, -0.45, 0.125}, {0.55, 0.45, 0.125 + 0.0775 * layers}, axes, origin);
  mesh.addBox({-0.55, -0.45, 0.125 + 0.0775 * layers}, {0.1, 0.45, 0.125 + 0.0775 * (layers + 2)}, axes,
              origin);
}

void addContainer(SiteMesh& mesh, std::uint32_t seed) {
  const glm::dvec3 origin(4.0, 12.2, groundHeight(seed, 7.0, 13.4));
  const glm::dmat3 axes = turnAboutZ(-0.06);
  const glm::vec3 blue(0.08f, 0.20f, 0.36f);
  begin(mesh, "Site container", Material::PaintedSteel, blue);
  mesh.addBox({0, 0.04, 0.1}, {6.06, 2.40, 2.58}, axes, origin);
  for (int i = 0; i < 22; ++i) {
    const double x = 0.12 + 0.27 * i;
    mesh.addBox({x, 0.0, 0.22}, {x + 0.13, 0.04, 2.46}, axes, origin);
    mesh.addBox({x, 2.40, 0.22}, {x + 0.13, 2.44, 2.46}, axes, origin);
  }
  for (const double z : {0.08, 2.46}) mesh.addBox({-0.02, -0.01, z}, {6.08, 0.06, z + 0.14}, axes, origin);
  for (const double x : {-0.02, 5.96}) mesh.addBox({x, -0.015, 0.08}, {x + 0.12, 0.06, 2.6}, axes, origin);
  begin(mesh, "Container window", Material::Glass);
  mesh.addBox({3.4, -0.03, 1.1}, {4.8, 0.0, 2.1}, axes, origin);
  begin(mesh, "Container door", Material::PaintedSteel, glm::vec3(0.55f, 0.57f, 0.58f));
  mesh.addBox({1.0, -0.03, 0.15}, {1.95, 0.0, 2.2}, axes, origin);
  begin(mesh, "Cabin", Material::PaintedSteel, glm::vec3(0.06f, 0.33f, 0.30f));
  const glm::dvec3 cabin(-16.5, 7.5, groundHeight(seed, -16, 8));
  mesh.addBox({0, 0, 0}, {1.1, 1.1, 2.2}, turnAboutZ(0.3), cabin);
  begin(mesh, "Cabin roof", Material::PaintedSteel, glm::vec3(0.75f));
  mesh.addBox({-0.04, -0.04, 2.2}, {1.14, 1.14, 2.32}, turnAboutZ(0.3), cabin);
}

void addBarrier(SiteMesh& mesh, std::uint32_t seed) {
  for (double y = -8.6; y < 6.0; y += 2.0) {
    const double z = groundHeight(seed, 11.2, y);
    begin(mesh, "Barrier post", Material::Galvanised);
    mesh.addCylinder({11.2, y, z - 0.1}, {11.2, y, z + 1.05}, 0.022, 8);
    if (y > 3.0) continue;
    begin(mesh, "Barrier board", Material::WarningPaint);
    const double next = groundHeight(seed, 11.2, y + 2.0);
    const double low = 0.5 * (z + next) + 0.80;
    mesh.addBox({11.225, y - 0.04, low}, {11.245, y + 1.94, low + 0.2});
  }
  begin(mesh, "Pipes in stock", Material::ClayPipe);
  for (int i = 0; i < 3; ++i) {
    const double x = 9.75 + 0.36 * i, z = groundHeight(seed, x, 9.5) + 0.17;
    mesh.addCylinder({x, 8.6, z}, {x, 11.1, z}, 0.16, 20);
  }
}

void addHouse(SiteMesh& mesh, std::uint32_t seed, glm::dvec2 place, double angle, glm::dvec3 size,
              glm::vec3 tint) {
  const glm::dvec3 origin(place.x, place.y, groundHeight(seed, place.x, place.y) - 0.6);
  const glm::dmat3 axes = turnAboutZ(angle);
  const auto at = [&](double x, double y, double z) { return origin + axes * glm::dvec3(x, y, z); };
  const double w = size.x, d = size.y, h = size.z, ridge = h + 0.38 * d;
  begin(mesh, "House", Material::Render, tint);
  mesh.addBox({0, 0, 0}, {w, d, h}, axes, origin);
  for (const double x : {0.0, w}) {
    if (x == 0)
      mesh.addTriangle(at(x, d, h), at(x, 0, h), at(x, d / 2, ridge));
    else
      mesh.addTriangle(at(x, 0, h), at(x, d, h), at(x, d / 2, ridge));
  }
  begin(mesh, "Roof", Material::RoofTile);
  const double e = 0.5, drop = 0.38;
  mesh.addQuad(at(-e, -e, h - drop), at(w + e, -e, h - drop), at(w + e, d / 2, ridge + 0.05),
               at(-e, d / 2, ridge + 0.05));
  mesh.addQuad(at(w + e, d + e, h - drop), at(-e, d + e, h - drop), at(-e, d / 2, ridge + 0.05),
               at(w + e, d / 2, ridge + 0.05));
  begin(mesh, "House windows", Material::Glass);
  for (double z = 1.5; z + 1.5 < h; z += 2.8)
    for (double x = 1.2; x + 1.2 < w; x += 2.6) {
      mesh.addBox({x, -0.02, z}, {x + 1.1, 0.05, z + 1.4}, axes, origin);
      mesh.addBox({x, d - 0.05, z}, {x + 1.1, d + 0.02, z + 1.4}, axes, origin);
    }
  begin(mesh, "Window frames", Material::Render, glm::vec3(1.15f));
  for (double z = 1.5; z + 1.5 < h; z += 2.8)
    for (double x = 1.2; x + 1.2 < w; x += 2.6)
      for (const double side : {-0.05, d + 0.02}) {
        mesh.addBox({x - 0.1, side, z - 0.1}, {x + 1.2, side + 0.03, z}, axes, origin);
        mesh.addBox({x + 0.51, side, z}, {x + 0.59, side + 0.03, z + 1.4}, axes, origin);
      }
}

void addTree(SiteMesh& mesh, std::uint32_t seed, glm::dvec2 place, double height) {
  const double z = groundHeight(seed, place.x, place.y);
  begin(mesh, "Trunk", Material::Wood, glm::vec3(0.5f));
  mesh.addCylinder({place.x, place.y, z - 0.2}, {place.x, place.y, z + 0.45 * height}, 0.035 * height, 9);
  begin(mesh, "Foliage", Material::Foliage);
  constexpr int rings = 28, around = 40;
  std::vector<glm::dvec3> grid;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j <= around; ++j) {
      const double theta = std::numbers::pi * i / rings, phi = 2 * std::numbers::pi * (j % around) / around;
      const glm::dvec3 n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), -std::cos(theta));
      const float bump = fractalNoise(glm::vec3(n * 2.2) + glm::vec3(static_cast<float>(place.x)), 4, 0.0f);
      const double r = height * (0.20 + 0.26 * bump);
      grid.push_back(glm::dvec3(place.x, place.y, z + 0.62 * height) + r * n * glm::dvec3(1, 1, 1.15));
    }
  mesh.addGrid(grid, rings + 1, around + 1);
}

void addCrane(SiteMesh& mesh) {
  begin(mesh, "Tower crane", Material::PaintedSteel, glm::vec3(0.80f, 0.55f, 0.06f));
  const glm::dvec3 foot(24, 34, -0.5);
  constexpr double top = 27, half = 0.7, r = 0.09;
  for (const double x : {-half, half})
    for (const double y : {-half, half})
      mesh.addCylinder(foot + glm::dvec3(x, y, 0), foot + glm::dvec3(x, y, top + 1), r, 6);
  for (int i = 0; i < 18; ++i) {
    const double z0 = 1.5 * i, z1 = 1.5 * (i + 1), s = i % 2 ? half : -half;
    for (const double side : {-half, half}) {
      mesh.addCylinder(foot + glm::dvec3(-s, side, z0), foot + glm::dvec3(s, side, z1), 0.05, 5);
      mesh.addCylinder(foot + glm::dvec3(side, s, z0), foot + glm::dvec3(side, -s, z1), 0.05, 5);
    }
  }
  const glm::dvec3 head = foot + glm::dvec3(0, 0, top);
  const glm::dvec3 along = glm::normalize(glm::dvec3(-1, -0.35, 0)), across(-along.y, along.x, 0),
                   up(0, 0, 1);
  for (const double side : {-0.5, 0.5})
    mesh.addCylinder(head - 9.0 * along + side * across, head + 30.0 * along + side * across, 0.08, 6);
  mesh.addCylinder(head - 2.0 * along + 1.1 * up, head + 30.0 * along + 1.1 * up, 0.08, 6);
  for (int i = 0; i < 20; ++i)
    for (const double side : {-0.5, 0.5}) {
      const glm::dvec3 low = head + 1.5 * i * along + side * across;
      const glm::dvec3 high = head + (1.5 * i + 0.75) * along + 1.1 * up;
      mesh.addCylinder(low, high, 0.035, 5);
      mesh.addCylinder(high, low + 1.5 * along, 0.035, 5);
    }
  mesh.addCylinder(head, head + 5.0 * up, 0.14, 6);
  mesh.addCylinder(head + 5.0 * up, head + 20.0 * along + 1.1 * up, 0.03, 5);
  mesh.addCylinder(head + 5.0 * up, head - 8.0 * along, 0.03, 5);
  begin(mesh, "Counterweight", Material::Concrete);
  mesh.addBox({-9.0, -0.6, -1.6}, {-7.2, 0.6, 0.2}, glm::dmat3(along, across, up), head);
}

void addNeighbours(SiteMesh& mesh, std::uint32_t seed) {
  addHouse(mesh, seed, {-34, 34}, 0.08, {14, 9, 8.2}, {0.86f, 0.80f, 0.66f});
  addHouse(mesh, seed, {-9, 41}, -0.05, {17, 10, 6.0}, {0.82f, 0.84f, 0.82f});
  addHouse(mesh, seed, {36, 30}, -0.35, {13, 9, 8.6}, {0.84f, 0.70f, 0.58f});
  addHouse(mesh, seed, {50, -4}, 1.45, {15, 9, 6.2}, {0.80f, 0.80f, 0.76f});
  addHouse(mesh, seed, {-42, -6}, 1.7, {15, 10, 8.0}, {0.84f, 0.76f, 0.72f});
  addHouse(mesh, seed, {-12, -34}, 0.02, {22, 10, 9.0}, {0.80f, 0.82f, 0.86f});
  static constexpr std::array<std::array<double, 3>, 9> trees{{{-24, 27, 8.5},
                                                               {-17.5, 31, 7.0},
                                                               {11, 33, 9.5},
                                                               {17.5, 29, 6.5},
                                                               {31, 22, 8.0},
                                                               {33, 8, 7.5},
                                                               {-29, 14, 9.0},
                                                               {-27, -1, 6.5},
                                                               {20, -30, 9.0}}};
  for (const auto& [x, y, height] : trees) addTree(mesh, seed, {x, y}, height);
  const auto hoarding = [&](glm::dvec2 from, glm::dvec2 to) {
    const double length = glm::length(to - from);
    const glm::dvec2 step = (to - from) / length;
    const int panels = static_cast<int>(length / 2.0);
    for (int i = 0; i < panels; ++i) {
      const glm::dvec2 at = from + 2.0 * i * step;
      const double z = groundHeight(seed, at.x, at.y);
      begin(mesh, "Hoarding", Material::Plywood, glm::vec3(0.9f + 0.2f * cellNoise(i, 5, 1)), {at, z});
      mesh.addBox({0, -0.01, z - 0.1}, {1.985, 0.01, z + 2.0},
                  glm::dmat3(glm::dvec3(step, 0), glm::dvec3(-step.y, step.x, 0), glm::dvec3(0, 0, 1)),
                  glm::dvec3(at, 0));
    }
  };
  hoarding({-22, 19.5}, {22, 19.5});
  hoarding({22, 19.5}, {22, -9});
  hoarding({-22, -9}, {-22, 19.5});
}

}  // namespace

void addSurroundings(SiteMesh& mesh, std::uint32_t seed) {
  addGround(mesh, seed);
  addScaffold(mesh, seed);
  begin(mesh, "Railing", Material::Galvanised);
  addRailing(mesh, {0.15, -5.7, kUpperFloor}, {0.15, 5.7, kUpperFloor});
  addRailing(mesh, {-8.6, -5.75, kUpperFloor}, {0.1, -5.75, kUpperFloor});
  addRebar(mesh, seed);
  addProps(mesh);
  addBrickPallet(mesh, seed, {0.6, -7.6}, 0.12, 11);
  addBrickPallet(mesh, seed, {2.1, -7.3}, -0.08, 8);
  addBrickPallet(mesh, seed, {10.2, 3.5}, 0.4, 12);
  begin(mesh, "Board stack", Material::Plywood, glm::vec3(1.1f, 0.95f, 0.6f));
  const double z = groundHeight(seed, -10.8, -8.4);
  for (int i = 0; i < 9; ++i)
    mesh.addBox({-1.2, -0.4, 0.06 + 0.03 * i}, {1.2, 0.4, 0.085 + 0.03 * i}, turnAboutZ(0.2 + 0.02 * (i % 3)),
                {-10.8, -8.6, z});
  addContainer(mesh, seed);
  addBarrier(mesh, seed);
  addNeighbours(mesh, seed);
  addCrane(mesh);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/site_model.h"

#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "geometry/angle.h"
#include "simulate/random.h"

namespace alidade {

namespace {

enum Stream : std::uint64_t { kRotation = 101, kDefects = 102, kIds = 103 };

int itemNamed(const SiteModel& site, const std::string& name) {
  for (std::size_t i = 0; i < site.items.size(); ++i)
    if (site.items[i].name == name) return static_cast<int>(i);
  return -1;
}

double signedAmount(Random& random, double low, double high) {
  return (random.uniform() < 0.5 ? -1.0 : 1.0) * random.uniform(low, high);
}

void chooseDefects(SiteModel& site, std::uint32_t seed) {
  Random random(seed, kDefects);
  static const char* const columns[] = {"Column C1", "Column D1", "Column D2", "Column C2"};
  Defect shifted;
  shifted.kind = "shifted";
  shifted.item = itemNamed(site, columns[random.integer(4)]);
  shifted.shift = {signedAmount(random, 0.03, 0.07), signedAmount(random, 0.02, 0.05), 0.0};
  site.defects.push_back(shifted);

  static const char* const walls[] = {"Wall inner BC", "Wall back CD", "Parapet front CD"};
  Defect tilted;
  tilted.kind = "tilted";
  tilted.item = itemNamed(site, walls[random.integer(3)]);
  const Prism& wall = site.items[tilted.item].prism;
  const double height = wall.outline.high.y;
  tilted.topDisplacement = signedAmount(random, 0.025, 0.045) * height;
  tilted.tiltRadians = std::asin(tilted.topDisplacement / height);
  tilted.axisPoint = wall.at({0, 0, 0.5 * wall.depth});
  // A turn about the profile's x leans its y (up) towards its z, the wall's normal.
  tilted.axisDirection = wall.axes[0];
  site.defects.push_back(tilted);

  static const std::pair<const char*, int> openings[] = {
      {"Wall front AB", 0}, {"Wall front AB", 1}, {"Wall back BC", 0}, {"Wall left 12", 0}};
  const auto& [name, index] = openings[random.integer(4)];
  Defect missing;
  missing.kind = "missing_opening";
  missing.item = itemNamed(site, name);
  missing.opening = site.items[missing.item].prism.openings[index];
  site.defects.push_back(missing);
}

/// The element as it was built: the design with its defects.
Prism builtPrism(const SiteModel& site, int item) {
  Prism prism = site.items[item].prism;
  for (const Defect& defect : site.defects) {
    if (defect.item != item) continue;
    if (defect.kind == "shifted") prism.origin += defect.shift;
    if (defect.kind == "tilted") {
      const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), defect.tiltRadians, defect.axisDirection));
      prism.origin = defect.axisPoint + turn * (prism.origin - defect.axisPoint);
      prism.axes = turn * prism.axes;
    }
    if (defect.kind == "missing_opening")
      std::erase_if(prism.openings, [&](const ProfileRectangle& o) {
        return o.low == defect.opening.low && o.high == defect.opening.high;
      });
  }
  return prism;
}

SiteObject objectOf(const DesignItem& item, int index, const Prism& prism) {
  SiteObject object;
  object.name = item.name;
  object.material = item.material;
  object.classification = 6;
  object.designItem = index;
  object.textureOrigin = prism.origin;
  // Walls and beams: the wall's own upright frame; x along it, y through it, z up.
  if (prism.circleRadius == 0 && std::abs(prism.axes[1].z) > 0.9)
    object.textureFromSite = glm::transpose(glm::dmat3(prism.axes[0], -prism.axes[2], prism.axes[1]));
  return object;
}

void addElements(SiteModel& site) {
  for (std::size_t i = 0; i < site.items.size(); ++i) {
    const DesignItem& item = site.items[i];
    const int index = static_cast<int>(i);
    site.design.beginObject(objectOf(item, index, item.prism));
    item.prism.addTo(site.design);
    if (!item.built) continue;
    const Prism built = builtPrism(site, index);
    site.asBuilt.beginObject(objectOf(item, index, built));
    built.addTo(site.asBuilt);
  }
}

/// A black-and-white target plate, 2 mm thick, on an as-built face: at profile place (x, y) on the side
/// z = depth or z = 0 of an element, or on a column's outer face.
void addTarget(SiteModel& site, const std::string& name, const glm::dvec3& centre, const glm::dvec3& normal,
               const glm::dvec3& up) {
  constexpr double half = 0.12, thickness = 0.002;
  const glm::dvec3 across = glm::normalize(glm::cross(up, normal));
  const glm::dvec3 upward = glm::cross(normal, across);
  SiteObject object;
  object.name = name;
  object.material = Material::Target;
  object.textureOrigin = centre;
  object.textureFromSite = glm::transpose(glm::dmat3(across, upward, normal));
  site.asBuilt.beginObject(object);
  site.asBuilt.addBox({-half, -half, 0}, {half, half, thickness}, glm::dmat3(across, upward, normal), centre);
  site.controlPoints.push_back({name, centre + thickness * normal, "TARGET", 0.003, normal});
}

void addTargets(SiteModel& site) {
  int number = 0;
  const auto nextName = [&number] { return fmt::format("T{:02}", ++number); };
  struct OnColumn {
    const char* column;
    glm::dvec3 normal;
    double height;
  };
  for (const OnColumn& place :
       {OnColumn{"Column A1", {0, -1, 0}, 1.5}, OnColumn{"Column B1", {0, -1, 0}, 2.4},
        OnColumn{"Column C1", {0, -1, 0}, 1.7}, OnColumn{"Column D1", {0, -1, 0}, 2.2},
        OnColumn{"Column D1", {1, 0, 0}, 1.2}, OnColumn{"Column D2", {0, -1, 0}, 1.6},
        OnColumn{"Column C2", {0, -1, 0}, 2.3}, OnColumn{"Column D3", {1, 0, 0}, 1.8}}) {
    const Prism prism = builtPrism(site, itemNamed(site, place.column));
    addTarget(site, nextName(), prism.origin + 0.2 * place.normal + glm::dvec3(0, 0, place.height),
              place.normal, {0, 0, 1});
  }
  struct OnWall {
    const char* wall;
    double x, y;
  };
  for (const OnWall& place : {OnWall{"Wall front AB", 0.45, 2.45}, OnWall{"Wall front AB", 2.75, 1.2},
                              OnWall{"Wall front AB", 4.8, 0.5}, OnWall{"Wall inner BC", 3.2, 1.6},
                              OnWall{"Wall inner BC", 4.7, 0.7}, OnWall{"Wall back CD", 0.7, 1.5},
                              OnWall{"Wall back CD", 4.4, 2.3}, OnWall{"Parapet front CD", 2.6, 0.45}}) {
    const Prism prism = builtPrism(site, itemNamed(site, place.wall));
    addTarget(site, nextName(), prism.at({place.x, place.y, prism.depth}), prism.axes[2], prism.axes[1]);
  }
  const Prism beam = builtPrism(site, itemNamed(site, "Beam 1"));
  for (const double along : {1.1, 6.2})
    addTarget(site, nextName(), beam.at({-0.15, 0.21, along}), -beam.axes[0], {0, 0, 1});
}

}  // namespace

std::string ifcGlobalId(std::uint32_t seed, const std::string& name) {
  static const char digits[] = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_$";
  std::uint64_t hash = mixBits(seed + 0x1F0Cull);
  for (const char c : name) hash = mixBits(hash ^ static_cast<unsigned char>(c));
  Random random(hash, kIds);
  std::string id(1, digits[random.next() >> 62]);  // 128 bits in 22 digits: the first has two
  while (id.size() < 22) id += digits[random.next() >> 58];
  return id;
}

SiteModel makeSite(std::uint32_t seed, const glm::dvec3& siteOrigin) {
  SiteModel site;
  Random random(seed, kRotation);
  site.rotation = radiansFromDegrees(random.uniform(12.0, 38.0));
  site.worldFromSite.rotation = glm::angleAxis(site.rotation, glm::dvec3(0, 0, 1));
  site.worldFromSite.translation = siteOrigin;
  addDesignItems(site, seed);
  chooseDefects(site, seed);
  addElements(site);
  addTargets(site);
  addSurroundings(site.asBuilt, seed);
  // Each station stands where another's shadows and the hole below its tripod are seen.
  for (const auto& place : {glm::dvec2(-4.0, -12.0), glm::dvec2(6.4, -11.2), glm::dvec2(1.2, -2.7),
                            glm::dvec2(-1.0, 10.5), glm::dvec2(8.5, -10.5)})
    site.stations.emplace_back(place.x, place.y,
                               std::abs(place.y) < 6 ? 0.0 : groundHeight(seed, place.x, place.y));
  return site;
}

}  // namespace alidade

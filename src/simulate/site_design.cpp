// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "simulate/random.h"
#include "simulate/site_model.h"

namespace alidade {

namespace {

constexpr std::array<double, 4> kGridX{-8.4, -2.8, 2.8, 8.4};
constexpr std::array<double, 3> kGridY{-5.5, 0.0, 5.5};
constexpr double kColumnHalf = 0.2;
constexpr double kColumnHeight = 2.8;
constexpr double kSlabThickness = 0.25;
constexpr double kUpperFloor = kColumnHeight + kSlabThickness;

const glm::dmat3 kAlongX(glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1),
                         glm::dvec3(0, -1, 0));  // profile x-z, depth -y
const glm::dmat3 kAlongY(glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1),
                         glm::dvec3(1, 0, 0));  // profile y-z, depth x

/// Adds elements with the bookkeeping that each needs.
class Designer {
 public:
  Designer(SiteModel& site, std::uint32_t seed) : m_site(site), m_seed(seed) {}

  DesignItem& add(const std::string& name, const std::string& type, int storey, Material material) {
    DesignItem item;
    item.name = name;
    item.globalId = ifcGlobalId(m_seed, name);
    item.ifcType = type;
    item.storey = storey;
    item.material = material;
    m_site.items.push_back(std::move(item));
    return m_site.items.back();
  }

  DesignItem& column(const std::string& name, int storey, double x, double y, double base, double height) {
    DesignItem& item = add(name, "IfcColumn", storey, Material::FormedConcrete);
    item.predefined = "COLUMN";
    item.prism.origin = {x, y, base};
    item.prism.depth = height;
    item.prism.outline = {{-kColumnHalf, -kColumnHalf}, {kColumnHalf, kColumnHalf}};
    item.properties = {
        {"Reference", "C40x40"}, {"LoadBearing", "true"}, {"IsExternal", y == 0 ? "false" : "true"}};
    return item;
  }

  DesignItem& slab(const std::string& name, int storey, glm::dvec2 low, glm::dvec2 high, double base,
                   double depth) {
    DesignItem& item = add(name, "IfcSlab", storey, Material::ScreedConcrete);
    item.predefined = storey == 0 ? "BASESLAB" : "FLOOR";
    item.prism.origin = {0, 0, base};
    item.prism.depth = depth;
    item.prism.outline = {low, high};
    item.properties = {{"LoadBearing", "true"}, {"IsExternal", "false"}};
    return item;
  }

  DesignItem& beamAlongX(const std::string& name, double x0, double x1, double y, double base) {
    DesignItem& item = beam(name);
    item.prism.origin = {x0, y, base};
    item.prism.axes = kAlongY;
    item.prism.depth = x1 - x0;
    item.prism.outline = {{-0.15, 0.0}, {0.15, 0.42}};
    return item;
  }

  DesignItem& beamAlongY(const std::string& name, double y0, double y1, double x, double base) {
    DesignItem& item = beam(name);
    item.prism.origin = {x, y1, base};
    item.prism.axes = kAlongX;
    item.prism.depth = y1 - y0;
    item.prism.outline = {{-0.15, 0.0}, {0.15, 0.42}};
    return item;
  }

  /// A wall of 0.2 m whose middle runs from (x0, y) to (x1, y); openings in metres from x0 and the floor.
  DesignItem& wallAlongX(const std::string& name, int storey, double x0, double x1, double y, double base,
                         double height, Material material, std::vector<ProfileRectangle> openings) {
    DesignItem& item = wall(name, storey, material, std::move(openings));
    item.prism.origin = {x0, y + 0.1, base};
    item.prism.axes = kAlongX;
    item.prism.outline = {{0, 0}, {x1 - x0, height}};
    return item;
  }

  DesignItem& wallAlongY(const std::string& name, int storey, double y0, double y1, double x, double base,
                         double height, Material material, std::vector<ProfileRectangle> openings) {
    DesignItem& item = wall(name, storey, material, std::move(openings));
    item.prism.origin = {x - 0.1, y0, base};
    item.prism.axes = kAlongY;
    item.prism.outline = {{0, 0}, {y1 - y0, height}};
    return item;
  }

  DesignItem& bar(const std::string& name, const std::string& type, Material material, const glm::dvec3& from,
                  const glm::dvec3& to, double radius) {
    DesignItem& item = add(name, type, 0, material);
    const glm::dvec3 axis = glm::normalize(to - from);
    const glm::dvec3 helper = std::abs(axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(helper, axis));
    item.prism.origin = from;
    item.prism.axes = glm::dmat3(u, glm::cross(axis, u), axis);
    item.prism.depth = glm::length(to - from);
    item.prism.circleRadius = radius;
    return item;
  }

 private:
  DesignItem& beam(const std::string& name) {
    DesignItem& item = add(name, "IfcBeam", 1, Material::FormedConcrete);
    item.predefined = "BEAM";
    item.properties = {{"Reference", "B30x42"}, {"LoadBearing", "true"}, {"IsExternal", "false"}};
    return item;
  }

  DesignItem& wall(const std::string& name, int storey, Material material,
                   std::vector<ProfileRectangle> openings) {
    DesignItem& item = add(name, "IfcWall", storey, material);
    item.predefined = "STANDARD";
    item.prism.depth = 0.2;
    item.prism.openings = std::move(openings);
    item.properties = {{"LoadBearing", material == Material::Brick ? "false" : "true"},
                       {"IsExternal", "true"}};
    return item;
  }

  SiteModel& m_site;
  std::uint32_t m_seed;
};

void addGroundFloor(Designer& design) {
  design.slab("Slab ground floor", 0, {-9, -6}, {9, 6}, -0.3, 0.3);
  for (std::size_t i = 0; i < kGridX.size(); ++i)
    for (std::size_t j = 0; j < kGridY.size(); ++j)
      design.column(fmt::format("Column {}{}", static_cast<char>('A' + i), j + 1), 0, kGridX[i], kGridY[j], 0,
                    kColumnHeight);
  const double in = kColumnHalf, h = kColumnHeight;
  const ProfileRectangle window{{1.0, 0.9}, {2.4, 2.2}}, second{{3.2, 0.9}, {4.4, 2.2}},
      door{{3.2, 0.0}, {4.2, 2.1}};
  design.wallAlongX("Wall front AB", 0, kGridX[0] + in, kGridX[1] - in, kGridY[0], 0, h,
                    Material::FormedConcrete, {window, {{3.1, 0.9}, {4.5, 2.2}}});
  design.wallAlongX("Wall back AB", 0, kGridX[0] + in, kGridX[1] - in, kGridY[2], 0, h, Material::Brick,
                    {window, second});
  design.wallAlongX("Wall back BC", 0, kGridX[1] + in, kGridX[2] - in, kGridY[2], 0, h,
                    Material::FormedConcrete, {{{0.8, 0.9}, {2.2, 2.2}}, door});
  design.wallAlongX("Wall back CD", 0, kGridX[2] + in, kGridX[3] - in, kGridY[2], 0, h, Material::Brick,
                    {{{1.6, 0.9}, {3.6, 2.2}}});
  design.wallAlongY("Wall left 12", 0, kGridY[0] + in, kGridY[1] - in, kGridX[0], 0, h,
                    Material::FormedConcrete, {{{1.8, 0.9}, {3.2, 2.2}}});
  design.wallAlongY("Wall left 23", 0, kGridY[1] + in, kGridY[2] - in, kGridX[0], 0, h,
                    Material::FormedConcrete, {});
  design.wallAlongX("Wall inner BC", 0, kGridX[1] + in, kGridX[2] - in, kGridY[1], 0, h, Material::Brick,
                    {{{0.6, 0.0}, {1.6, 2.1}}});
  design.wallAlongX("Parapet front CD", 0, kGridX[2] + in, kGridX[3] - in, kGridY[0], 0, 0.9, Material::Brick,
                    {});
}

void addUpperFloor(Designer& design) {
  design.slab("Slab first floor", 1, {-8.7, -5.8}, {0.25, 5.8}, kColumnHeight, kSlabThickness);
  for (std::size_t j = 0; j < kGridY.size(); ++j)
    design.beamAlongX(fmt::format("Beam {}", j + 1), 0.25, kGridX[3] + 0.2, kGridY[j], kColumnHeight);
  for (const std::size_t i : {2u, 3u})
    for (std::size_t j = 0; j + 1 < kGridY.size(); ++j)
      design.beamAlongY(fmt::format("Beam {}{}{}", static_cast<char>('A' + i), j + 1, j + 2),
                        kGridY[j] + 0.15, kGridY[j + 1] - 0.15, kGridX[i], kColumnHeight);
  for (const std::size_t i : {0u, 1u})
    for (const std::size_t j : {0u, 2u}) {
      DesignItem& item =
          design.column(fmt::format("Column {}{} first floor", static_cast<char>('A' + i), j + 1), 1,
                        kGridX[i], kGridY[j], kUpperFloor, 2.6);
      item.built = j == 2;
    }
  DesignItem& parapet =
      design.wallAlongX("Wall front AB first floor", 1, kGridX[0] + 0.2, kGridX[1] - 0.2, kGridY[0],
                        kUpperFloor, 2.6, Material::Brick, {{{1.6, 0.9}, {3.6, 2.2}}});
  parapet.built = false;
  design.wallAlongX("Wall back AB first floor", 1, kGridX[0] + 0.2, kGridX[1] - 0.2, kGridY[2], kUpperFloor,
                    1.3, Material::Brick, {});
}

void addCivilWorks(Designer& design, SiteModel& site, std::uint32_t seed) {
  const double y = -8.4;
  const std::array<double, 3> xs{-5.0, 4.2, 18.5};
  std::array<glm::dvec3, 3> covers;
  for (std::size_t i = 0; i < xs.size(); ++i) {
    const double top = groundHeight(seed, xs[i], y) + 0.03;
    covers[i] = {xs[i], y, top};
    DesignItem& item = design.bar(fmt::format("Manhole {}", i + 1), "IfcDistributionChamberElement",
                                  Material::CastIron, {xs[i], y, top - 1.6}, {xs[i], y, top}, 0.4);
    item.predefined = "MANHOLE";
    site.stakePoints.push_back({fmt::format("MH{}", i + 1), covers[i], "MANHOLE", 0.02, {0, 0, 1}});
  }
  for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
    const double fall = 0.01 * (xs[i + 1] - xs[i]);
    DesignItem& item = design.bar(fmt::format("Sewer {}-{}", i + 1, i + 2), "IfcPipeSegment",
                                  Material::ClayPipe, {xs[i] + 0.4, y, -1.62 - 0.01 * (xs[i] - xs[0])},
                                  {xs[i + 1] - 0.4, y, -1.62 - 0.01 * (xs[i] - xs[0]) - fall}, 0.16);
    item.predefined = "RIGIDSEGMENT";
  }
  for (int i = 0; i < 6; ++i) {
    const double x0 = -14.0 + 4.0 * i;
    DesignItem& item =
        design.add(fmt::format("Kerb {}", i + 1), "IfcBuildingElementProxy", 0, Material::Kerb);
    item.prism.origin = {x0, -10.0, -0.6};
    item.prism.depth = 0.34;
    item.prism.outline = {{0.0, -0.15}, {3.99, 0.0}};
    site.stakePoints.push_back({fmt::format("KB{}", i + 1), {x0, -10.0, -0.26}, "KERB", 0.01, {0, 0, 1}});
  }
}

}  // namespace

void addDesignItems(SiteModel& site, std::uint32_t seed) {
  site.storeys = {{"Ground floor", 0.0}, {"First floor", kUpperFloor}};
  Designer design(site, seed);
  addGroundFloor(design);
  addUpperFloor(design);
  addCivilWorks(design, site, seed);
  for (std::size_t i = 0; i < kGridX.size(); ++i)
    for (std::size_t j = 0; j < kGridY.size(); ++j)
      site.stakePoints.push_back({fmt::format("AX{}{}", static_cast<char>('A' + i), j + 1),
                                  {kGridX[i], kGridY[j], 0.0},
                                  "AXIS",
                                  0.015,
                                  {0, 0, 1}});
}

}  // namespace alidade

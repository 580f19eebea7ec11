// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace alidade {

/// What a surface is made of: decides colour, texture and laser reflectance.
enum class Material : std::uint8_t {
  Concrete,
  FormedConcrete,
  ScreedConcrete,
  Brick,
  Soil,
  Gravel,
  Sand,
  Asphalt,
  Grass,
  Wood,
  Plywood,
  Galvanised,
  PaintedSteel,
  Rust,
  CastIron,
  Kerb,
  Target,
  Render,
  RoofTile,
  Glass,
  Foliage,
  WarningPaint,
  ClayPipe,
  Insulation
};

/// A thing of the site. Texture coordinates are taken in its own axes, so that a shifted column carries its
/// texture with it.
struct SiteObject {
  std::string name;
  Material material = Material::Concrete;
  std::uint8_t classification = 1;  ///< ASPRS: 1 unassigned, 2 ground, 6 building
  int designItem = -1;              ///< index of the design element that it is; -1 for anything else
  glm::vec3 tint{1.0f};
  glm::dvec3 textureOrigin{0.0};    ///< site frame
  glm::dmat3 textureFromSite{1.0};  ///< rotation; applied to p - textureOrigin
};

/// Triangles of a site in the site frame (metres, z up, origin on the ground-floor slab). Vertices carry
/// normals: equal over flat faces, smoothed over round things and ground.
class SiteMesh {
 public:
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> triangleObject;  ///< index into objects
  std::vector<SiteObject> objects;

  /// Later faces belong to this object. Returns its index.
  std::uint32_t beginObject(SiteObject object);

  void addTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
  /// Counter-clockwise from outside.
  void addQuad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);
  /// Box between two corners in the frame given by its columns (x, y, z axes) and origin.
  void addBox(const glm::dvec3& low, const glm::dvec3& high, const glm::dmat3& axes = glm::dmat3(1.0),
              const glm::dvec3& origin = glm::dvec3(0.0));
  /// Round bar between two points with smooth sides and flat caps. `firstCorner`: direction of the first
  /// corner of the polygon, square to the axis; any where it is 0.
  void addCylinder(const glm::dvec3& from, const glm::dvec3& to, double radius, int sides = 10,
                   const glm::dvec3& firstCorner = glm::dvec3(0.0));
  /// Grid of rows × columns positions (row by row); normals are smoothed. Upward where columns run
  /// along +x and rows along +y.
  void addGrid(const std::vector<glm::dvec3>& grid, int rows, int columns);

 private:
  std::uint32_t addVertex(const glm::dvec3& position, const glm::vec3& normal);
  void addFace(std::uint32_t a, std::uint32_t b, std::uint32_t c);
};

}  // namespace alidade

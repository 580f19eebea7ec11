// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/rigid_transform.h"
#include "simulate/prism.h"
#include "simulate/site_mesh.h"

namespace alidade {

/// An element of the design: what IFC and OBJ say of it.
struct DesignItem {
  std::string name;
  std::string globalId;     ///< IFC's 22 characters
  std::string ifcType;      ///< "IfcColumn"
  std::string predefined;   ///< the type's enumeration value; empty for none
  int storey = 0;           ///< index into SiteModel::storeys
  Material material = Material::Concrete;
  std::vector<std::pair<std::string, std::string>> properties;  ///< of the element's common set
  Prism prism;
  bool built = true;        ///< false: not there yet on the day of the survey
};

struct Storey {
  std::string name;
  double elevation = 0;
};

/// A difference between design and as-built, with its amount.
struct Defect {
  std::string kind;  ///< "shifted", "tilted", "missing_opening"
  int item = -1;
  glm::dvec3 shift{0.0};          ///< "shifted": as-built minus design, site frame, metres
  double tiltRadians = 0;         ///< "tilted": about the wall's lower edge
  double topDisplacement = 0;     ///< "tilted": of the top edge along the wall's normal, metres
  glm::dvec3 axisPoint{0.0}, axisDirection{0.0};  ///< "tilted": axis in the site frame
  ProfileRectangle opening;       ///< "missing_opening": in the wall's profile plane
};

/// A point with a name, in the site frame.
struct NamedPoint {
  std::string name;
  glm::dvec3 position{0.0};
  std::string code;
  double tolerance = 0;           ///< stake points: radius; control points: sigma; metres
  glm::dvec3 normal{0, 0, 1};     ///< of the surface that a target is fixed to
};

/// The whole site in its own frame: x along the building's front, y into it, z up, origin on the ground-floor
/// slab's top; and where it stands in the world.
struct SiteModel {
  RigidTransform worldFromSite;
  double rotation = 0;  ///< radians, counter-clockwise from E to the site's x
  std::vector<Storey> storeys;
  std::vector<DesignItem> items;
  std::vector<Defect> defects;
  std::vector<NamedPoint> stakePoints;
  std::vector<NamedPoint> controlPoints;
  std::vector<glm::dvec3> stations;  ///< ground points below the scanner
  SiteMesh design;
  SiteMesh asBuilt;
};

SiteModel makeSite(std::uint32_t seed, const glm::dvec3& siteOrigin);

/// Height of the ground (with its ditch and road) at a place of the site, metres.
double groundHeight(std::uint32_t seed, double x, double y);

/// Everything that is no part of the design: ground, heaps, scaffold, container, neighbours.
void addSurroundings(SiteMesh& mesh, std::uint32_t seed);

/// The design's elements, without meshes.
void addDesignItems(SiteModel& site, std::uint32_t seed);

/// 22 characters in IFC's base 64 from a seed and a name; the same pair gives the same id.
std::string ifcGlobalId(std::uint32_t seed, const std::string& name);

}  // namespace alidade

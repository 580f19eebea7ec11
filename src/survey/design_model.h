// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "base/image.h"
#include "geometry/bounds.h"

namespace alidade {

/// One thing of the design that has a name and can be shown, hidden, selected and reported: an IFC
/// product, an OBJ group, a glTF node.
struct DesignElement {
  std::string globalId;  ///< IFC GlobalId; else a name that is stable between reads of the file
  std::string name;
  std::string type;      ///< "IfcColumn"; empty where the format has no types
  std::string storey;    ///< name of the storey or the group above
  Rgba8 colour{200, 200, 200, 255};
  std::map<std::string, std::string> properties;  ///< "Pset_ColumnCommon.LoadBearing" -> "true"

  std::uint32_t firstIndex = 0, indexCount = 0;  ///< range in DesignModel::triangles, multiple of 3
  std::uint32_t firstEdge = 0, edgeCount = 0;    ///< range in DesignModel::edges, in edges (pairs)
};

/// A design as it is drawn and inspected: a triangle mesh and its feature edges, by element.
/// Vertices are float metres relative to `origin` (world, double), so that millimetres survive at
/// 10⁷ m. `originals` keeps doubles for measuring.
struct DesignModel {
  std::string name;
  std::string crs;                                      ///< WKT, "EPSG:n" or empty
  glm::dvec3 origin{0.0};                               ///< world metres
  std::vector<glm::vec3> vertices;                      ///< relative to origin
  std::vector<std::uint32_t> triangles;                 ///< three vertex indices each, counter-clockwise from outside
  std::vector<std::array<std::uint32_t, 2>> edges;      ///< silhouette-worthy edges: borders and creases
  std::vector<DesignElement> elements;

  glm::dvec3 world(std::uint32_t vertex) const { return origin + glm::dvec3(vertices[vertex]); }
  Bounds bounds() const;
  Bounds elementBounds(std::size_t element) const;
  bool empty() const { return triangles.empty() && edges.empty(); }
};

/// What `inspect` learns of a design without its geometry.
struct DesignInfo {
  std::uint64_t elementCount = 0;  ///< products or groups named in the file
  std::string schema;              ///< "IFC4", "OBJ"
  std::string crs;
  std::string details;
};

/// Fills `edges`: edges with one triangle, or whose triangles meet at more than `creaseAngle`
/// (radians). Vertices closer than `weld` metres count as one. Works element by element.
void findFeatureEdges(DesignModel& model, double creaseAngle = 0.35, double weld = 1e-4);

}  // namespace alidade

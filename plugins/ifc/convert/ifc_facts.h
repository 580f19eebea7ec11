// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "survey/design_model.h"
#include "survey/design_stream.h"

class BuildingModel;
class IfcProduct;

namespace alidade {

/// How the file's project coordinates, in metres, become world coordinates:
/// world = offset + scale * (rotation about z) * p.
struct MapConversion {
  glm::dvec3 offset{0.0};  ///< metres
  double cosine = 1, sine = 0;
  double scale = 1;
  bool present = false;
  std::string crs;  ///< IfcProjectedCRS's name; may be empty

  glm::dvec3 operator()(const glm::dvec3& p) const {
    return offset + scale * glm::dvec3(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y, p.z);
  }
};

/// IfcMapConversion (IFC4), else ePSet_MapConversion on the site or the project (IFC2x3, buildingSMART
/// "User guide for geo-referencing in IFC"). Its units are the target's MapUnit, else the project's.
MapConversion readMapConversion(const BuildingModel& model, double metresPerUnit, std::vector<ConversionNote>& notes);

/// GlobalId, name, type, storey and property sets of a product; no geometry, default colour of its type.
DesignElement describeProduct(const std::shared_ptr<IfcProduct>& product);

/// UTF-8 of the wide strings that ifcplusplus gives; no surrogates, no control characters.
std::string utf8(const std::wstring& text);

}  // namespace alidade

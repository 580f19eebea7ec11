// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>

#include <pugixml.hpp>

#include "base/error.h"
#include "camera/camera.h"

namespace alidade {

struct MetashapeSensor {
  std::string label;
  std::optional<Intrinsics> intrinsics;
  std::string refusal;         ///< why there are no intrinsics, "the lens is …"
  bool rollingShutter = false;
};

/// One `<sensor>`. Error where its numbers are none; a lens that no model covers is a refusal in the sensor.
Result<MetashapeSensor> metashapeSensor(const pugi::xml_node& node, const std::string& path);

/// Numbers of an element: exactly `count`, all finite.
Result<std::vector<double>> metashapeNumbers(const pugi::xml_node& node, std::size_t count, const std::string& what,
                                             const std::string& path);

}  // namespace alidade

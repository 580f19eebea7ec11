// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <pugixml.hpp>

#include "base/error.h"
#include "geometry/rigid_transform.h"

namespace alidade {

// Typed look at the XML elements of an E57 file (ASTM E2807-11, 9). An element without text has its
// type's default: 0, or the empty string.

/// The name without its namespace prefix.
std::string_view localName(const pugi::xml_node& node);

/// Value of an Integer, ScaledInteger or Float element; 0 where it is empty. Nothing where the element is
/// missing or its text is no finite number.
std::optional<double> numberOf(const pugi::xml_node& node);
std::optional<std::int64_t> integerOf(const pugi::xml_node& node);
/// Text of a String element, trimmed; empty where it is missing.
std::string textOf(const pugi::xml_node& node);

/// The attribute as a number; nothing where it is missing. Error where it is no number.
Result<std::optional<double>> numberAttribute(const pugi::xml_node& node, const char* name);
Result<std::optional<std::int64_t>> integerAttribute(const pugi::xml_node& node, const char* name);

/// A pose structure: rotation (quaternion w, x, y, z; made unit) and translation. Error where a number is
/// none or not finite; a rotation that is all zero is the identity.
Result<RigidTransform> poseOf(const pugi::xml_node& node);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <string>

#include <glm/glm.hpp>

namespace alidade {

/// What a point was classified as: "ground" for 2. ASPRS LAS 1.4 R15, table 17 (point formats 6 to 10);
/// "class 31" where reserved, "user class 70" from 64 on.
std::string classificationName(std::uint8_t code);

/// A colour for each class, told apart also by lightness: ground dark, vegetation green, buildings light.
glm::u8vec3 classificationColour(std::uint8_t code);

/// "7 18" for the classes 7 and 18, and back; nothing where it is no list of numbers from 0 to 255.
std::string textOfClasses(const std::bitset<256>& classes);
std::optional<std::bitset<256>> classesOfText(const std::string& text);

}  // namespace alidade

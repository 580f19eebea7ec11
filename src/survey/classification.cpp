// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/classification.h"

#include <array>
#include <charconv>

#include <fmt/format.h>

namespace alidade {

namespace {

struct Class {
  const char* name;
  glm::u8vec3 colour;
};

constexpr std::array<Class, 23> kClasses = {{
    {"never classified", {150, 150, 150}},
    {"unclassified", {190, 190, 190}},
    {"ground", {140, 98, 57}},
    {"low vegetation", {178, 223, 138}},
    {"medium vegetation", {106, 176, 76}},
    {"high vegetation", {35, 110, 45}},
    {"building", {240, 190, 90}},
    {"low point (noise)", {214, 39, 40}},
    {"reserved (was model key)", {170, 170, 200}},
    {"water", {55, 126, 200}},
    {"rail", {120, 85, 160}},
    {"road surface", {95, 95, 105}},
    {"reserved (was overlap)", {200, 170, 170}},
    {"wire guard (shield)", {230, 130, 200}},
    {"wire conductor", {230, 80, 170}},
    {"transmission tower", {150, 60, 120}},
    {"wire connector", {250, 160, 210}},
    {"bridge deck", {200, 140, 110}},
    {"high noise", {255, 90, 60}},
    {"overhead structure", {120, 200, 210}},
    {"ignored ground", {190, 160, 125}},
    {"snow", {235, 245, 255}},
    {"temporal exclusion", {110, 60, 60}},
}};

}  // namespace

std::string classificationName(std::uint8_t code) {
  if (code < kClasses.size()) return kClasses[code].name;
  return fmt::format("{} {}", code < 64 ? "class" : "user class", code);
}

glm::u8vec3 classificationColour(std::uint8_t code) {
  if (code < kClasses.size()) return kClasses[code].colour;
  // Steps of the golden angle give neighbours distant hues.
  const std::uint32_t hash = code * 2654435769u;
  return {96 + (hash >> 24) % 160, 96 + (hash >> 16 & 255) % 160, 96 + (hash >> 8 & 255) % 160};
}

std::string textOfClasses(const std::bitset<256>& classes) {
  std::string text;
  for (std::size_t i = 0; i < classes.size(); ++i)
    if (classes[i]) text += fmt::format("{}{}", text.empty() ? "" : " ", i);
  return text;
}

std::optional<std::bitset<256>> classesOfText(const std::string& text) {
  std::bitset<256> classes;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    if (*at == ' ' || *at == ',') {
      ++at;
      continue;
    }
    std::uint8_t code = 0;
    const auto read = std::from_chars(at, end, code);
    if (read.ec != std::errc()) return std::nullopt;
    classes.set(code);
    at = read.ptr;
  }
  return classes;
}

}  // namespace alidade

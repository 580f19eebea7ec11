// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/colour_ramp.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace alidade {

namespace {

constexpr std::array<glm::u8vec3, 9> kViridis = {{{68, 1, 84}, {71, 45, 123}, {59, 82, 139}, {44, 114, 142},
                                                  {33, 145, 140}, {40, 174, 128}, {94, 201, 98}, {173, 220, 48},
                                                  {253, 231, 37}}};
constexpr std::array<glm::u8vec3, 9> kCividis = {{{0, 34, 78}, {26, 56, 111}, {67, 78, 108}, {97, 101, 111},
                                                  {124, 123, 120}, {155, 147, 116}, {188, 174, 108}, {222, 203, 90},
                                                  {254, 232, 56}}};
constexpr std::array<glm::u8vec3, 2> kGrey = {{{20, 20, 20}, {250, 250, 250}}};

std::span<const glm::u8vec3> stopsOf(ColourRamp ramp) {
  switch (ramp) {
    case ColourRamp::Viridis: return kViridis;
    case ColourRamp::Cividis: return kCividis;
    case ColourRamp::Grey: return kGrey;
  }
  return kGrey;
}

}  // namespace

glm::u8vec3 rampColour(ColourRamp ramp, double share) {
  const auto stops = stopsOf(ramp);
  const double at = (share >= 0 ? std::min(share, 1.0) : 0.0) * static_cast<double>(stops.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  return glm::u8vec3(glm::round(glm::mix(glm::dvec3(stops[low]), glm::dvec3(stops[low + 1]), at - static_cast<double>(low))));
}

std::array<std::uint16_t, 256> rampTable(ColourRamp ramp) {
  std::array<std::uint16_t, 256> table;
  for (int i = 0; i < 256; ++i) table[i] = rgb565(rampColour(ramp, i / 255.0));
  return table;
}

}  // namespace alidade

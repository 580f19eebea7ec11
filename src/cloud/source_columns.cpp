// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/source_columns.h"

#include <algorithm>
#include <cmath>

namespace alidade {

namespace {

/// Wider than any survey's coordinates, zone-prefixed eastings (6·10^7) included. Within it the
/// octree's 21 bits an axis and a node's 16 always reach a millimetre or two.
constexpr double kFarthestMeters = 1e8;

std::uint16_t rgb565(unsigned r, unsigned g, unsigned b) {
  return static_cast<std::uint16_t>(((r >> 3) << 11) | ((g >> 2) << 5) | (b >> 3));
}

}  // namespace

bool SourceColumns::isUsable(const glm::dvec3& p) {
  // NaN fails every comparison.
  return std::abs(p.x) <= kFarthestMeters && std::abs(p.y) <= kFarthestMeters &&
         std::abs(p.z) <= kFarthestMeters;
}

void SourceColumns::add(const PointBatch& batch) {
  const bool hasRgb = batch.rgb.size() == batch.size();
  const bool hasIntensity = batch.intensity.size() == batch.size();
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if ((m_size & kMask) == 0) {
      m_blocks.push_back(std::make_unique<Block>());
      const std::size_t wanted =
          std::min<std::size_t>(kMask + 1, m_blocks.size() == 1 ? batch.size() : kMask + 1);
      m_blocks.back()->position.reserve(wanted);
      m_blocks.back()->tint.reserve(wanted);
    }
    TintOf tint;
    if (hasRgb) {
      const glm::u8vec3 c = batch.rgb8(i);
      tint = {{c.r, c.g, c.b}, Tint::Rgb};
    } else if (hasIntensity) {
      const std::uint16_t v = batch.intensity[i];
      m_largestIntensity = std::max(m_largestIntensity, v);
      tint = {{static_cast<std::uint8_t>(v & 0xff), static_cast<std::uint8_t>(v >> 8), 0}, Tint::Intensity};
    }
    m_blocks.back()->position.push_back(batch.position[i]);
    m_blocks.back()->tint.push_back(tint);
    if (isUsable(batch.position[i])) {
      m_bounds.add(batch.position[i]);
    } else {
      ++m_dropped;
    }
    ++m_size;
  }
}

std::optional<glm::u8vec3> SourceColumns::colour(std::uint64_t index) const {
  const TintOf& tint = block(index).tint[index & kMask];
  if (tint.kind != Tint::Rgb) return std::nullopt;
  return glm::u8vec3(tint.value[0], tint.value[1], tint.value[2]);
}

std::uint16_t SourceColumns::displayColour(std::uint64_t index) const {
  const TintOf& tint = block(index).tint[index & kMask];
  if (tint.kind == Tint::Rgb) return rgb565(tint.value[0], tint.value[1], tint.value[2]);
  if (tint.kind == Tint::None || m_largestIntensity == 0) return rgb565(160, 160, 160);
  // Returns are few and bright at the top of the range: the root keeps the dark majority readable.
  const double share = (tint.value[0] | (tint.value[1] << 8)) / static_cast<double>(m_largestIntensity);
  const auto gray = static_cast<unsigned>(std::lround(255.0 * std::sqrt(share)));
  return rgb565(gray, gray, gray);
}

}  // namespace alidade

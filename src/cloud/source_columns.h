// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/bounds.h"
#include "survey/point_batch.h"

namespace alidade {

/// The source's points as they came, in source order: exact doubles and what tints them. Kept in
/// blocks, so that growing never copies. Dropped points keep their place, so that an index here is
/// the index in the source.
class SourceColumns {
 public:
  void add(const PointBatch& batch);

  std::uint64_t size() const { return m_size; }
  std::uint64_t droppedCount() const { return m_dropped; }
  /// Of the points that were kept.
  const Bounds& bounds() const { return m_bounds; }

  const glm::dvec3& position(std::uint64_t index) const { return block(index).position[index & kMask]; }
  std::optional<glm::u8vec3> colour(std::uint64_t index) const;
  /// The colour to draw: the source's own, else its intensity as gray, else a middle gray.
  std::uint16_t displayColour(std::uint64_t index) const;

  /// False for a point that is not finite or absurdly far away.
  static bool isUsable(const glm::dvec3& position);

 private:
  enum class Tint : std::uint8_t { None, Rgb, Intensity };
  struct TintOf {
    std::array<std::uint8_t, 3> value{};  ///< r g b, or the intensity's low and high byte
    Tint kind = Tint::None;
  };
  static constexpr int kShift = 18;
  static constexpr std::uint64_t kMask = (1u << kShift) - 1;
  struct Block {
    std::vector<glm::dvec3> position;
    std::vector<TintOf> tint;
  };
  const Block& block(std::uint64_t index) const { return *m_blocks[index >> kShift]; }

  std::vector<std::unique_ptr<Block>> m_blocks;
  std::uint64_t m_size = 0;
  std::uint64_t m_dropped = 0;
  std::uint16_t m_largestIntensity = 0;
  Bounds m_bounds;
};

}  // namespace alidade

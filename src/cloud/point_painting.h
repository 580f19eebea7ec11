// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "cloud/point_store.h"
#include "cloud/point_styler.h"
#include "survey/point_style.h"

namespace alidade {

/// The colour of points by one attribute, made ready for one style and eye.
class PointColours {
 public:
  PointColours(const ScanPoints& scan, const PointStyle& style, const glm::dvec3& eye);

  /// False where the points keep their own colour.
  bool changesAny() const { return m_by != ColourBy::Rgb || m_grey; }
  /// Fills rgb565[i] for points [first, first + count) of the node.
  void colours(const CloudNode& node, std::uint64_t first, std::uint32_t count, std::uint16_t* rgb565) const;

 private:
  template <class ValueOf>
  void ramp(std::uint32_t count, std::uint16_t* rgb565, const ValueOf& valueOf) const;

  const PointStore& m_store;
  ColourBy m_by;
  bool m_grey = false;  ///< the store lacks the column
  const AttributeColumn* m_column = nullptr;
  glm::dvec3 m_eye;
  double m_low = 0, m_scale = 0;  ///< table index = (value - low) * scale
  std::array<std::uint16_t, 256> m_table{};
};

/// Which points a style leaves in.
class PointFilter {
 public:
  PointFilter(const PointStore& store, const PointStyle& style);

  bool filtersAny() const { return !m_planes.empty() || m_classes != nullptr; }
  enum class Verdict { All, None, Some };
  /// Of the node's own points together.
  Verdict of(const CloudNode& node) const;
  /// Fills keep[i] with 1 or 0 for points [first, first + count) of the node.
  void keep(const CloudNode& node, std::uint64_t first, std::uint32_t count, std::uint8_t* keep) const;

 private:
  const PointStore& m_store;
  std::vector<ClipPlane> m_planes;
  const AttributeColumn* m_classes = nullptr;  ///< null where no class is hidden
  std::array<std::uint8_t, 256> m_classKept{};
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <optional>
#include <string>

#include "ui/render_loop.h"

namespace alidade {

/// Asks a rendered picture what is at a place. All pixels are of the *raw* picture (OpenCV's origin),
/// whatever size the picture was rendered at.
class PictureProbe {
 public:
  PictureProbe() = default;
  explicit PictureProbe(std::shared_ptr<const RenderResult> result);

  bool empty() const { return !m_result; }
  bool hasPose() const { return m_result && !m_result->problem; }
  int rawWidth() const { return m_rawWidth; }
  int rawHeight() const { return m_rawHeight; }
  glm::dvec2 resultFromRaw(const glm::dvec2& raw) const;
  /// Result pixels in one raw pixel.
  double scale() const { return m_scale; }

  CursorReadout readout(const glm::dvec2& raw) const;
  struct Element {
    DesignId design;
    int element = -1;
  };
  std::optional<Element> elementAt(const glm::dvec2& raw) const;
  AnnotationId annotationAt(const glm::dvec2& raw) const;
  /// The nearest stake point drawn within `radius` raw pixels; empty: none.
  std::string stakePointAt(const glm::dvec2& raw, double radius) const;
  std::optional<glm::dvec2> project(const glm::dvec3& world) const;
  /// Scan depth at a raw pixel, metres; NaN where unknown.
  double scanDepth(const glm::dvec2& raw) const;
  /// What the picture was made of; null before the first, and where it has no pose.
  const FrameDescription* description() const { return hasPose() ? &m_result->frame.description : nullptr; }
  /// The picture as decoded, for the magnifier; null before the first.
  const ColourImage* rawPicture() const;

 private:
  std::shared_ptr<const RenderResult> m_result;
  Camera m_scaledCamera;
  int m_rawWidth = 0, m_rawHeight = 0;
  double m_scale = 1.0;
};

/// What a rendered picture says of one element: fractions of its pixels; nothing where it has none.
struct ElementShares {
  double visible = 0, hidden = 0, unknown = 0;
  std::uint64_t pixels = 0;
};
std::optional<ElementShares> sharesOf(const RenderResult& result, DesignId design, int element);

}  // namespace alidade

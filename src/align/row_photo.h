// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "align/picture_levels.h"
#include "align/scan_view.h"

namespace alidade {

/// A photo whose rows were read one after the other while the camera moved, brought near to what the middle row's pose
/// would have seen at once, so that a view drawn from that pose finds its patches in it.
///
/// How far a pixel moved hangs on how far away what it shows is. The photo is moved by a smooth field, that of the mean
/// inverse depth around each place of the view: nothing is torn where the depth jumps, and no edge appears that the photo does not have.
/// What is nearer or farther than its surroundings lies a little beside its place then: offsetOf() says where to look, and
/// middlePixel() leads back to the photo's own pixel and from there, with the point's own depth, exactly to the middle row.
///
/// All is the photo's own where the level's shutter is not on.
class MiddleRowPhoto {
 public:
  /// `view` as drawn for the middle row's pose.
  MiddleRowPhoto(const PictureLevel& level, const ScanView& view);

  const Image<float>& luma() const { return m_moved.empty() ? m_level.luma : m_moved; }
  /// From where the middle row's pose sees a point to where luma() shows it.
  glm::dvec2 offsetOf(const glm::dvec3& pInCamera) const;
  /// Where the middle row's pose sees what luma() shows at `pixel`, as far away as a point near there.
  glm::dvec2 middlePixel(const glm::dvec2& pixel, const glm::dvec3& pInCamera) const;

 private:
  glm::dvec2 movedBy(const glm::dvec2& pixel) const;

  const PictureLevel& m_level;
  Image<glm::dvec2> m_field;  ///< photo - luma(), at every kStep-th pixel
  Image<float> m_moved;
};

/// The photo's pixel of what the middle row's pose would see at `pixel`, `depth` away along the axis; nothing where the
/// lens does not show it.
std::optional<glm::dvec2> photoPixel(const Camera& camera, const RollingShutter& shutter, const glm::dvec2& pixel, double depth);

}  // namespace alidade

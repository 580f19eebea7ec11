// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

#include "camera/camera.h"

namespace alidade {

/// The calibration as a solver's unknowns: flat parameters in the model's own order (CameraModel), with
/// the lens made from them. Projection without domain checks, and its analytic derivatives.
class VaryingCamera {
 public:
  static constexpr int largestCount = 21;

  VaryingCamera() = default;
  explicit VaryingCamera(const Intrinsics& intrinsics);

  const Intrinsics& intrinsics() const { return m_intrinsics; }
  int parameterCount() const { return m_count; }
  /// Focal lengths come first, then the principal point, then the distortion.
  int focalCount() const { return m_focalCount; }
  /// The same camera with its parameters changed by `step`.
  VaryingCamera moved(const double* step) const;

  struct Projection {
    glm::dvec2 pixel{0};
    glm::dvec3 du{0}, dv{0};                             ///< d(pixel)/d(pInCamera)
    std::array<glm::dvec2, largestCount> byParameter{};  ///< d(pixel)/d(parameter); filled on request
  };
  glm::dvec2 project(const glm::dvec3& pInCamera) const;
  void project(const glm::dvec3& pInCamera, bool byParameters, Projection& to) const;

 private:
  void distortionColumns(double x, double y, glm::dvec2* columns) const;
  glm::dvec2 flat(double x, double y) const;

  Intrinsics m_intrinsics;
  Lens<double> m_lens;
  int m_count = 0, m_focalCount = 1;
};

}  // namespace alidade

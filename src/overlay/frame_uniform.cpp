// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/frame_uniform.h"

#include <algorithm>

#include "overlay/lens_error.h"

namespace alidade {

namespace {

constexpr float kEdgeHalfWidthPx = 0.75f;
constexpr float kCasingHalfWidthPx = 1.75f;

/// Edges lie in the faces that they bound: rounding must not put them behind.
constexpr float kEdgeSlack = 1.0005f;

float flag(bool on) {
  return on ? 1.0f : 0.0f;
}

}  // namespace

double drawingScale(int width, int height, double enlargement) {
  return std::max(1.0, enlargement * std::min(width / 1920.0, height / 1080.0)) / enlargement;
}

FrameUniform frameUniform(const DrawList& list) {
  const DisplaySettings& d = list.display;
  const auto scale = static_cast<float>(drawingScale(list.width, list.height));
  const bool hasImage = list.image && !list.image->empty() && d.imagePass;
  FrameUniform u{};
  u.lens = lensUniform(list.camera);
  u.lens.domain.x = static_cast<float>(list.lensRadius);
  u.light = glm::vec4(list.lightDirection, d.ambient);
  u.shading = {d.diffuse, d.specular, std::max(d.shininess, 1.0), std::clamp(d.designOpacity, 0.0, 1.0)};
  u.picture = {flag(hasImage), flag(d.grayscaleImage), flag(d.grayscaleDesign),
               flag(hasImage && list.image->width() == list.width && list.image->height() == list.height)};
  u.scan = {flag(list.scanDepth != nullptr), d.depthToleranceM, static_cast<float>(d.hidden),
            flag(list.pointColour != nullptr)};
  u.lines = {scale * kEdgeHalfWidthPx, scale * kCasingHalfWidthPx, scale, flag(drawsEdges(list))};
  u.view = {LensError::kNearM, flag(d.designFaces), kEdgeSlack, list.camera.intrinsics().fx};
  u.hidden = {flag(drawsHiddenLayer(list)), 0, 0, 0};
  return u;
}

}  // namespace alidade

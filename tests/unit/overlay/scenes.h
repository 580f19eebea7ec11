// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <memory>
#include <vector>

#include "overlay/frame_description.h"

namespace alidade {

/// Boxes as a design: eight corners, twelve triangles, twelve edges each.
class BoxModel {
 public:
  explicit BoxModel(const glm::dvec3& origin) { m_model.origin = origin; }

  /// A box by centre and size relative to the origin, metres, as an element of its own.
  BoxModel& box(const glm::vec3& centre, const glm::vec3& size, Rgba8 colour) {
    DesignElement element;
    element.name = element.globalId = "box " + std::to_string(m_model.elements.size());
    element.colour = colour;
    element.firstIndex = static_cast<std::uint32_t>(m_model.triangles.size());
    element.firstEdge = static_cast<std::uint32_t>(m_model.edges.size());
    element.indexCount = 36;
    element.edgeCount = 12;
    const auto base = static_cast<std::uint32_t>(m_model.vertices.size());
    for (int i = 0; i < 8; ++i)
      m_model.vertices.push_back(centre +
                                 0.5f * size * glm::vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    for (const std::uint32_t i : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
      m_model.triangles.push_back(base + i);
    for (std::uint32_t i = 0; i < 8; ++i)
      for (const std::uint32_t bit : {1u, 2u, 4u})
        if (!(i & bit)) m_model.edges.push_back({base + i, base + (i | bit)});
    m_model.elements.push_back(element);
    return *this;
  }

  std::shared_ptr<const DesignModel> made() const { return std::make_shared<DesignModel>(m_model); }

 private:
  DesignModel m_model;
};

/// A camera 10 m before `target` (world), 2 m up, looking north and a little down.
inline RigidTransform poseBefore(const glm::dvec3& target) {
  return RigidTransform::cameraLookingAt(target + glm::dvec3(1.5, -10, 2), target);
}

inline Camera wideAngleCamera(int width, int height) {
  Intrinsics in;
  in.model = CameraModel::OpenCv5;
  in.width = width;
  in.height = height;
  in.fx = in.fy = 0.62 * width;
  in.cx = 0.5 * width - 1.3;
  in.cy = 0.5 * height + 0.8;
  in.distortion.k = {-0.24, 0.06, -0.006, 0, 0, 0};
  in.distortion.p1 = 5e-4;
  in.distortion.p2 = -3e-4;
  return Camera(in);
}

/// A ground of smooth stripes from dark to bright, so that casings can be judged on both.
inline std::shared_ptr<const ColourImage> stripedPicture(int width, int height) {
  auto picture = std::make_shared<ColourImage>(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto v = static_cast<std::uint8_t>(40 + 180 * ((x * 6 / width) % 2) + (y * 20) / height);
      picture->at(x, y) = {v, static_cast<std::uint8_t>(v * 15 / 16), static_cast<std::uint8_t>(v * 13 / 16),
                           255};
    }
  return picture;
}

}  // namespace alidade

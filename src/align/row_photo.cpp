// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/row_photo.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace alidade {

namespace {

constexpr int kStep = 16;
/// Depths are averaged so far around.
constexpr int kReachPx = 32;
constexpr double kFarM = 1e6;
constexpr int kSteps = 5;

struct Mean {
  double sum = 0, count = 0;
  void add(float depth) {
    if (depth > 0) sum += 1 / static_cast<double>(depth), ++count;
  }
};

/// Mean inverse depth around every node; where nothing is known there, that of all.
Image<double> inverseDepths(const DepthImage& depth, int columns, int rows) {
  Mean all;
  for (std::size_t i = 0; i < depth.size(); i += 7) all.add(depth.data()[i]);
  Image<double> nodes(columns, rows);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      Mean around = all.count > 0 ? Mean{all.sum / all.count, 1} : Mean{1 / kFarM, 1};
      for (int y = std::max(0, j * kStep - kReachPx); y <= std::min(depth.height() - 1, j * kStep + kReachPx); y += 4)
        for (int x = std::max(0, i * kStep - kReachPx); x <= std::min(depth.width() - 1, i * kStep + kReachPx); x += 4)
          around.add(depth.at(x, y));
      nodes.at(i, j) = around.sum / around.count;
    }
  return nodes;
}

}  // namespace

std::optional<glm::dvec2> photoPixel(const Camera& camera, const RollingShutter& shutter, const glm::dvec2& pixel, double depth) {
  const auto ray = camera.unproject(pixel);
  return ray ? project(camera, shutter, depth / ray->z * *ray) : std::nullopt;
}

MiddleRowPhoto::MiddleRowPhoto(const PictureLevel& level, const ScanView& view) : m_level(level) {
  if (!level.shutter.isOn() || level.luma.width() < 2 || level.luma.height() < 2) return;
  const int width = level.luma.width(), height = level.luma.height();
  m_field = Image<glm::dvec2>((width - 1) / kStep + 2, (height - 1) / kStep + 2);
  const Image<double> inverse = inverseDepths(view.depth, m_field.width(), m_field.height());
  for (int j = 0; j < m_field.height(); ++j)
    for (int i = 0; i < m_field.width(); ++i) {
      const glm::dvec2 node(std::min(kStep * i, width - 1), std::min(kStep * j, height - 1));
      const auto seen = photoPixel(level.camera, level.shutter, node, std::min(kFarM, 1 / inverse.at(i, j)));
      m_field.at(i, j) = seen ? *seen - node : glm::dvec2(0);
    }
  m_moved = Image<float>(width, height);
  parallelFor(static_cast<std::size_t>(height), 8, [&](std::size_t first, std::size_t last, int) {
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y)
      for (int x = 0; x < width; ++x) {
        const glm::dvec2 pixel(x, y);
        m_moved.at(x, y) = sampled(level.luma, pixel + movedBy(pixel));
      }
  });
}

glm::dvec2 MiddleRowPhoto::movedBy(const glm::dvec2& pixel) const {
  const double u = std::clamp(pixel.x / kStep, 0.0, m_field.width() - 1.001), v = std::clamp(pixel.y / kStep, 0.0, m_field.height() - 1.001);
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  return glm::mix(glm::mix(m_field.at(i, j), m_field.at(i + 1, j), u - i), glm::mix(m_field.at(i, j + 1), m_field.at(i + 1, j + 1), u - i), v - j);
}

glm::dvec2 MiddleRowPhoto::offsetOf(const glm::dvec3& pInCamera) const {
  if (m_moved.empty()) return glm::dvec2(0);
  const auto middle = m_level.camera.project(pInCamera), seen = project(m_level.camera, m_level.shutter, pInCamera);
  if (!middle || !seen) return glm::dvec2(0);
  glm::dvec2 at = *middle;
  for (int step = 0; step < kSteps; ++step) at = *seen - movedBy(at);
  return at - *middle;
}

glm::dvec2 MiddleRowPhoto::middlePixel(const glm::dvec2& pixel, const glm::dvec3& pInCamera) const {
  if (m_moved.empty()) return pixel;
  const Camera& camera = m_level.camera;
  const glm::dvec2 seen = pixel + movedBy(pixel);
  const RigidTransform rowFromMiddle = m_level.shutter.poseAtRow(RigidTransform::identity(), seen.y, camera.height());
  const auto ray = camera.unproject(seen);
  const double depth = (rowFromMiddle * pInCamera).z;
  const auto middle = ray ? camera.project(rowFromMiddle.inverse() * (depth / ray->z * *ray)) : std::nullopt;
  return middle ? *middle : pixel;
}

}  // namespace alidade

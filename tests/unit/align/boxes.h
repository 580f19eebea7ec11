// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "align/scan_view.h"
#include "camera/rolling_shutter.h"
#include "survey/design_model.h"

namespace alidade::test {

/// A yard with boxes on a slab, at survey coordinates. Its photo is cast ray by ray, each face in a grey of its own; its
/// shape is known as a design or as points without colour.
class Boxes {
 public:
  struct Box {
    glm::dvec3 low, high;
  };

  static glm::dvec3 world(const glm::dvec3& inYard) { return inYard + glm::dvec3(2'683'500, 1'247'800, 412); }

  static const std::vector<Box>& boxes() {
    static const std::vector<Box> all = [] {
      std::vector<Box> made = {{{-8, -6, -0.3}, {8, 12, 0}}};
      std::mt19937 random(23);
      std::uniform_real_distribution<double> unit(0, 1);
      for (int i = 0; i < 26; ++i) {
        const glm::dvec3 at(-5.5 + 11 * unit(random), 1.5 + 9 * unit(random), 0);
        made.push_back({at, at + glm::dvec3(0.3 + 1.2 * unit(random), 0.3 + 1.2 * unit(random), 0.4 + 2.4 * unit(random))});
      }
      return made;
    }();
    return all;
  }

  static DesignModel design() {
    DesignModel model;
    model.origin = world({0, 0, 0});
    for (std::size_t i = 0; i < boxes().size(); ++i) {
      const Box& box = boxes()[i];
      const auto first = static_cast<std::uint32_t>(model.vertices.size());
      for (int corner = 0; corner < 8; ++corner)
        model.vertices.emplace_back(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y, corner & 4 ? box.high.z : box.low.z);
      DesignElement element;
      element.globalId = std::to_string(i);
      element.firstIndex = static_cast<std::uint32_t>(model.triangles.size());
      for (const std::array<int, 4> face : {std::array<int, 4>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
        for (const int k : {0, 1, 2, 0, 2, 3}) model.triangles.push_back(first + static_cast<std::uint32_t>(face[k]));
      element.indexCount = static_cast<std::uint32_t>(model.triangles.size()) - element.firstIndex;
      model.elements.push_back(element);
    }
    return model;
  }

  struct Hit {
    double distance;
    int box, axis;
  };

  /// Kay and Kajiya's slabs.
  static std::optional<Hit> hit(const glm::dvec3& from, const glm::dvec3& along) {
    std::optional<Hit> best;
    for (std::size_t i = 0; i < boxes().size(); ++i) {
      double enter = 0, leave = 1e9;
      int axis = 0;
      for (int k = 0; k < 3; ++k) {
        double a = (boxes()[i].low[k] - from[k]) / along[k], b = (boxes()[i].high[k] - from[k]) / along[k];
        if (a > b) std::swap(a, b);
        if (a > enter) enter = a, axis = k;
        leave = std::min(leave, b);
      }
      if (enter > 0 && enter < leave && (!best || enter < best->distance)) best = {enter, static_cast<int>(i), axis};
    }
    return best;
  }

  /// What a scanner at this place of the yard sees, in steps of an angle: no colour, no intensity, 2 mm noise.
  static void scanFrom(const glm::dvec3& station, PointBatch& to) {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 0.002);
    constexpr double kStep = 0.0025;
    for (double azimuth = -1.3; azimuth < 1.3; azimuth += kStep)
      for (double zenith = -0.9; zenith < 0.4; zenith += kStep) {
        const glm::dvec3 along(std::sin(azimuth) * std::cos(zenith), std::cos(azimuth) * std::cos(zenith), std::sin(zenith));
        if (const auto seen = hit(station, along)) to.position.push_back(world(station + (seen->distance + noise(random)) * along));
      }
  }

  static Camera camera() {
    return Camera(*Intrinsics::fromParameters(CameraModel::OpenCv5, 800, 600, {640, 641, 402.5, 296.1, -0.11, 0.03, 4e-4, -3e-4, 0}));
  }
  static RigidTransform pose() { return RigidTransform::cameraLookingAt(world({-1.2, -4.4, 2.4}), world({0.4, 4.5, 0.6})); }

  static ColourImage photo(const Camera& camera, const RigidTransform& cameraFromWorld, const RollingShutter& shutter = {}) {
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 2);
    ColourImage image(camera.width(), camera.height());
    for (int y = 0; y < image.height(); ++y) {
      const RigidTransform pose = shutter.poseAtRow(cameraFromWorld, y, image.height());
      const glm::dmat3 toWorld = glm::transpose(pose.rotationMatrix());
      const glm::dvec3 from = pose.centre() - world({0, 0, 0});
      for (int x = 0; x < image.width(); ++x) {
        double light = 0;
        for (const glm::dvec2 part : {glm::dvec2(-0.25, -0.25), {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}}) {
          const glm::dvec3 along = toWorld * *camera.unproject(glm::dvec2(x, y) + part);
          const auto seen = hit(from, along);
          light += 0.25 * (seen ? 40 + 61 * seen->axis + 7 * (seen->box * 5 % 9) : 235);
        }
        const auto shade = static_cast<std::uint8_t>(std::clamp(light + noise(random), 0.0, 255.0));
        image.at(x, y) = {shade, shade, shade, 255};
      }
    }
    return image;
  }
};

}  // namespace alidade::test

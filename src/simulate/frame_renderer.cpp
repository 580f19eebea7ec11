// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/frame_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "simulate/random.h"

namespace alidade {

namespace {

constexpr std::uint64_t kNoiseStream = 501;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kSkyObject = 0xFFFFFFFFu;

}  // namespace

struct FrameRenderer::Sample {
  glm::vec3 radiance{0.0f};
  glm::vec3 normal{0.0f};
  double depth = kInfinity;
  std::uint32_t object = kSkyObject;
  bool sunlit = false;
};

FrameRenderer::FrameRenderer(const Camera& camera, const RayScene& asBuilt, const RayScene& design,
                             const Lighting& lighting, std::uint32_t seed, bool colour)
    : m_camera(camera),
      m_asBuilt(asBuilt),
      m_design(design),
      m_lighting(lighting),
      m_seed(seed),
      m_colour(colour),
      m_pixelAngle(static_cast<float>(1.0 / camera.intrinsics().fx)),
      m_centres(camera.width(), camera.height()) {
  parallelFor(static_cast<std::size_t>(camera.height()), 8, [&](std::size_t first, std::size_t last, int) {
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y)
      for (int x = 0; x < camera.width(); ++x) {
        const auto direction = camera.unproject({x, y});
        m_centres.at(x, y) =
            direction ? glm::dvec2(*direction) : glm::dvec2(std::numeric_limits<double>::quiet_NaN());
      }
  });
}

FrameRenderer::Sample FrameRenderer::trace(const glm::dvec3& origin, const glm::dmat3& siteFromCamera,
                                           const glm::dvec3& direction) const {
  Sample sample;
  if (!(direction.z > 0)) return sample;
  const glm::dvec3 ray = siteFromCamera * direction;
  const RayHit hit = m_asBuilt.intersect(origin, ray);
  const glm::vec3 unit(glm::normalize(ray));
  if (!hit) {
    sample.radiance = Lighting::sky(unit);
    return sample;
  }
  // z of the direction is 1: the distance along it is the depth.
  sample.depth = hit.distance;
  sample.object = m_asBuilt.mesh().triangleObject[hit.triangle];
  sample.normal = hit.faceNormal;
  const float slant = std::max(0.2f, std::abs(glm::dot(unit, hit.faceNormal)));
  const auto footprint = static_cast<float>(hit.distance) * m_pixelAngle / std::sqrt(slant);
  sample.radiance = m_lighting.shade(origin + hit.distance * ray, hit, -unit, footprint, &sample.sunlit);
  // A little haze towards the horizon.
  const float haze = 1.0f - std::exp(-static_cast<float>(hit.distance) / 420.0f);
  sample.radiance = glm::mix(sample.radiance, glm::vec3(0.86f, 0.92f, 1.0f), haze);
  return sample;
}

void FrameRenderer::traceCentres(const std::vector<RigidTransform>& siteFromCamera, Image<Sample>& samples,
                                 FrameTruth& truth) const {
  parallelFor(static_cast<std::size_t>(samples.height()), 4, [&](std::size_t first, std::size_t last, int) {
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      const RigidTransform& pose = siteFromCamera[siteFromCamera.size() > 1 ? static_cast<std::size_t>(y) : 0];
      const glm::dmat3 rotation = pose.rotationMatrix();
      const glm::dvec3 origin = pose.translation;
      for (int x = 0; x < samples.width(); ++x) {
        const glm::dvec2 centre = m_centres.at(x, y);
        if (!(centre.x == centre.x)) continue;
        const glm::dvec3 direction(centre, 1.0);
        const Sample& sample = samples.at(x, y) = trace(origin, rotation, direction);
        truth.depth.at(x, y) = static_cast<float>(sample.depth);
        const RayHit designed = m_design.intersect(origin, rotation * direction);
        if (!designed) continue;
        truth.designDepth.at(x, y) = static_cast<float>(designed.distance);
        truth.visibility.at(x, y) = sample.depth < designed.distance - kHiddenTolerance ? 2 : 1;
      }
    }
  });
}

Image<std::uint8_t> FrameRenderer::findEdges(const Image<Sample>& samples) const {
  Image<std::uint8_t> edges(samples.width(), samples.height(), 0);
  const auto extraSamples = [](const Sample& a, const Sample& b) -> std::uint8_t {
    if (a.object != b.object || a.sunlit != b.sunlit) return 4;
    if (a.object == kSkyObject) return 0;
    if (glm::dot(a.normal, b.normal) < 0.9f || std::abs(a.depth - b.depth) > 0.06 * a.depth) return 4;
    const glm::vec3 d = glm::abs(glm::sqrt(a.radiance) - glm::sqrt(b.radiance));
    return d.x + d.y + d.z > 0.30f ? 2 : 0;
  };
  const auto compare = [&](int x, int y, int otherX, int otherY) {
    const std::uint8_t extra = extraSamples(samples.at(x, y), samples.at(otherX, otherY));
    for (std::uint8_t* edge : {&edges.at(x, y), &edges.at(otherX, otherY)}) *edge = std::max(*edge, extra);
  };
  for (int y = 0; y < samples.height(); ++y)
    for (int x = 0; x < samples.width(); ++x) {
      if (x + 1 < samples.width()) compare(x, y, x + 1, y);
      if (y + 1 < samples.height()) compare(x, y, x, y + 1);
    }
  return edges;
}

glm::dvec3 FrameRenderer::directionAt(double x, double y) const {
  const int column = std::clamp(static_cast<int>(std::floor(x)), 0, m_centres.width() - 2);
  const int row = std::clamp(static_cast<int>(std::floor(y)), 0, m_centres.height() - 2);
  const double u = x - column, v = y - row;
  const glm::dvec2 d =
      glm::mix(glm::mix(m_centres.at(column, row), m_centres.at(column + 1, row), u),
               glm::mix(m_centres.at(column, row + 1), m_centres.at(column + 1, row + 1), u), v);
  return d.x == d.x && d.y == d.y ? glm::dvec3(d, 1.0) : glm::dvec3(0.0);
}

Rgba8 FrameRenderer::develop(const glm::vec3& radiance, int x, int y, int frame) const {
  Random random(m_seed, kNoiseStream + static_cast<std::uint64_t>(frame) * 1000,
                static_cast<std::uint64_t>(y) * m_centres.width() + x);
  const glm::dvec2 d = m_centres.at(x, y);
  const auto r2 = static_cast<float>(d.x == d.x ? glm::dot(d, d) : 0.0);
  const float vignetting = 1.0f / ((1.0f + 0.30f * r2) * (1.0f + 0.30f * r2));
  const auto noisy = [&random](float value) {
    // Shot noise grows with the light (sigma² = value / full well), read noise is constant.
    const float sigma = std::sqrt(std::max(0.0f, value) * 1.5e-4f + 9e-6f);
    return std::max(0.0f, value + sigma * random.quickNormal());
  };
  glm::vec3 light = radiance * vignetting;
  if (m_colour) {
    light = {noisy(light.r), noisy(light.g), noisy(light.b)};
  } else {
    light = glm::vec3(noisy(glm::dot(light, glm::vec3(0.299f, 0.587f, 0.114f))));
  }
  const glm::vec3 shown = glm::clamp(255.0f * displayColour(light) + 0.5f, 0.0f, 255.0f);
  return {static_cast<std::uint8_t>(shown.r), static_cast<std::uint8_t>(shown.g),
          static_cast<std::uint8_t>(shown.b), 255};
}

ColourImage FrameRenderer::render(const std::vector<RigidTransform>& cameraFromSite, int frame, FrameTruth& truth) const {
  const int width = m_camera.width(), height = m_camera.height();
  const auto infinity = static_cast<float>(kInfinity);
  truth = {DepthImage(width, height, infinity), DepthImage(width, height, infinity),
           Image<std::uint8_t>(width, height, 0)};
  std::vector<RigidTransform> siteFromCamera;
  for (const RigidTransform& pose : cameraFromSite) siteFromCamera.push_back(pose.inverse());
  Image<Sample> samples(width, height);
  traceCentres(siteFromCamera, samples, truth);
  const Image<std::uint8_t> edges = findEdges(samples);
  ColourImage picture(width, height);
  parallelFor(static_cast<std::size_t>(height), 4, [&](std::size_t first, std::size_t last, int) {
    // The first two lie across from each other, so that two of them are even as well.
    static constexpr double offsets[4][2] = {
        {-0.375, -0.125}, {0.375, 0.125}, {0.125, -0.375}, {-0.125, 0.375}};
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      const RigidTransform& pose = siteFromCamera[siteFromCamera.size() > 1 ? static_cast<std::size_t>(y) : 0];
      const glm::dmat3 rotation = pose.rotationMatrix();
      for (int x = 0; x < width; ++x) {
        glm::vec3 radiance = samples.at(x, y).radiance;
        const int extra = edges.at(x, y);
        for (int i = 0; i < extra; ++i) {
          const glm::dvec3 direction = directionAt(x + offsets[i][0], y + offsets[i][1]);
          radiance += trace(pose.translation, rotation, direction).radiance;
        }
        radiance /= static_cast<float>(1 + extra);
        picture.at(x, y) = develop(radiance, x, y, frame);
      }
    }
  });
  return picture;
}

}  // namespace alidade

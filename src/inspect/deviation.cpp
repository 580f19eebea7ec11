// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "inspect/deviation.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

#include <embree3/rtcore.h>

#include "base/parallel.h"

namespace alidade {

namespace {

struct DeviceDeleter {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceDeleter>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneDeleter>;

/// Closest point on a triangle (Ericson 2005, Real-Time Collision Detection, 5.1.5).
glm::vec3 closestOnTriangle(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::vec3 ab = b - a, ac = c - a, ap = p - a;
  const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const glm::vec3 bp = p - b;
  const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const glm::vec3 cp = p - c;
  const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const float denominator = 1.0f / (va + vb + vc);
  return a + ab * (vb * denominator) + ac * (vc * denominator);
}

struct Nearest {
  const DesignModel* design;
  std::uint32_t triangle = RTC_INVALID_GEOMETRY_ID;
  glm::vec3 point{0};
};

bool visitTriangle(RTCPointQueryFunctionArguments* args) {
  auto* nearest = static_cast<Nearest*>(args->userPtr);
  const DesignModel& design = *nearest->design;
  const glm::vec3 p(args->query->x, args->query->y, args->query->z);
  const std::uint32_t* index = &design.triangles[3 * std::size_t{args->primID}];
  const glm::vec3 on = closestOnTriangle(p, design.vertices[index[0]], design.vertices[index[1]], design.vertices[index[2]]);
  const float distance = glm::length(on - p);
  if (distance >= args->query->radius) return false;
  args->query->radius = distance;
  nearest->triangle = args->primID;
  nearest->point = on;
  return true;
}

Scene buildScene(RTCDevice device, const DesignModel& design) {
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                           design.vertices.size());
  void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            3 * sizeof(std::uint32_t), design.triangles.size() / 3);
  if (vertices && triangles) {
    std::copy(design.vertices.begin(), design.vertices.end(), static_cast<glm::vec3*>(vertices));
    std::copy(design.triangles.begin(), design.triangles.end(), static_cast<std::uint32_t*>(triangles));
  }
  rtcSetGeometryPointQueryFunction(geometry, visitTriangle);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return Scene(scene);
}

std::vector<std::uint32_t> elementOfTriangle(const DesignModel& design) {
  std::vector<std::uint32_t> owner(design.triangles.size() / 3, 0);
  for (std::size_t e = 0; e < design.elements.size(); ++e) {
    const DesignElement& element = design.elements[e];
    std::fill_n(owner.begin() + element.firstIndex / 3, element.indexCount / 3, static_cast<std::uint32_t>(e));
  }
  return owner;
}

glm::vec3 faceNormal(const DesignModel& design, std::uint32_t triangle) {
  const std::uint32_t* index = &design.triangles[3 * std::size_t{triangle}];
  const glm::vec3& a = design.vertices[index[0]];
  return glm::cross(design.vertices[index[1]] - a, design.vertices[index[2]] - a);
}

}  // namespace

Result<void> DeviationOptions::validate() const {
  if (!(searchM > 0) || !std::isfinite(searchM)) return fail("The search distance must be above 0 m", "deviation options");
  if (maximumPoints == 0) return fail("At least one point must be used", "deviation options");
  return {};
}

Result<std::vector<ElementDeviation>> deviations(const PointStore& cloud, const DesignModel& design,
                                                 const DeviationOptions& options, const Progress& progress) {
  if (auto valid = options.validate(); !valid) return fail(valid.error());
  if (design.triangles.empty()) return std::vector<ElementDeviation>{};
  const Device device(rtcNewDevice(nullptr));
  if (!device) return fail("The ray-query library could not start", "Embree");
  const Scene scene = buildScene(device.get(), design);
  const auto owner = elementOfTriangle(design);

  const std::uint64_t total = cloud.pointCount();
  const double share = std::min(1.0, static_cast<double>(options.maximumPoints) / static_cast<double>(std::max<std::uint64_t>(total, 1)));
  const double levelLimit = cloud.levelOfShare(share);
  std::vector<std::vector<float>> byElement(design.elements.size());
  std::mutex mutex;
  parallelFor(cloud.nodes().size(), 1, [&](std::size_t first, std::size_t last, int) {
    if (progress.cancelled()) return;
    std::vector<std::pair<std::uint32_t, float>> found;
    for (std::size_t n = first; n < last; ++n) {
      const CloudNode& node = cloud.nodes()[n];
      const std::uint32_t used = cloud.countBelow(static_cast<std::uint32_t>(n), levelLimit);
      for (std::uint64_t i = node.first; i < node.first + used; ++i) {
        const glm::vec3 p(cloud.sourcePosition(i) - design.origin);
        RTCPointQuery query{p.x, p.y, p.z, 0.0f, static_cast<float>(options.searchM)};
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        Nearest nearest{&design};
        rtcPointQuery(scene.get(), &query, &context, nullptr, &nearest);
        if (nearest.triangle == RTC_INVALID_GEOMETRY_ID) continue;
        const float sign = glm::dot(p - nearest.point, faceNormal(design, nearest.triangle)) < 0 ? -1.0f : 1.0f;
        found.emplace_back(owner[nearest.triangle], sign * glm::length(p - nearest.point));
      }
    }
    std::lock_guard lock(mutex);
    for (const auto& [element, distance] : found) byElement[element].push_back(distance);
    progress.report(static_cast<double>(last) / static_cast<double>(cloud.nodes().size()), "Comparing scan and design");
  });
  if (progress.cancelled()) return fail(cancelledError());

  std::vector<ElementDeviation> result;
  for (std::size_t e = 0; e < byElement.size(); ++e) {
    auto& distances = byElement[e];
    if (distances.empty()) continue;
    ElementDeviation deviation;
    deviation.element = static_cast<std::uint32_t>(e);
    deviation.points = distances.size();
    std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
    deviation.medianM = distances[distances.size() / 2];
    for (float& d : distances) d = std::abs(d);
    const std::size_t p95 = distances.size() * 95 / 100;
    std::nth_element(distances.begin(), distances.begin() + p95, distances.end());
    deviation.p95M = distances[p95];
    result.push_back(deviation);
  }
  return result;
}

}  // namespace alidade

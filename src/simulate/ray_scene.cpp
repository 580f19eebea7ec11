// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/ray_scene.h"

#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include <embree3/rtcore.h>

namespace alidade {

struct RayScene::Handles {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~Handles() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

RayScene::RayScene() : m_handles(std::make_unique<Handles>()) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

Result<RayScene> RayScene::make(const SiteMesh& mesh) {
  RayScene made;
  made.m_mesh = &mesh;
  // One thread builds the tree, so that a ray along a shared edge meets the same triangle in every run.
  made.m_handles->device = rtcNewDevice("threads=1,set_affinity=0");
  if (!made.m_handles->device)
    return fail("The ray tracing library does not start", "Embree 3", "Check libembree3");
  RTCDevice device = made.m_handles->device;
  RTCScene scene = made.m_handles->scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
                              mesh.triangles.size()));
  if (!vertices || !indices) {
    rtcReleaseGeometry(geometry);
    return fail("Not enough memory for the site's triangles", "Embree 3");
  }
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) vertices[3 * i + axis] = static_cast<float>(mesh.positions[i][axis]);
  std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  if (const RTCError code = rtcGetDeviceError(device); code != RTC_ERROR_NONE)
    return fail("The ray tracing library reports error " + std::to_string(static_cast<int>(code)),
                "Embree 3");
  return made;
}

RayHit RayScene::intersect(const glm::dvec3& origin, const glm::dvec3& direction, double farthest) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(origin.x);
  query.ray.org_y = static_cast<float>(origin.y);
  query.ray.org_z = static_cast<float>(origin.z);
  query.ray.dir_x = static_cast<float>(direction.x);
  query.ray.dir_y = static_cast<float>(direction.y);
  query.ray.dir_z = static_cast<float>(direction.z);
  query.ray.tnear = 0.0f;
  query.ray.tfar = static_cast<float>(farthest);
  query.ray.mask = 0xFFFFFFFFu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(m_handles->scene, &context, &query);
  RayHit hit;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.triangle = query.hit.primID;
  const auto& corner = m_mesh->triangles[hit.triangle];
  const glm::dvec3 a = m_mesh->positions[corner[0]];
  const glm::dvec3 cross = glm::cross(m_mesh->positions[corner[1]] - a, m_mesh->positions[corner[2]] - a);
  const double slope = glm::dot(cross, direction);
  const double exact = glm::dot(cross, a - origin) / slope;
  // A ray that grazes the plane keeps Embree's own distance.
  hit.distance = std::abs(exact - query.ray.tfar) < 1e-3 * (1.0 + query.ray.tfar) ? exact : query.ray.tfar;
  const float towards = slope > 0 ? -1.0f : 1.0f;
  hit.faceNormal = towards * glm::vec3(glm::normalize(cross));
  const float u = query.hit.u, v = query.hit.v;
  const glm::vec3 smooth = (1 - u - v) * m_mesh->normals[corner[0]] + u * m_mesh->normals[corner[1]] +
                           v * m_mesh->normals[corner[2]];
  hit.normal = towards * glm::normalize(smooth);
  if (!(glm::dot(hit.normal, hit.faceNormal) > 0.05f)) hit.normal = hit.faceNormal;
  return hit;
}

bool RayScene::occluded(const glm::dvec3& origin, const glm::dvec3& direction, double farthest) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x);
  ray.org_y = static_cast<float>(origin.y);
  ray.org_z = static_cast<float>(origin.z);
  ray.dir_x = static_cast<float>(direction.x);
  ray.dir_y = static_cast<float>(direction.y);
  ray.dir_z = static_cast<float>(direction.z);
  ray.tfar = static_cast<float>(farthest);
  ray.mask = 0xFFFFFFFFu;
  rtcOccluded1(m_handles->scene, &context, &ray);
  return ray.tfar < 0;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "unit/align/rendered_house.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "io/picture_file.h"
#include "io/project_store.h"
#include "io/reader_registry.h"
#include "plugin_api/reader.h"
#include "simulate/camera_path.h"
#include "simulate/frame_renderer.h"
#include "simulate/lighting.h"
#include "simulate/ray_scene.h"
#include "simulate/site_mesh.h"

namespace alidade::test {

namespace {

Material materialOf(const std::string& type) {
  const auto is = [&](const char* word) { return type.find(word) != std::string::npos; };
  if (is("Window")) return Material::Glass;
  if (is("Door") || is("Member") || is("Stair")) return Material::Wood;
  if (is("Roof") || is("Covering")) return Material::RoofTile;
  if (is("Slab") || is("Footing") || is("Column")) return Material::Concrete;
  if (is("Railing") || is("Beam")) return Material::Galvanised;
  return Material::Render;
}

/// The simulator's light is baked around its own origin: the design is moved there, and the poses back.
void addDesign(const DesignModel& model, const glm::dvec3& siteInWorld, SiteMesh& mesh) {
  for (const DesignElement& element : model.elements) {
    SiteObject object;
    object.name = element.name;
    object.material = materialOf(element.type + element.name);
    mesh.beginObject(object);
    for (std::uint32_t i = element.firstIndex; i < element.firstIndex + element.indexCount; i += 3)
      mesh.addTriangle(model.world(model.triangles[i]) - siteInWorld, model.world(model.triangles[i + 1]) - siteInWorld,
                       model.world(model.triangles[i + 2]) - siteInWorld);
  }
}

void addSurroundings(double reach, SiteMesh& mesh) {
  const auto begin = [&](Material material) {
    SiteObject object;
    object.material = material;
    mesh.beginObject(object);
  };
  begin(Material::Grass);
  mesh.addQuad({-90, -90, 0}, {90, -90, 0}, {90, 90, 0}, {-90, 90, 0});
  for (int i = 0; i < 7; ++i) {  // pallets, posts, trees: what stands around a house, none of it in the design
    const double a = 0.4 + i * 2 * std::numbers::pi / 7, r = reach * (0.85 + 0.12 * (i % 3));
    const glm::dvec3 at(r * std::cos(a), r * std::sin(a), 0);
    begin(i % 2 == 0 ? Material::Plywood : Material::Brick);
    mesh.addBox(at, at + glm::dvec3(1.2 + 0.3 * (i % 3), 0.8, 0.6 + 0.25 * (i % 4)));
    begin(Material::Wood);
    const glm::dvec3 trunk = 1.9 * at + glm::dvec3(0.7, -0.4, 0);
    mesh.addCylinder(trunk, trunk + glm::dvec3(0, 0, 4), 0.18);
    begin(Material::Foliage);
    mesh.addCylinder(trunk + glm::dvec3(0, 0, 3), trunk + glm::dvec3(0, 0, 7), 1.6, 9);
  }
}

}  // namespace

Result<Project> renderedHouse(const std::string& designFile, const std::string& folder, int views, int width, int height) {
  const auto reader = ReaderRegistry::instance().findAs<DesignReader>(designFile);
  if (!reader) return fail(reader.error());
  std::vector<ImportWarning> warnings;
  const auto model = (*reader)->read(designFile, Progress(), warnings);
  if (!model) return fail(model.error());
  const Bounds bounds = model->bounds();
  const glm::dvec3 siteInWorld(bounds.centre().x, bounds.centre().y, 0);
  const double reach = 0.5 * glm::length(glm::dvec2(bounds.size()));

  SiteMesh built, designed;
  addDesign(*model, siteInWorld, designed);
  addDesign(*model, siteInWorld, built);
  addSurroundings(reach, built);
  const auto builtScene = RayScene::make(built), designScene = RayScene::make(designed);
  if (!builtScene || !designScene) return fail(builtScene ? designScene.error() : builtScene.error());
  const Lighting lighting(*builtScene);
  const Camera camera(demoIntrinsics(width, height));
  const FrameRenderer renderer(camera, *builtScene, *designScene, lighting, 3, true);

  Project project;
  project.display.depthPass = false;
  Design design;
  design.id = {1};
  design.source = *describeSource(designFile);
  project.designs.push_back(design);
  project.cameras.push_back({CameraId{1}, "camera", camera});
  for (int i = 0; i < views; ++i) {
    const double a = 0.3 + i * 2 * std::numbers::pi / views, r = reach * 1.25 + 4 + (i % 3);
    const glm::dvec3 eye(r * std::cos(a), r * std::sin(a), 1.7 + 0.6 * (i % 2)), target(0.3 * (i % 3), -0.4, 2.6);
    const RigidTransform cameraFromSite = RigidTransform::cameraLookingAt(eye, target);
    FrameTruth truth;
    Frame frame;
    frame.id = {i + 1};
    frame.name = fmt::format("view_{}.png", i);
    frame.timeSecs = i;
    frame.camera = {1};
    frame.image.path = folder + "/" + frame.name;
    if (auto written = writePng(renderer.render({cameraFromSite}, i, truth), frame.image.path, {}); !written) return fail(written.error());
    frame.cameraFromWorld = cameraFromSite * RigidTransform{{1, 0, 0, 0}, -siteInWorld};
    frame.poseSource = PoseSource::File;
    project.frames.push_back(std::move(frame));
  }
  return project;
}

}  // namespace alidade::test

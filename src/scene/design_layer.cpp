// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/design_layer.h"

#include <algorithm>

#include <vtkGenericCell.h>
#include <vtkProperty.h>

namespace alidade {

namespace {

constexpr glm::dvec3 kEdgeColour{0.08, 0.09, 0.10};
constexpr glm::dvec3 kSelectionColour{1.0, 0.62, 0.10};

bool isVisible(const SceneDesign& design, std::size_t element) {
  return element >= design.elementVisible.size() || design.elementVisible[element] != 0;
}

std::vector<glm::vec3> localVertices(const DesignModel& model, const glm::dvec3& origin) {
  const glm::dvec3 shift = model.origin - origin;
  std::vector<glm::vec3> local(model.vertices.size());
  std::transform(model.vertices.begin(), model.vertices.end(), local.begin(),
                 [&](const glm::vec3& v) { return glm::vec3(shift + glm::dvec3(v)); });
  return local;
}

/// Lines win over the faces they lie in (VTK's own offsets see to it), the selection over both.
void bringForward(const LitActor& actor, double factor, double units) {
  actor.mapper->SetResolveCoincidentTopologyToPolygonOffset();
  actor.mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(factor, units);
  actor.mapper->SetRelativeCoincidentTopologyLineOffsetParameters(factor, units);
}

/// The part of `indices` from `first` that the model really has.
std::span<const std::uint32_t> trianglesOfElement(const DesignModel& model, const DesignElement& element) {
  const std::size_t first = std::min<std::size_t>(element.firstIndex, model.triangles.size());
  const std::size_t count = std::min<std::size_t>(element.indexCount, model.triangles.size() - first);
  return std::span(model.triangles).subspan(first, count - count % 3);
}

std::span<const std::array<std::uint32_t, 2>> edgesOfElement(const DesignModel& model, const DesignElement& element) {
  const std::size_t first = std::min<std::size_t>(element.firstEdge, model.edges.size());
  return std::span(model.edges).subspan(first, std::min<std::size_t>(element.edgeCount, model.edges.size() - first));
}

}  // namespace

SceneDesignLayer::SceneDesignLayer(vtkRenderer* renderer)
    : m_renderer(renderer),
      m_selectedFaces(makeActor(kSelectionColour, true)),
      m_selectedEdges(makeActor({1.0, 0.85, 0.4}, false)) {
  bringForward(m_selectedFaces, -1.0, -1.0);
  bringForward(m_selectedEdges, -1.0, -2.0);
  m_renderer->AddActor(m_selectedFaces.actor);
  m_renderer->AddActor(m_selectedEdges.actor);
}

SceneDesignLayer::~SceneDesignLayer() = default;

void SceneDesignLayer::clearParts() {
  for (const Part& part : m_parts)
    for (const LitActor& each : {part.opaque, part.clear, part.edges}) m_renderer->RemoveActor(each.actor);
  m_parts.clear();
  m_bounds = Bounds();
}

void SceneDesignLayer::build(const glm::dvec3& origin) {
  m_origin = origin;
  clearParts();
  for (const SceneDesign& design : m_designs)
    if (design.model) addPart(design);
  setLineScale(m_lineScale);
  buildSelection();
}

void SceneDesignLayer::addPart(const SceneDesign& design) {
  const DesignModel& model = *design.model;
  const std::vector<glm::vec3> local = localVertices(model, m_origin);
  Part part;
  part.id = design.id;
  std::vector<std::uint32_t> all, opaque, clear;
  std::vector<Rgba8> opaqueColours, clearColours;
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::size_t e = 0; e < model.elements.size(); ++e) {
    if (!isVisible(design, e)) continue;
    const DesignElement& element = model.elements[e];
    const auto triangles = trianglesOfElement(model, element);
    const bool solid = element.colour.a == 255;
    std::vector<std::uint32_t>& target = solid ? opaque : clear;
    target.insert(target.end(), triangles.begin(), triangles.end());
    std::vector<Rgba8>& colours = solid ? opaqueColours : clearColours;
    colours.insert(colours.end(), triangles.size() / 3, element.colour);
    all.insert(all.end(), triangles.begin(), triangles.end());
    part.elementOfTriangle.insert(part.elementOfTriangle.end(), triangles.size() / 3, static_cast<int>(e));
    const auto lines = edgesOfElement(model, element);
    edges.insert(edges.end(), lines.begin(), lines.end());
    m_bounds.add(model.elementBounds(e));
  }
  part.faces = trianglesOf(local, all, {});
  part.locator = vtkSmartPointer<vtkStaticCellLocator>::New();
  part.locator->SetDataSet(part.faces);
  if (!all.empty()) part.locator->BuildLocator();

  part.opaque = makeActor({1, 1, 1}, true);
  part.opaque.mapper->SetInputData(trianglesOf(local, opaque, opaqueColours));
  part.clear = makeActor({1, 1, 1}, true);
  part.clear.mapper->SetInputData(trianglesOf(local, clear, clearColours));
  part.edges = makeActor(kEdgeColour, false);
  part.edges.mapper->SetInputData(linesOf(local, edges));
  for (const LitActor& each : {part.opaque, part.clear}) {
    each.actor->GetProperty()->SetInterpolationToFlat();
    each.actor->GetProperty()->SetAmbient(0.25);
    each.actor->GetProperty()->SetDiffuse(0.75);
    bringForward(each, 0.0, 0.0);
  }
  bringForward(part.edges, 0.0, 0.0);
  for (const LitActor& each : {part.opaque, part.clear, part.edges}) m_renderer->AddActor(each.actor);
  m_parts.push_back(std::move(part));
}

void SceneDesignLayer::select(DesignId design, int element) {
  m_selectedDesign = design;
  m_selectedElement = element;
  buildSelection();
}

void SceneDesignLayer::buildSelection() {
  std::vector<glm::vec3> local;
  std::span<const std::uint32_t> triangles;
  std::span<const std::array<std::uint32_t, 2>> edges;
  for (const SceneDesign& design : m_designs) {
    if (!design.model || design.id != m_selectedDesign || m_selectedElement < 0) continue;
    const auto index = static_cast<std::size_t>(m_selectedElement);
    if (index >= design.model->elements.size()) continue;
    local = localVertices(*design.model, m_origin);
    triangles = trianglesOfElement(*design.model, design.model->elements[index]);
    edges = edgesOfElement(*design.model, design.model->elements[index]);
  }
  m_selectedFaces.mapper->SetInputData(trianglesOf(local, triangles, {}));
  m_selectedFaces.actor->GetProperty()->SetInterpolationToFlat();
  m_selectedFaces.actor->GetProperty()->SetAmbient(0.35);
  m_selectedEdges.mapper->SetInputData(linesOf(local, edges));
}

void SceneDesignLayer::setLineScale(double devicePixelRatio) {
  m_lineScale = devicePixelRatio;
  for (const Part& part : m_parts) part.edges.actor->GetProperty()->SetLineWidth(static_cast<float>(devicePixelRatio));
  m_selectedEdges.actor->GetProperty()->SetLineWidth(static_cast<float>(2.5 * devicePixelRatio));
}

std::optional<LayerHit> SceneDesignLayer::hit(const ViewCamera& camera, const glm::dvec2& px) const {
  const ViewRay ray = camera.rayThrough(px);
  const glm::dvec3 from = ray.origin - m_origin;
  const double reach = m_bounds.empty() ? 0.0 : glm::length(ray.origin - m_bounds.centre()) + m_bounds.diagonal();
  const glm::dvec3 to = from + reach * ray.direction;
  std::optional<LayerHit> best;
  for (const Part& part : m_parts) {
    if (part.elementOfTriangle.empty()) continue;
    double t = 0;
    glm::dvec3 x(0), parametric(0);
    int subId = 0;
    vtkIdType cell = -1;
    auto generic = vtkSmartPointer<vtkGenericCell>::New();
    if (part.locator->IntersectWithLine(&from.x, &to.x, 1e-9, t, &x.x, &parametric.x, subId, cell, generic) == 0)
      continue;
    if (cell < 0 || static_cast<std::size_t>(cell) >= part.elementOfTriangle.size()) continue;
    LayerHit found;
    found.pick.world = ray.origin + (t * reach) * ray.direction;
    found.pick.design = part.id;
    found.pick.element = part.elementOfTriangle[static_cast<std::size_t>(cell)];
    found.depth = camera.depthOf(found.pick.world);
    if (!best || found.depth < best->depth) best = found;
  }
  return best;
}

}  // namespace alidade

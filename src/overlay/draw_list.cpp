// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/draw_list.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "overlay/row_motion.h"
#include "overlay/subdivision.h"

namespace alidade {

namespace {

// Pieces after subdivision, over the whole frame: hostile input costs memory up to here, beyond it
// only what it holds itself.
constexpr std::size_t kPieceBudget = 3'000'000;
constexpr std::uint32_t kJobSize = 4096;

/// Part of an element that one thread works on at a time.
struct Job {
  std::size_t layer = 0;
  std::uint32_t element = 0;  // in the picture's count, from 1
  std::size_t first = 0;      // into DesignModel::triangles (indices) or edges
  std::size_t count = 0;      // triangles or edges
  bool isSurface = false;
};

struct Piece {
  std::vector<SurfaceVertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<EdgeVertex> edges;
  double worstErrorPx = 0;
};

bool isShown(const DesignLayer& layer, std::size_t element) {
  return element >= layer.elementVisible.size() || layer.elementVisible[element] != 0;
}

/// Vertices of a model in camera axes. The origin is moved in double and the offsets are only turned,
/// so that nothing is lost at 10⁷ m.
std::vector<glm::dvec3> verticesInCamera(const DesignModel& model, const RigidTransform& cameraFromWorld) {
  const glm::dvec3 originInCamera = cameraFromWorld * model.origin;
  const glm::dmat3 rotation = cameraFromWorld.rotationMatrix();
  std::vector<glm::dvec3> inCamera(model.vertices.size());
  parallelFor(inCamera.size(), 16384, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i)
      inCamera[i] = originInCamera + rotation * glm::dvec3(model.vertices[i]);
  });
  return inCamera;
}

void addJobs(std::vector<Job>& jobs, Job job, std::size_t stride) {
  const std::size_t total = job.count;
  const std::size_t start = job.first;
  for (std::size_t done = 0; done < total; done += kJobSize) {
    job.first = start + done * stride;
    job.count = std::min<std::size_t>(kJobSize, total - done);
    jobs.push_back(job);
  }
}

std::vector<Job> jobsOf(const FrameDescription& frame) {
  std::vector<Job> jobs;
  std::uint32_t id = 0;
  for (std::size_t l = 0; l < frame.designs.size(); ++l) {
    const DesignLayer& layer = frame.designs[l];
    if (!layer.model) continue;
    const DesignModel& model = *layer.model;
    for (std::size_t e = 0; e < model.elements.size(); ++e) {
      ++id;
      if (!isShown(layer, e)) continue;
      const DesignElement& element = model.elements[e];
      const bool facesFit = std::size_t{element.firstIndex} + element.indexCount <= model.triangles.size();
      const bool edgesFit = std::size_t{element.firstEdge} + element.edgeCount <= model.edges.size();
      if (facesFit) addJobs(jobs, {l, id, element.firstIndex, element.indexCount / 3, true}, 3);
      if (edgesFit && frame.display.designEdges)
        addJobs(jobs, {l, id, element.firstEdge, element.edgeCount, false}, 1);
    }
  }
  return jobs;
}

bool isFinite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

Piece workOn(const Job& job, const DesignModel& model, const std::vector<glm::dvec3>& inCamera,
             const LensError& lens, const RowMotion& rows, std::size_t budget) {
  Piece piece;
  const auto isUsable = [&](std::uint32_t vertex) {
    return vertex < inCamera.size() && isFinite(inCamera[vertex]);
  };
  if (job.isSurface) {
    SurfaceSplitter splitter(lens, budget);
    splitter.vertices.reserve(2 * job.count);
    splitter.indices.reserve(3 * job.count);
    for (std::size_t i = 0; i < job.count; ++i) {
      const std::uint32_t* corner = model.triangles.data() + job.first + 3 * i;
      if (!isUsable(corner[0]) || !isUsable(corner[1]) || !isUsable(corner[2])) continue;
      const std::array<glm::dvec3, 3> triangle{inCamera[corner[0]], inCamera[corner[1]], inCamera[corner[2]]};
      if (rows.isOn()) rows.surface(triangle, [&](const auto& part) { splitter.add(part, job.element); });
      else splitter.add(triangle, job.element);
    }
    piece.vertices = std::move(splitter.vertices);
    piece.indices = std::move(splitter.indices);
  } else {
    EdgeSplitter splitter(lens, budget);
    splitter.vertices.reserve(2 * job.count);
    for (std::size_t i = 0; i < job.count; ++i) {
      const auto& edge = model.edges[job.first + i];
      if (!isUsable(edge[0]) || !isUsable(edge[1])) continue;
      const glm::dvec3 &a = inCamera[edge[0]], &b = inCamera[edge[1]];
      if (rows.isOn())
        rows.edge(a, b, [&](const auto& from, const auto& to, double along) { splitter.add(from, to, job.element, along); });
      else splitter.add(a, b, job.element);
    }
    piece.edges = std::move(splitter.vertices);
    piece.worstErrorPx = splitter.worstErrorPx;
  }
  return piece;
}

void join(DrawList& list, std::vector<Piece>& pieces) {
  std::vector<std::size_t> vertexStart(pieces.size()), indexStart(pieces.size()), edgeStart(pieces.size());
  std::size_t vertexCount = 0, indexCount = 0, edgeCount = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    vertexStart[i] = vertexCount;
    indexStart[i] = indexCount;
    edgeStart[i] = edgeCount;
    vertexCount += pieces[i].vertices.size();
    indexCount += pieces[i].indices.size();
    edgeCount += pieces[i].edges.size();
    list.worstErrorPx = std::max(list.worstErrorPx, pieces[i].worstErrorPx);
  }
  list.surface.resize(vertexCount);
  list.triangles.resize(indexCount);
  list.edges.resize(edgeCount);
  parallelFor(pieces.size(), 1, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      std::copy(pieces[i].vertices.begin(), pieces[i].vertices.end(), list.surface.begin() + vertexStart[i]);
      std::copy(pieces[i].edges.begin(), pieces[i].edges.end(), list.edges.begin() + edgeStart[i]);
      const auto offset = static_cast<std::uint32_t>(vertexStart[i]);
      std::transform(pieces[i].indices.begin(), pieces[i].indices.end(),
                     list.triangles.begin() + indexStart[i],
                     [offset](std::uint32_t index) { return index + offset; });
    }
  });
}

std::vector<ElementStyle> stylesOf(const FrameDescription& frame) {
  std::vector<ElementStyle> styles;
  for (const DesignLayer& layer : frame.designs) {
    if (!layer.model) continue;
    const std::size_t first = styles.size();
    const auto shapes = shapesOf(layer.model);
    for (std::size_t e = 0; e < layer.model->elements.size(); ++e) {
      const DesignElement& element = layer.model->elements[e];
      const Rgba8 c = e < layer.elementColour.size() ? layer.elementColour[e] : element.colour;
      ElementStyle style;
      style.colour = glm::vec4(c.r, c.g, c.b, c.a) / 255.0f;
      style.edgesAlone = element.indexCount == 0;
      style.winding = (*shapes)[e].winding;
      style.hiddenRank = hiddenRank((*shapes)[e].area);
      styles.push_back(style);
    }
    for (const std::uint32_t selected : layer.selected)
      if (selected < layer.model->elements.size()) styles[first + selected].selected = 1;
  }
  return styles;
}

glm::vec3 lightInCamera(const FrameDescription& frame) {
  const glm::dvec3 light = frame.cameraFromWorld.rotation * frame.display.lightDirection;
  const double length = glm::length(light);
  return length > 0 && std::isfinite(length) ? glm::vec3(light / length) : glm::vec3(0, 0, 1);
}

}  // namespace

DrawList buildDrawList(const FrameDescription& frame, const Camera& scaledCamera) {
  DrawList list;
  list.width = scaledCamera.width();
  list.height = scaledCamera.height();
  list.camera = scaledCamera;
  list.display = frame.display;
  list.lightDirection = lightInCamera(frame);
  list.styles = stylesOf(frame);
  const LensError lens(scaledCamera, frame.display.subdivisionErrorPx);
  list.lensRadius = lens.radius();
  list.lensFolds = lens.foldsInPicture();
  const RowMotion rows(scaledCamera, frame.shutter, frame.display.subdivisionErrorPx);
  if (!frame.display.designPass || !frame.cameraFromWorld.isFinite()) return list;

  std::vector<std::vector<glm::dvec3>> inCamera(frame.designs.size());
  for (std::size_t i = 0; i < frame.designs.size(); ++i)
    if (frame.designs[i].model)
      inCamera[i] = verticesInCamera(*frame.designs[i].model, frame.cameraFromWorld);

  const std::vector<Job> jobs = jobsOf(frame);
  std::size_t total = 0;
  for (const Job& job : jobs) total += job.count;
  std::vector<Piece> pieces(jobs.size());
  parallelFor(jobs.size(), 1, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      // A fixed share of the budget a job: the list does not depend on how threads interleave.
      const double share = static_cast<double>(jobs[i].count) / static_cast<double>(total);
      const auto budget = static_cast<std::size_t>(share * static_cast<double>(kPieceBudget));
      pieces[i] = workOn(jobs[i], *frame.designs[jobs[i].layer].model, inCamera[jobs[i].layer], lens, rows, budget);
    }
  });
  join(list, pieces);
  return list;
}

}  // namespace alidade

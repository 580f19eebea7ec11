// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/mesh_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "base/parallel.h"
#include "base/widest.h"
#include "raster/mesh_kernel.h"
#include "raster/splat_pass.h"

namespace alidade {

namespace {

constexpr float kNearestMeters = 0.02f;
constexpr float kLargestPart = 32.0f;
constexpr int kHalvings = 24;
/// Neighbours agree within this part of their inverse depth.
constexpr float kAgree = 0.02f;
constexpr int kAgreeing = 6;
constexpr std::size_t kRowsAtATime = 32;

using Quad = std::array<glm::dvec3, 4>;  ///< in the camera's frame

/// Side planes of a pyramid that holds all that the lens sees.
class ViewPyramid {
 public:
  explicit ViewPyramid(const Camera& camera) : m_radius(1.01 * camera.imageRadius()) {}

  template <class Points>
  bool isOutside(const Points& points) const {
    const auto all = [&points](auto test) { return std::all_of(points.begin(), points.end(), test); };
    if (all([](const glm::dvec3& p) { return p.z < kNearestMeters; })) return true;
    if (!std::isfinite(m_radius)) return false;
    return all([this](const glm::dvec3& p) { return p.x > m_radius * p.z; }) ||
           all([this](const glm::dvec3& p) { return -p.x > m_radius * p.z; }) ||
           all([this](const glm::dvec3& p) { return p.y > m_radius * p.z; }) ||
           all([this](const glm::dvec3& p) { return -p.y > m_radius * p.z; });
  }

 private:
  double m_radius;
};

/// Cuts what the kernel leaves: at the near plane, then in halves until a part is small on screen.
class PartDrawer {
 public:
  PartDrawer(const Camera& camera, const MeshView& view, const MeshTarget& target)
      : m_camera(camera), m_pyramid(camera), m_view(view), m_target(target) {
    std::fill_n(m_view.m, 9, 0.0f);
    m_view.m[0] = m_view.m[4] = m_view.m[8] = 1.0f;
    std::fill_n(m_view.t, 3, 0.0f);
    // Each part was checked by the camera itself.
    m_view.insideSquared = std::numeric_limits<float>::infinity();
    m_view.largestPart = std::numeric_limits<float>::infinity();
    m_view.nearest = 0.5f * kNearestMeters;
  }

  void draw(const Quad& quad) {
    if (m_pyramid.isOutside(quad)) return;
    std::array<glm::dvec3, 8> polygon;
    std::size_t corners = 0;
    for (int i = 0; i < 4; ++i) {
      const glm::dvec3 &a = quad[i], &b = quad[(i + 1) & 3];
      const double da = a.z - kNearestMeters, db = b.z - kNearestMeters;
      if (da >= 0) polygon[corners++] = a;
      if (da * db < 0) polygon[corners++] = a + (b - a) * (da / (da - db));
    }
    for (std::size_t i = 1; i + 1 < corners; i += 2)
      halve({polygon[0], polygon[i], polygon[i + 1], polygon[std::min(i + 2, corners - 1)]}, kHalvings);
  }

  void flush() {
    if (m_count == 0) return;
    for (int k = 0; k < 4; ++k) {
      std::fill(m_pack.x[k] + m_count, m_pack.x[k] + OccluderPack::kQuads,
                std::numeric_limits<float>::quiet_NaN());
    }
    std::uint32_t left[OccluderPack::kQuads];
    meshKernel().draw(m_view, &m_pack, 1, m_target, left);
    m_count = 0;
  }

 private:
  void halve(const Quad& quad, int depth) {
    if (m_pyramid.isOutside(quad)) return;
    std::array<glm::dvec2, 4> pixel;
    int seen = 0;
    for (int i = 0; i < 4; ++i) {
      const auto at = m_camera.project(quad[i]);
      seen += at.has_value();
      if (at) pixel[i] = *at;
    }
    if (seen < 4) {
      for (int i = 0; i < 4; ++i) pixel[i] = m_camera.intrinsics().fx * glm::dvec2(quad[i]) / quad[i].z;
    }
    const auto side = [&](int i, int j) { return glm::length(pixel[i] - pixel[j]); };
    const double along = std::max(side(0, 1), side(3, 2)), across = std::max(side(1, 2), side(0, 3));
    if (seen == 4) {
      const auto [left, right] = std::minmax({pixel[0].x, pixel[1].x, pixel[2].x, pixel[3].x});
      const auto [top, bottom] = std::minmax({pixel[0].y, pixel[1].y, pixel[2].y, pixel[3].y});
      if (right < -1 || left > m_camera.width() || bottom < -1 || top > m_camera.height()) return;
      if (right - left <= kLargestPart && bottom - top <= kLargestPart) return add(quad);
    } else if (std::max(along, across) < 2.0) {
      return;  // on the border of what the lens sees
    }
    if (depth == 0) return;
    const auto middle = [&](int i, int j) { return 0.5 * (quad[i] + quad[j]); };
    // A side that is seen in part is long, whatever its ends say.
    const bool cutAlong = seen == 4 ? along >= across
                                    : glm::length(quad[0] - quad[1]) + glm::length(quad[3] - quad[2]) >=
                                          glm::length(quad[1] - quad[2]) + glm::length(quad[0] - quad[3]);
    if (cutAlong) {
      const glm::dvec3 a = middle(0, 1), b = middle(3, 2);
      halve({quad[0], a, b, quad[3]}, depth - 1);
      halve({a, quad[1], quad[2], b}, depth - 1);
    } else {
      const glm::dvec3 a = middle(1, 2), b = middle(0, 3);
      halve({quad[0], quad[1], a, b}, depth - 1);
      halve({b, a, quad[2], quad[3]}, depth - 1);
    }
  }

  void add(const Quad& quad) {
    for (int k = 0; k < 4; ++k) {
      m_pack.x[k][m_count] = static_cast<float>(quad[k].x);
      m_pack.y[k][m_count] = static_cast<float>(quad[k].y);
      m_pack.z[k][m_count] = static_cast<float>(quad[k].z);
    }
    if (++m_count == OccluderPack::kQuads) flush();
  }

  const Camera& m_camera;
  ViewPyramid m_pyramid;
  MeshView m_view;
  MeshTarget m_target;
  OccluderPack m_pack{};
  int m_count = 0;
};

struct BlockTask {
  const OccluderMesh* mesh = nullptr;
  const OccluderBlock* block = nullptr;
  MeshView view;
};

std::vector<BlockTask> blocksInView(const std::vector<std::shared_ptr<const OccluderMesh>>& meshes,
                                    const Camera& camera, const RigidTransform& cameraFromWorld) {
  const SplatView lens = baseView(camera, {});
  const ViewPyramid pyramid(camera);
  const glm::dmat3 rotation = cameraFromWorld.rotationMatrix();
  std::vector<BlockTask> tasks;
  for (const auto& mesh : meshes) {
    if (!mesh) continue;
    for (const OccluderBlock& block : mesh->blocks) {
      // Eye first, then rotate: the large coordinates cancel before anything is multiplied by them.
      const glm::dvec3 origin = rotation * (mesh->origins[block.station] - cameraFromWorld.centre());
      std::array<glm::dvec3, 8> corners;
      for (int i = 0; i < 8; ++i) {
        const glm::dvec3 corner(i & 1 ? block.high.x : block.low.x, i & 2 ? block.high.y : block.low.y,
                                i & 4 ? block.high.z : block.low.z);
        corners[i] = rotation * corner + origin;
      }
      if (pyramid.isOutside(corners)) continue;
      BlockTask task{mesh.get(), &block, {}};
      MeshView& view = task.view;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
          view.m[3 * row + column] = static_cast<float>(rotation[column][row]);
        view.t[row] = static_cast<float>(origin[row]);
      }
      view.lens = lens.lens;
      view.fx = lens.fx, view.fy = lens.fy, view.cx = lens.cx, view.cy = lens.cy;
      view.insideSquared = lens.surelyInsideSquared;
      view.width = camera.width(), view.height = camera.height();
      view.nearest = kNearestMeters;
      view.largestPart = kLargestPart;
      tasks.push_back(task);
    }
  }
  return tasks;
}

void drawBlock(const BlockTask& task, const Camera& camera, const MeshTarget& target,
               std::vector<std::uint32_t>& left) {
  left.resize(std::size_t{task.block->packCount} * OccluderPack::kQuads);
  const OccluderPack* packs = task.mesh->packs.data() + task.block->firstPack;
  const std::uint32_t count =
      meshKernel().draw(task.view, packs, task.block->packCount, target, left.data());
  if (count == 0) return;
  PartDrawer parts(camera, task.view, target);
  const float* m = task.view.m;
  for (std::uint32_t i = 0; i < count; ++i) {
    const OccluderPack& pack = packs[left[i] / OccluderPack::kQuads];
    const std::uint32_t lane = left[i] % OccluderPack::kQuads;
    Quad quad;
    for (int k = 0; k < 4; ++k) {
      const glm::dvec3 p(pack.x[k][lane], pack.y[k][lane], pack.z[k][lane]);
      for (int row = 0; row < 3; ++row)
        quad[k][row] = m[3 * row] * p.x + m[3 * row + 1] * p.y + m[3 * row + 2] * p.z + task.view.t[row];
    }
    parts.draw(quad);
  }
  parts.flush();
}

/// The mean of the neighbours that agree with the one in their middle; 0 where fewer than six do.
float fromNeighbours(const Image<float>& drawn, int x, int y) {
  std::array<float, 8> around{};  // ascending
  int known = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if ((dx == 0 && dy == 0) || !drawn.contains(x + dx, y + dy)) continue;
      const float w = drawn.at(x + dx, y + dy);
      if (w <= 0) continue;
      int place = known++;
      for (; place > 0 && around[place - 1] > w; --place) around[place] = around[place - 1];
      around[place] = w;
    }
  }
  if (known < kAgreeing) return 0;
  const float middle = around[known / 2];
  float sum = 0;
  int agreeing = 0;
  for (int i = 0; i < known; ++i) {
    if (std::abs(around[i] - middle) > kAgree * middle) continue;
    sum += around[i];
    ++agreeing;
  }
  return agreeing >= kAgreeing ? sum / static_cast<float>(agreeing) : 0;
}

ALIDADE_WIDEST void takeNearer(const float* from, std::size_t count, float* to) {
  for (std::size_t i = 0; i < count; ++i) to[i] = from[i] > to[i] ? from[i] : to[i];
}

ALIDADE_WIDEST std::size_t countBare(const float* inverse, std::size_t count) {
  std::uint32_t bare = 0;
  for (std::size_t i = 0; i < count; ++i) bare += inverse[i] <= 0.0f;
  return bare;
}

/// What neighbours tell of bare pixels between them, all from the picture as it was drawn.
void fillCracks(Image<float>& drawn) {
  constexpr int kStretch = 64;  // most have no bare pixel, or nothing else
  struct Filled {
    std::size_t at;
    float inverse;
  };
  const auto height = static_cast<std::size_t>(drawn.height());
  std::vector<std::vector<Filled>> bands((height + kRowsAtATime - 1) / kRowsAtATime);
  parallelFor(height, kRowsAtATime, [&](std::size_t first, std::size_t last, int) {
    std::vector<Filled>& filled = bands[first / kRowsAtATime];
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      for (int from = 0; from < drawn.width(); from += kStretch) {
        const int to = std::min(from + kStretch, drawn.width());
        const auto count = static_cast<std::size_t>(to - from);
        const std::size_t bare = countBare(drawn.row(y) + from, count);
        if (bare == 0) continue;
        const auto isBare = [&](int row) { return row < 0 || row >= drawn.height() || countBare(drawn.row(row) + from, count) == count; };
        // Then none of them has six neighbours, those at the ends neither.
        if (bare == count && isBare(y - 1) && isBare(y + 1)) continue;
        for (int x = from; x < to; ++x) {
          if (drawn.at(x, y) > 0) continue;
          if (const float inverse = fromNeighbours(drawn, x, y); inverse > 0)
            filled.push_back({static_cast<std::size_t>(y) * static_cast<std::size_t>(drawn.width()) + static_cast<std::size_t>(x), inverse});
        }
      }
    }
  });
  for (const std::vector<Filled>& band : bands)
    for (const Filled& pixel : band) drawn.data()[pixel.at] = pixel.inverse;
}

}  // namespace

Image<float> drawMeshes(const std::vector<std::shared_ptr<const OccluderMesh>>& meshes, const Camera& camera,
                        const RigidTransform& cameraFromWorld) {
  const int width = camera.width(), height = camera.height();
  const std::vector<BlockTask> tasks = blocksInView(meshes, camera, cameraFromWorld);
  if (tasks.empty()) return Image<float>(width, height, 0.0f);
  const int stride = (width + kMeshRowSlack + 15) / 16 * 16;
  struct Worker {
    Image<float> pixels;  ///< none until it draws
    std::vector<std::uint32_t> left;
  };
  std::vector<Worker> workers(workerCount());
  parallelFor(tasks.size(), 1, [&](std::size_t first, std::size_t last, int index) {
    Worker& worker = workers[index];
    if (worker.pixels.empty()) worker.pixels = Image<float>(stride, height, 0.0f);
    const MeshTarget target{worker.pixels.data(), stride};
    for (std::size_t i = first; i < last; ++i) drawBlock(tasks[i], camera, target, worker.left);
  });
  std::erase_if(workers, [](const Worker& worker) { return worker.pixels.empty(); });
  Image<float> drawn(width, height, Uncleared{});
  parallelFor(static_cast<std::size_t>(height), kRowsAtATime, [&](std::size_t first, std::size_t last, int) {
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      std::copy_n(workers[0].pixels.row(y), width, drawn.row(y));
      for (std::size_t w = 1; w < workers.size(); ++w) takeNearer(workers[w].pixels.row(y), static_cast<std::size_t>(width), drawn.row(y));
    }
  });
  fillCracks(drawn);
  return drawn;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "base/parallel.h"
#include "overlay/device.h"
#include "overlay/frame_uniform.h"
#include "overlay/lens_error.h"
#include "overlay/paint_kernel.h"
#include "raster/triangle_bins.h"

namespace alidade {

namespace {

const PaintKernel& paintKernel() {
#if defined(__x86_64__)
  const TriangleKernel* kernel = &triangleKernel();
  if (kernel == &kAvx512TriangleKernel) return kAvx512PaintKernel;
  if (kernel == &kAvx2TriangleKernel) return kAvx2PaintKernel;
#endif
  return kScalarPaintKernel;
}

/// Memory for `count` values on a boundary of 128 bytes, kept from frame to frame, not cleared; 64 bytes to
/// spare.
template <class T>
class Scratch {
 public:
  T* reserve(std::size_t count) {
    const std::size_t bytes = count * sizeof(T) + 192;
    if (m_bytes.size() < bytes) m_bytes = std::vector<Byte>(bytes);
    const auto address = reinterpret_cast<std::uintptr_t>(m_bytes.data());
    return reinterpret_cast<T*>((address + 127) & ~std::uintptr_t{127});
  }

 private:
  struct Byte {
    std::byte value;
    Byte() {}  // on purpose: a fresh vector is not cleared
  };
  std::vector<Byte> m_bytes;
};

/// One thread's tile, all of it rows of kTileSize.
struct Worker {
  Scratch<std::uint32_t> memory;
  std::vector<EdgePixel> taken, tileTaken = std::vector<EdgePixel>(kTilePixels);

  static constexpr std::size_t kPlane = kTilePixels + 32;
  std::uint32_t* plane(int i) { return memory.reserve(6 * kPlane) + static_cast<std::size_t>(i) * kPlane; }
  float* floats(int i) { return reinterpret_cast<float*>(plane(i)); }
};

/// Bins triangles into tiles, keeps the nearest of each pixel with its depth, shades what is left once a
/// pixel, then draws edges and composes with the camera image, tile by tile again, since both ask their
/// neighbours.
class CpuOverlayDevice final : public OverlayDevice {
 public:
  std::string name() const override {
    const int threads = workerCount();
    return fmt::format("CPU ({}, {} {})", triangleKernel().name, threads,
                       threads == 1 ? "thread" : "threads");
  }
  Result<Output> draw(const DrawList& list) override;

 private:
  void setUp(const DrawList& list, Output& output);
  void projectFaces(const DrawList& list);
  void projectEdges(const DrawList& list);
  void drawFaces(const DrawList& list);
  void composeTiles(const DrawList& list, Output& output);
  std::array<std::uint64_t, HiddenSet::kWords> hiddenAround(std::size_t tile) const;
  bool shines(const ScreenTriangle& triangle, const std::uint32_t (&corner)[3]) const;
  ScreenEdge edgeOf(const DrawList& list, std::size_t edge) const;

  PaintFrame m_frame{};
  LensView m_lens{};
  float m_insideSquared = 0;
  float m_dimmestCosine = 0;  // between normal and half-way vector where the highlight is half a grey level
  std::vector<PaintStyle> m_styles;
  ScreenCorners m_corners{};
  ScreenPoints m_ends{};
  ScreenTriangle* m_triangles = nullptr;
  ScreenEdge* m_edges = nullptr;
  TileBins m_faceBins, m_edgeBins;
  std::vector<std::uint64_t> m_hiddenSets;  // a tile after the other
  std::vector<Worker> m_workers = std::vector<Worker>(workerCount());

  Scratch<float> m_cornerMemory, m_endMemory;
  Scratch<ScreenTriangle> m_triangleMemory;
  Scratch<ScreenEdge> m_edgeMemory;
  Scratch<std::uint32_t> m_faceColour;
  Scratch<std::uint8_t> m_key;
  Scratch<float> m_hiddenDepth;
};

std::uint32_t byteOf(float share) {
  return static_cast<std::uint32_t>(std::clamp(share, 0.0f, 1.0f) * 255.0f + 0.5f);
}

/// What of a face's look does not depend on the pixel, as in design_surface.vert.
std::uint32_t litColour(const DrawList& list, const ElementStyle& style, const glm::vec3& normal) {
  const DisplaySettings& d = list.display;
  const glm::vec3 selection(1.0f, 0.55f, 0.05f);
  const float lit = static_cast<float>(d.ambient) +
                    static_cast<float>(d.diffuse) * std::max(glm::dot(normal, -list.lightDirection), 0.0f);
  const glm::vec3 own(style.colour);
  const glm::vec3 c = lit * (style.selected ? glm::mix(own, selection, 0.6f) : own);
  float opacity = static_cast<float>(std::clamp(d.designOpacity, 0.0, 1.0)) * style.colour.a;
  if (style.selected) opacity = std::max(opacity, 0.7f);
  return byteOf(c.r) | byteOf(c.g) << 8 | byteOf(c.b) << 16 | byteOf(opacity) << 24;
}

void CpuOverlayDevice::setUp(const DrawList& list, Output& output) {
  const std::size_t pixels = static_cast<std::size_t>(list.width) * list.height;
  const FrameUniform u = frameUniform(list);
  m_lens.lens = Lens<float>(list.camera.lens().d.cast<float>());
  m_lens.fx = u.lens.focal.x;
  m_lens.fy = u.lens.focal.y;
  m_lens.cx = u.lens.focal.z;
  m_lens.cy = u.lens.focal.w;
  m_insideSquared =
      list.lensFolds ? u.lens.domain.x * u.lens.domain.x : std::numeric_limits<float>::infinity();

  m_styles.clear();
  for (const ElementStyle& style : list.styles)
    m_styles.push_back({{255 * style.colour.r, 255 * style.colour.g, 255 * style.colour.b},
                        style.colour.a,
                        style.selected,
                        style.edgesAlone,
                        static_cast<float>(style.hiddenRank)});

  PaintFrame& f = m_frame;
  f.width = list.width;
  f.height = list.height;
  const bool hasImage = u.picture.x > 0;
  f.image = hasImage ? reinterpret_cast<const std::uint32_t*>(list.image->data()) : nullptr;
  f.imageWidth = hasImage ? list.image->width() : 0;
  f.imageHeight = hasImage ? list.image->height() : 0;
  f.imageFits = u.picture.w > 0;
  f.grayImage = u.picture.y > 0;
  f.grayDesign = u.picture.z > 0;
  f.scanDepth = list.scanDepth ? list.scanDepth->data() : nullptr;
  f.tolerance = u.scan.y;
  f.hiddenStyle = static_cast<int>(list.display.hidden);
  f.points = list.pointColour ? reinterpret_cast<const std::uint32_t*>(list.pointColour->data()) : nullptr;
  for (int k = 0; k < 3; ++k) f.light[k] = list.lightDirection[k];
  f.specular = u.shading.y;
  f.shininess = u.shading.z;
  m_dimmestCosine =
      f.specular > 0 ? std::min(1.0f, std::pow(0.5f / (255 * f.specular), 1 / f.shininess)) : 1.0f;
  f.drawsFaces = list.display.designFaces && !list.triangles.empty();
  f.drawsEdges = drawsEdges(list);
  f.hasHiddenLayer = drawsHiddenLayer(list);
  f.edgeHalfWidth = u.lines.x;
  f.casingHalfWidth = u.lines.y;
  f.scale = u.lines.z;
  f.edgeSlack = u.view.z;
  f.pixelsAtOneMetre = u.view.w;
  f.styles = m_styles.data();
  f.faceColour = m_faceColour.reserve(pixels);
  f.key = m_key.reserve(pixels);
  f.element = output.element.data();
  f.faceDepth = output.designDepth.data();
  f.state = output.state.data();
  f.hiddenElement = output.hiddenElement.data();
  f.hiddenDepth = f.hasHiddenLayer ? m_hiddenDepth.reserve(pixels) : nullptr;
  f.colour = reinterpret_cast<std::uint32_t*>(output.colour.data());
}

/// False only where no place of the triangle comes near enough to the highlight's axis for half a grey level.
bool CpuOverlayDevice::shines(const ScreenTriangle& t, const std::uint32_t (&corner)[3]) const {
  const glm::vec3 normal(t.normal[0], t.normal[1], t.normal[2]);
  const glm::vec3 light(m_frame.light[0], m_frame.light[1], m_frame.light[2]);
  if (!(m_frame.specular > 0) || glm::dot(normal, light) >= 0) return false;
  const auto place = [&](int k) { return glm::vec2(m_corners.nx[corner[k]], m_corners.ny[corner[k]]); };
  const glm::vec2 a = place(0);
  // The view turns by less than this over the triangle, and the half-way vector by less than 1.5 times as
  // much while light and view are no more than 139 degrees apart.
  const float turn = glm::length(place(1) - a) + glm::length(place(2) - a);
  const glm::vec3 halfway = -light - glm::normalize(glm::vec3(a, 1));
  const float length2 = glm::dot(halfway, halfway);
  if (turn > 0.3f || length2 < 0.5f) return true;
  return glm::dot(normal, halfway) / std::sqrt(length2) > m_dimmestCosine - 1.5f * turn;
}

void CpuOverlayDevice::projectFaces(const DrawList& list) {
  const std::size_t vertices = list.surface.size(), count = list.triangles.size() / 3;
  float* memory = m_cornerMemory.reserve(5 * vertices);
  m_corners = {reinterpret_cast<std::int32_t*>(memory), reinterpret_cast<std::int32_t*>(memory + vertices),
               memory + 2 * vertices, memory + 3 * vertices, memory + 4 * vertices};
  parallelFor(vertices, 8192, [&](std::size_t first, std::size_t last, int) {
    const ScreenCorners out{m_corners.x + first, m_corners.y + first, m_corners.w + first,
                            m_corners.nx + first, m_corners.ny + first};
    triangleKernel().projectCorners(m_lens, &list.surface[first].pInCamera.x, sizeof(SurfaceVertex) / 4,
                                    last - first, out);
  });
  m_triangles = m_triangleMemory.reserve(count);
  m_frame.triangles = m_triangles;
  const auto prepare = [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      ScreenTriangle& t = m_triangles[i];
      const std::uint32_t corner[3] = {list.triangles[3 * i], list.triangles[3 * i + 1],
                                       list.triangles[3 * i + 2]};
      setUpTriangle(m_corners, corner, list.width, list.height, t);
      if (t.right < t.left) continue;
      const SurfaceVertex& v = list.surface[corner[0]];
      const ElementStyle& style = list.styles[v.element - 1];
      // Two-sided: the side that is seen is the side that is lit.
      const bool facesAway = glm::dot(v.normal, v.pInCamera) > 0;
      const glm::vec3 normal = facesAway ? -v.normal : v.normal;
      const bool isInside =
          style.winding != Winding::Open && facesAway == (style.winding == Winding::Outwards);
      t.owner = v.element;
      t.rank = isInside ? -1.0f : static_cast<float>(style.hiddenRank);
      for (int k = 0; k < 3; ++k) t.normal[k] = normal[k];
      t.colour = litColour(list, style, normal);
      t.mark = 1 + v.element % 63;
      if (shines(t, corner)) t.mark |= kShines;
    }
  };
  m_faceBins.fill(
      count, prepare, [&](std::size_t i) -> const ScreenTriangle& { return m_triangles[i]; },
      [&](std::size_t i, int left, int top) { return touchesTile(m_triangles[i], left, top); });
}

void CpuOverlayDevice::drawFaces(const DrawList& list) {
  m_faceBins.reset(list.width, list.height);
  if (!list.triangles.empty()) projectFaces(list);
  m_hiddenSets.resize(m_faceBins.tileCount() * HiddenSet::kWords);
  const TriangleKernel& raster = triangleKernel();
  const PaintKernel& paint = paintKernel();
  parallelFor(m_faceBins.tileCount(), 1, [&](std::size_t index, std::size_t, int which) {
    const TileBins::Tile bin = m_faceBins.tile(index);
    Worker& worker = m_workers[which];
    const VisibilityTile tile{bin.left, bin.top, worker.floats(0), worker.plane(1)};
    std::fill_n(tile.inverseDepth, kTilePixels, 0.0f);
    if (bin.count > 0) raster.draw(m_triangles, bin.list, bin.count, m_insideSquared, tile);
    if (!m_frame.hasHiddenLayer) {
      paint.resolve(m_frame, tile, nullptr, nullptr);
      return;
    }
    const SecondLayerTile second{bin.left,         bin.top,          worker.plane(2),
                                 worker.floats(3), worker.floats(4), worker.plane(5)};
    paint.resolve(m_frame, tile, worker.plane(2), worker.floats(3));
    if (bin.count > 0)
      raster.drawSecond(m_triangles, bin.list, bin.count, m_insideSquared,
                        static_cast<float>(LensError::kNearM), second);
    paint.resolveSecond(m_frame, second, m_hiddenSets.data() + index * HiddenSet::kWords);
  });
}

ScreenEdge CpuOverlayDevice::edgeOf(const DrawList& list, std::size_t edge) const {
  ScreenEdge e;
  const std::size_t a = 2 * edge, b = a + 1;
  const float dx = m_ends.x[b] - m_ends.x[a], dy = m_ends.y[b] - m_ends.y[a];
  e.x = m_ends.x[a];
  e.y = m_ends.y[a];
  e.length = std::sqrt(dx * dx + dy * dy);
  if (!(e.length > 1e-4f)) return e;
  e.ux = dx / e.length;
  e.uy = dy / e.length;
  e.w0 = m_ends.w[a];
  e.dw = (m_ends.w[b] - m_ends.w[a]) / e.length;
  e.q0 = list.edges[a].along * m_ends.w[a];
  e.dq = (list.edges[b].along * m_ends.w[b] - e.q0) / e.length;
  e.element = list.edges[a].element;
  e.mark = 1 + e.element % 63;
  e.rank = static_cast<float>(list.styles[e.element - 1].hiddenRank);
  const float reach = m_frame.casingHalfWidth + 0.5f;
  const float reachX = reach * std::abs(e.uy), reachY = reach * std::abs(e.ux);
  const float left = std::ceil(std::min(e.x, e.x + dx) - reachX),
              right = std::floor(std::max(e.x, e.x + dx) + reachX);
  const float top = std::ceil(std::min(e.y, e.y + dy) - reachY),
              bottom = std::floor(std::max(e.y, e.y + dy) + reachY);
  const auto width = static_cast<float>(m_frame.width), height = static_cast<float>(m_frame.height);
  if (right < 0 || bottom < 0 || left >= width || top >= height) return e;
  e.left = static_cast<std::int16_t>(std::max(left, 0.0f));
  e.top = static_cast<std::int16_t>(std::max(top, 0.0f));
  e.right = static_cast<std::int16_t>(std::min(right, width - 1));
  e.bottom = static_cast<std::int16_t>(std::min(bottom, height - 1));
  return e;
}

void CpuOverlayDevice::projectEdges(const DrawList& list) {
  const std::size_t ends = list.edges.size(), count = ends / 2;
  float* memory = m_endMemory.reserve(3 * ends);
  m_ends = {memory, memory + ends, memory + 2 * ends};
  m_edges = m_edgeMemory.reserve(count);
  const auto prepare = [&](std::size_t first, std::size_t last) {
    const ScreenPoints out{m_ends.x + 2 * first, m_ends.y + 2 * first, m_ends.w + 2 * first};
    triangleKernel().projectPoints(m_lens, &list.edges[2 * first].pInCamera.x, sizeof(EdgeVertex) / 4,
                                   2 * (last - first), out);
    for (std::size_t i = first; i < last; ++i) m_edges[i] = edgeOf(list, i);
  };
  const float reach = m_frame.casingHalfWidth + 0.5f;
  const auto touches = [&](std::size_t i, int left, int top) {
    constexpr float half = 0.5f * kTileSize;
    const ScreenEdge& e = m_edges[i];
    const float dx = static_cast<float>(left) + half - e.x, dy = static_cast<float>(top) + half - e.y;
    return std::abs(e.ux * dy - e.uy * dx) <= reach + half * (std::abs(e.ux) + std::abs(e.uy));
  };
  m_edgeBins.fill(
      count, prepare, [&](std::size_t i) -> const ScreenEdge& { return m_edges[i]; }, touches);
}

/// The union of a tile's set with those of its neighbours: a line's own place may lie in them.
std::array<std::uint64_t, HiddenSet::kWords> CpuOverlayDevice::hiddenAround(std::size_t tile) const {
  std::array<std::uint64_t, HiddenSet::kWords> shown{};
  const int columns = m_faceBins.columns(), rows = m_faceBins.rows();
  const int column = static_cast<int>(tile) % columns, row = static_cast<int>(tile) / columns;
  for (int y = std::max(0, row - 1); y <= std::min(rows - 1, row + 1); ++y)
    for (int x = std::max(0, column - 1); x <= std::min(columns - 1, column + 1); ++x) {
      const std::uint64_t* set =
          m_hiddenSets.data() + (static_cast<std::size_t>(y) * columns + x) * HiddenSet::kWords;
      for (int i = 0; i < HiddenSet::kWords; ++i) shown[i] |= set[i];
    }
  return shown;
}

void CpuOverlayDevice::composeTiles(const DrawList& list, Output& output) {
  m_edgeBins.reset(list.width, list.height);
  if (m_frame.drawsEdges) projectEdges(list);
  const bool drawsBehind = m_frame.hasHiddenLayer && list.display.hidden != HiddenStyle::Hide;
  const PaintKernel& paint = paintKernel();
  parallelFor(m_edgeBins.tileCount(), 1, [&](std::size_t index, std::size_t, int which) {
    const TileBins::Tile bin = m_edgeBins.tile(index);
    Worker& worker = m_workers[which];
    EdgeTile tile;
    if (bin.count > 0) {
      tile = {worker.plane(0), worker.plane(1), worker.floats(2)};
      std::fill_n(tile.cover, Worker::kPlane, 0u);
      // The hidden edges first, so that where both cover a pixel the front one gives its name.
      if (drawsBehind) {
        const auto shown = hiddenAround(index);
        paint.drawEdges(m_frame, m_edges, bin.list, bin.count, EdgeLayer::Behind, shown.data(), bin.left,
                        bin.top, tile);
      }
      paint.drawEdges(m_frame, m_edges, bin.list, bin.count, EdgeLayer::Front, nullptr, bin.left, bin.top,
                      tile);
    }
    const std::uint32_t taken = paint.compose(m_frame, bin.left, bin.top, tile, worker.tileTaken.data());
    worker.taken.insert(worker.taken.end(), worker.tileTaken.begin(), worker.tileTaken.begin() + taken);
  });
  for (Worker& worker : m_workers) {
    for (const EdgePixel& p : worker.taken) {
      output.element.data()[p.pixel] = p.element;
      output.designDepth.data()[p.pixel] = p.depth;
      output.state.data()[p.pixel] = p.state;
    }
    worker.taken.clear();
  }
}

Result<OverlayDevice::Output> CpuOverlayDevice::draw(const DrawList& list) {
  const auto fits = [&](const auto* image) {
    return !image || (image->width() == list.width && image->height() == list.height);
  };
  if (!fits(list.scanDepth) || !fits(list.pointColour))
    return fail("The scan's pictures are not of the result's size", name(),
                "Draw them for the scaled camera");
  const int width = list.width, height = list.height;
  Output output{ColourImage(width, height, Uncleared{}), DepthImage(width, height, Uncleared{}), IdImage(width, height, Uncleared{}),
                Image<std::uint8_t>(width, height, Uncleared{}), IdImage()};
  if (drawsHiddenLayer(list)) output.hiddenElement = IdImage(width, height, Uncleared{});
  setUp(list, output);
  drawFaces(list);
  composeTiles(list, output);
  return output;
}

}  // namespace

std::unique_ptr<OverlayDevice> createCpuDevice() {
  return std::make_unique<CpuOverlayDevice>();
}

}  // namespace alidade

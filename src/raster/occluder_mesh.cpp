// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/occluder_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "raster/scanner_grid.h"

namespace alidade {

namespace {

constexpr int kTile = 64;           ///< cells along a block
constexpr int kLargestMerge = 16;   ///< cells along a quad
/// A plane explains a patch where its returns lie about it as noise does.
constexpr float kRmsSigmas = 1.5f, kMostSigmas = 5.0f;
constexpr std::size_t kTrianglesABlock = 256;  ///< of a design
constexpr float kFlatCell = 2.0f;  ///< sigmas out of plane below which one cell is one quad

using Corners = std::array<glm::vec3, 4>;

struct Patch {
  std::vector<Corners> quads;
  std::uint64_t merged = 0, cells = 0, squares = 0;
};

/// Quads of the cells [row, row + kTile) × [column, column + kTile) and of the returns at their low corners.
class PatchBuilder {
 public:
  PatchBuilder(const ScannerGrid& grid, Patch& patch) : m_grid(grid), m_patch(patch) {}

  void run(int row0, int column0) {
    for (int r = row0; r < std::min(row0 + kTile, m_grid.rows()); r += kLargestMerge) {
      for (int c = column0; c < std::min(column0 + kTile, m_grid.columns()); c += kLargestMerge)
        merge(r, c, kLargestMerge);
    }
    for (int c = column0; c < std::min(column0 + kTile, m_grid.columns()); ++c) {
      for (int r = row0; r < std::min(row0 + kTile, m_grid.rows()); ++r) {
        if (m_grid.has(r, c) && !m_grid.isEnclosed(r, c)) addSquare(r, c);
      }
    }
  }

 private:
  bool isCell(int row, int column) const {
    return row + 1 < m_grid.rows() && column < m_grid.cellColumns() && m_grid.isFull(row, column);
  }

  void merge(int row, int column, int size) {
    if (size == 1) {
      if (isCell(row, column)) addCell(row, column);
      return;
    }
    if (addPlane(row, column, size)) return;
    const int half = size / 2;
    for (const int dr : {0, half}) {
      for (const int dc : {0, half}) merge(row + dr, column + dc, half);
    }
  }

  bool addPlane(int row, int column, int size) {
    for (int c = column; c < column + size; ++c) {
      for (int r = row; r < row + size; ++r) {
        if (!isCell(r, c)) return false;
      }
    }
    // The picture plane of an eye at the scanner that looks at the patch: there a plane's inverse depth is
    // linear, exactly.
    const glm::vec3 ez = glm::normalize(m_grid.at(row + size / 2, column + size / 2));
    const glm::vec3 ex = glm::normalize(glm::cross(std::abs(ez.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0), ez));
    const glm::vec3 ey = glm::cross(ez, ex);
    m_u.clear(), m_v.clear(), m_w.clear();
    double u = 0, v = 0, w = 0, uu = 0, uv = 0, vv = 0, uw = 0, vw = 0;
    for (int c = column; c <= column + size; ++c) {
      for (int r = row; r <= row + size; ++r) {
        const glm::vec3& p = m_grid.at(r, c);
        const float iw = 1 / glm::dot(p, ez), iu = glm::dot(p, ex) * iw, iv = glm::dot(p, ey) * iw;
        m_u.push_back(iu), m_v.push_back(iv), m_w.push_back(iw);
        u += iu, v += iv, w += iw;
        uu += double{iu} * iu, uv += double{iu} * iv, vv += double{iv} * iv;
        uw += double{iu} * iw, vw += double{iv} * iw;
      }
    }
    const auto n = static_cast<double>(m_u.size());
    u /= n, v /= n, w /= n;
    uu -= n * u * u, uv -= n * u * v, vv -= n * v * v, uw -= n * u * w, vw -= n * v * w;
    const double det = uu * vv - uv * uv;
    if (!(det > 1e-12 * (uu + vv) * (uu + vv))) return false;
    const auto gu = static_cast<float>((uw * vv - vw * uv) / det), gv = static_cast<float>((vw * uu - uw * uv) / det);
    const auto w0 = static_cast<float>(w - gu * u - gv * v);
    double squares = 0;
    float most = 0;
    for (std::size_t i = 0; i < m_u.size(); ++i) {
      // Off by so much along the ray.
      const float off = std::abs(w0 + gu * m_u[i] + gv * m_v[i] - m_w[i]) / (m_w[i] * m_w[i]);
      most = std::max(most, off);
      squares += double{off} * off;
    }
    const float sigma = m_grid.noiseAt(static_cast<float>(1 / w));
    if (most > kMostSigmas * sigma || squares > n * kRmsSigmas * sigma * kRmsSigmas * sigma) return false;
    Corners corners;
    const std::size_t side = static_cast<std::size_t>(size) + 1;
    const std::array<std::size_t, 4> at{0, side - 1, side * side - 1, side * (side - 1)};
    for (int i = 0; i < 4; ++i) {
      const float cu = m_u[at[i]], cv = m_v[at[i]], cw = w0 + gu * cu + gv * cv;
      if (!(cw > 0)) return false;
      corners[i] = (cu * ex + cv * ey + ez) / cw;
    }
    m_patch.quads.push_back(corners);
    ++m_patch.merged;
    return true;
  }

  void addCell(int r, int c) {
    const glm::vec3 &p0 = m_grid.at(r, c), &p1 = m_grid.at(r + 1, c), &p2 = m_grid.at(r + 1, c + 1),
                    &p3 = m_grid.at(r, c + 1);
    // How far the diagonals miss each other.
    const glm::vec3 normal = glm::cross(p2 - p0, p3 - p1);
    const float length = glm::length(normal);
    const float off = length > 0 ? std::abs(glm::dot(p1 - p0, normal)) / length : 0.0f;
    if (off <= kFlatCell * m_grid.noiseAt(m_grid.rangeAt(r, c))) {
      m_patch.quads.push_back({p0, p1, p2, p3});
      m_patch.cells += 1;
      return;
    }
    // Folded along the diagonal whose ends differ less in range.
    const bool main = std::abs(m_grid.rangeAt(r, c) - m_grid.rangeAt(r + 1, c + 1)) <
                      std::abs(m_grid.rangeAt(r + 1, c) - m_grid.rangeAt(r, c + 1));
    if (main) {
      m_patch.quads.push_back({p0, p1, p2, p2});
      m_patch.quads.push_back({p0, p2, p3, p3});
    } else {
      m_patch.quads.push_back({p0, p1, p3, p3});
      m_patch.quads.push_back({p1, p2, p3, p3});
    }
    m_patch.cells += 2;
  }

  /// From one return to the next along its surface; across the ray where nothing is joined.
  glm::vec3 surfaceStep(bool before, bool after, const glm::vec3& previous, const glm::vec3& here,
                        const glm::vec3& next, const glm::vec3& angular) const {
    if (before && after) return 0.5f * (next - previous);
    if (after) return next - here;
    if (before) return here - previous;
    return angular * glm::length(here);
  }

  void addSquare(int r, int c) {
    const glm::vec3& p = m_grid.at(r, c);
    const bool up = m_grid.joinedDown(r - 1, c), down = m_grid.joinedDown(r, c);
    const bool left = m_grid.joinedAcross(r, c - 1), right = m_grid.joinedAcross(r, c);
    const glm::vec3 along = 0.5f * surfaceStep(up, down, up ? m_grid.at(r - 1, c) : p, p,
                                               down ? m_grid.at(r + 1, c) : p, m_grid.stepDown(r, c));
    const glm::vec3 across = 0.5f * surfaceStep(left, right, left ? m_grid.at(r, c - 1) : p, p,
                                                right ? m_grid.at(r, c + 1) : p, m_grid.stepAcross(r, c));
    m_patch.quads.push_back({p - along - across, p + along - across, p + along + across, p - along + across});
    ++m_patch.squares;
  }

  const ScannerGrid& m_grid;
  Patch& m_patch;
  std::vector<float> m_u, m_v, m_w;
};

void append(const Patch& patch, std::uint32_t station, OccluderMesh& mesh) {
  mesh.mergedQuads += patch.merged;
  mesh.cellQuads += patch.cells;
  mesh.borderSquares += patch.squares;
  if (patch.quads.empty()) return;
  constexpr int kQuads = OccluderPack::kQuads;
  OccluderBlock block;
  block.station = station;
  block.firstPack = static_cast<std::uint32_t>(mesh.packs.size());
  block.low = block.high = patch.quads[0][0];
  OccluderPack empty;
  std::fill_n(&empty.x[0][0], 4 * kQuads, std::numeric_limits<float>::quiet_NaN());
  std::copy_n(&empty.x[0][0], 4 * kQuads, &empty.y[0][0]);
  std::copy_n(&empty.x[0][0], 4 * kQuads, &empty.z[0][0]);
  for (std::size_t i = 0; i < patch.quads.size(); ++i) {
    const std::size_t lane = i % kQuads;
    if (lane == 0) mesh.packs.push_back(empty);
    OccluderPack& pack = mesh.packs.back();
    for (int k = 0; k < 4; ++k) {
      const glm::vec3& p = patch.quads[i][k];
      pack.x[k][lane] = p.x, pack.y[k][lane] = p.y, pack.z[k][lane] = p.z;
      block.low = glm::min(block.low, p), block.high = glm::max(block.high, p);
    }
  }
  block.packCount = static_cast<std::uint32_t>(mesh.packs.size()) - block.firstPack;
  mesh.blocks.push_back(block);
}

void addStation(const ScannerGrid& grid, std::uint32_t station, OccluderMesh& mesh) {
  const int tileRows = (grid.rows() + kTile - 1) / kTile, tileColumns = (grid.columns() + kTile - 1) / kTile;
  std::vector<Patch> patches(static_cast<std::size_t>(tileRows) * tileColumns);
  parallelFor(patches.size(), 1, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      PatchBuilder(grid, patches[i])
          .run(static_cast<int>(i % tileRows) * kTile, static_cast<int>(i / tileRows) * kTile);
    }
  });
  for (Patch& patch : patches) {
    append(patch, station, mesh);
    patch = {};
  }
}

}  // namespace

OccluderMesh occluderMeshOf(const DesignModel& design, const std::set<std::string>& hidden) {
  OccluderMesh mesh;
  mesh.origins.push_back(design.origin);
  for (const DesignElement& element : design.elements) {
    if (hidden.contains(element.globalId)) continue;
    Patch patch;
    for (std::uint32_t i = 0; i + 2 < element.indexCount; i += 3) {
      const std::uint32_t* corner = design.triangles.data() + element.firstIndex + i;
      const glm::vec3 &a = design.vertices[corner[0]], &b = design.vertices[corner[1]], &c = design.vertices[corner[2]];
      patch.quads.push_back({a, b, c, c});
      if (patch.quads.size() < kTrianglesABlock) continue;
      append(patch, 0, mesh);
      patch = {};
    }
    append(patch, 0, mesh);
  }
  return mesh;
}

struct OccluderMeshBuilder::Impl {
  std::vector<Station> stations;
  std::vector<std::vector<GridReturn>> returns;
  std::uint64_t withoutGrid = 0;
};

OccluderMeshBuilder::OccluderMeshBuilder(std::vector<Station> stations) : m_impl(std::make_unique<Impl>()) {
  m_impl->returns.resize(stations.size());
  m_impl->stations = std::move(stations);
}

OccluderMeshBuilder::~OccluderMeshBuilder() = default;

void OccluderMeshBuilder::add(const PointBatch& batch) {
  if (batch.row.empty() || batch.column.empty()) {
    m_impl->withoutGrid += batch.size();
    return;
  }
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const std::size_t scanner = batch.scanner.empty() ? 0 : batch.scanner[i];
    const bool isKnown = scanner < m_impl->stations.size();
    const glm::dvec3 fromStation =
        isKnown ? batch.position[i] - m_impl->stations[scanner].worldFromScanner.translation : glm::dvec3(0);
    if (!isKnown || !std::isfinite(glm::dot(fromStation, fromStation))) {
      ++m_impl->withoutGrid;
      continue;
    }
    m_impl->returns[scanner].push_back({batch.row[i], batch.column[i], glm::vec3(fromStation)});
  }
}

OccluderMesh OccluderMeshBuilder::build() {
  OccluderMesh mesh;
  mesh.withoutGrid = m_impl->withoutGrid;
  for (std::size_t s = 0; s < m_impl->stations.size(); ++s) {
    std::vector<GridReturn> returns = std::move(m_impl->returns[s]);
    mesh.origins.push_back(m_impl->stations[s].worldFromScanner.translation);
    const std::optional<ScannerGrid> grid = ScannerGrid::from(returns);
    (grid ? mesh.returns : mesh.withoutGrid) += returns.size();
    if (grid) addStation(*grid, static_cast<std::uint32_t>(s), mesh);
  }
  return mesh;
}

}  // namespace alidade

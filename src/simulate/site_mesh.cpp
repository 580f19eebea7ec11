// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/site_mesh.h"

#include <cmath>
#include <numbers>

namespace alidade {

std::uint32_t SiteMesh::beginObject(SiteObject object) {
  objects.push_back(std::move(object));
  return static_cast<std::uint32_t>(objects.size() - 1);
}

std::uint32_t SiteMesh::addVertex(const glm::dvec3& position, const glm::vec3& normal) {
  positions.push_back(position);
  normals.push_back(normal);
  return static_cast<std::uint32_t>(positions.size() - 1);
}

void SiteMesh::addFace(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  triangles.push_back({a, b, c});
  triangleObject.push_back(static_cast<std::uint32_t>(objects.size() - 1));
}

void SiteMesh::addTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 cross = glm::cross(b - a, c - a);
  const double length = glm::length(cross);
  if (!(length > 0)) return;
  const glm::vec3 normal(cross / length);
  const std::uint32_t first = addVertex(a, normal);
  addVertex(b, normal);
  addVertex(c, normal);
  addFace(first, first + 1, first + 2);
}

void SiteMesh::addQuad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  const glm::vec3 normal(glm::normalize(glm::cross(c - a, d - b)));
  const std::uint32_t first = addVertex(a, normal);
  addVertex(b, normal);
  addVertex(c, normal);
  addVertex(d, normal);
  addFace(first, first + 1, first + 2);
  addFace(first, first + 2, first + 3);
}

void SiteMesh::addBox(const glm::dvec3& low, const glm::dvec3& high, const glm::dmat3& axes,
                      const glm::dvec3& origin) {
  std::array<glm::dvec3, 8> c;
  for (int i = 0; i < 8; ++i)
    c[i] = origin + axes * glm::dvec3(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
  addQuad(c[0], c[2], c[3], c[1]);
  addQuad(c[4], c[5], c[7], c[6]);
  addQuad(c[0], c[1], c[5], c[4]);
  addQuad(c[2], c[6], c[7], c[3]);
  addQuad(c[0], c[4], c[6], c[2]);
  addQuad(c[1], c[3], c[7], c[5]);
}

void SiteMesh::addCylinder(const glm::dvec3& from, const glm::dvec3& to, double radius, int sides,
                           const glm::dvec3& firstCorner) {
  const glm::dvec3 axis = glm::normalize(to - from);
  const glm::dvec3 helper = std::abs(axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const bool chosen = glm::length(firstCorner) > 0.5;
  const glm::dvec3 u = chosen ? firstCorner : glm::normalize(glm::cross(helper, axis));
  const glm::dvec3 v = glm::cross(axis, u);
  const auto around = [&](int i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    return std::cos(angle) * u + std::sin(angle) * v;
  };
  const auto first = static_cast<std::uint32_t>(positions.size());
  for (int i = 0; i < sides; ++i) {
    addVertex(from + radius * around(i), glm::vec3(around(i)));
    addVertex(to + radius * around(i), glm::vec3(around(i)));
  }
  for (int i = 0; i < sides; ++i) {
    const std::uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % sides);
    addFace(a, b, b + 1);
    addFace(a, b + 1, a + 1);
  }
  for (int i = 1; i + 1 < sides; ++i) {
    addTriangle(from + radius * around(0), from + radius * around(i + 1), from + radius * around(i));
    addTriangle(to + radius * around(0), to + radius * around(i), to + radius * around(i + 1));
  }
}

void SiteMesh::addGrid(const std::vector<glm::dvec3>& grid, int rows, int columns) {
  const auto first = static_cast<std::uint32_t>(positions.size());
  std::vector<glm::dvec3> sums(grid.size(), glm::dvec3(0.0));
  const auto index = [&](int row, int column) { return static_cast<std::uint32_t>(row * columns + column); };
  const auto gather = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const glm::dvec3 cross = glm::cross(grid[b] - grid[a], grid[c] - grid[a]);
    for (const auto i : {a, b, c}) sums[i] += cross;
  };
  for (int row = 0; row + 1 < rows; ++row)
    for (int column = 0; column + 1 < columns; ++column) {
      gather(index(row, column), index(row, column + 1), index(row + 1, column + 1));
      gather(index(row, column), index(row + 1, column + 1), index(row + 1, column));
    }
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double length = glm::length(sums[i]);
    addVertex(grid[i], length > 0 ? glm::vec3(sums[i] / length) : glm::vec3(0, 0, 1));
  }
  for (int row = 0; row + 1 < rows; ++row)
    for (int column = 0; column + 1 < columns; ++column) {
      addFace(first + index(row, column), first + index(row, column + 1), first + index(row + 1, column + 1));
      addFace(first + index(row, column), first + index(row + 1, column + 1), first + index(row + 1, column));
    }
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/prism.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace alidade {

namespace {

std::vector<double> cuts(double low, double high, const std::vector<ProfileRectangle>& openings, int axis) {
  std::vector<double> values{low, high};
  for (const auto& opening : openings) {
    values.push_back(std::clamp(opening.low[axis], low, high));
    values.push_back(std::clamp(opening.high[axis], low, high));
  }
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

bool touchesBottom(const Prism& prism, const ProfileRectangle& o) { return o.low.y <= prism.outline.low.y; }
bool touchesTop(const Prism& prism, const ProfileRectangle& o) { return o.high.y >= prism.outline.high.y; }

/// The profile cut at every opening's lines into cells, each solid or empty.
class CellProfile {
 public:
  explicit CellProfile(const Prism& prism)
      : m_prism(prism),
        m_x(cuts(prism.outline.low.x, prism.outline.high.x, prism.openings, 0)),
        m_y(cuts(prism.outline.low.y, prism.outline.high.y, prism.openings, 1)) {}

  int columns() const { return static_cast<int>(m_x.size()) - 1; }
  int rows() const { return static_cast<int>(m_y.size()) - 1; }

  bool solid(int column, int row) const {
    if (column < 0 || row < 0 || column >= columns() || row >= rows()) return false;
    const glm::dvec2 centre(0.5 * (m_x[column] + m_x[column + 1]), 0.5 * (m_y[row] + m_y[row + 1]));
    return std::none_of(m_prism.openings.begin(), m_prism.openings.end(), [&](const ProfileRectangle& o) {
      return glm::all(glm::lessThan(o.low, centre)) && glm::all(glm::lessThan(centre, o.high));
    });
  }

  glm::dvec3 corner(int i, int j, double z) const { return m_prism.at({m_x[i], m_y[j], z}); }

 private:
  const Prism& m_prism;
  std::vector<double> m_x, m_y;
};

void addCellPrism(const Prism& prism, SiteMesh& mesh) {
  const CellProfile cells(prism);
  const double d = prism.depth;
  for (int row = 0; row < cells.rows(); ++row)
    for (int column = 0; column < cells.columns(); ++column) {
      if (!cells.solid(column, row)) continue;
      const auto p = [&](int i, int j, double z) { return cells.corner(column + i, row + j, z); };
      mesh.addQuad(p(0, 0, d), p(1, 0, d), p(1, 1, d), p(0, 1, d));
      mesh.addQuad(p(0, 0, 0), p(0, 1, 0), p(1, 1, 0), p(1, 0, 0));
      if (!cells.solid(column - 1, row)) mesh.addQuad(p(0, 1, 0), p(0, 0, 0), p(0, 0, d), p(0, 1, d));
      if (!cells.solid(column + 1, row)) mesh.addQuad(p(1, 0, 0), p(1, 1, 0), p(1, 1, d), p(1, 0, d));
      if (!cells.solid(column, row - 1)) mesh.addQuad(p(0, 0, 0), p(1, 0, 0), p(1, 0, d), p(0, 0, d));
      if (!cells.solid(column, row + 1)) mesh.addQuad(p(1, 1, 0), p(0, 1, 0), p(0, 1, d), p(1, 1, d));
    }
}

}  // namespace

std::vector<glm::dvec2> Prism::contour() const {
  std::vector<glm::dvec2> points;
  if (circleRadius > 0) {
    for (int i = 0; i < circleSides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / circleSides;
      points.emplace_back(circleRadius * std::cos(angle), circleRadius * std::sin(angle));
    }
    return points;
  }
  std::vector<ProfileRectangle> bottom, top;
  for (const auto& o : openings) {
    if (touchesBottom(*this, o)) bottom.push_back(o);
    else if (touchesTop(*this, o)) top.push_back(o);
  }
  std::sort(bottom.begin(), bottom.end(), [](const auto& a, const auto& b) { return a.low.x < b.low.x; });
  std::sort(top.begin(), top.end(), [](const auto& a, const auto& b) { return a.low.x > b.low.x; });
  points.push_back(outline.low);
  for (const auto& o : bottom)
    for (const auto& p : {glm::dvec2(o.low.x, outline.low.y), glm::dvec2(o.low.x, o.high.y), o.high,
                          glm::dvec2(o.high.x, outline.low.y)})
      points.push_back(p);
  points.emplace_back(outline.high.x, outline.low.y);
  points.push_back(outline.high);
  for (const auto& o : top)
    for (const auto& p : {glm::dvec2(o.high.x, outline.high.y), glm::dvec2(o.high.x, o.low.y), o.low,
                          glm::dvec2(o.low.x, outline.high.y)})
      points.push_back(p);
  points.emplace_back(outline.low.x, outline.high.y);
  return points;
}

std::vector<std::vector<glm::dvec2>> Prism::holes() const {
  std::vector<std::vector<glm::dvec2>> loops;
  for (const auto& o : openings)
    if (!touchesBottom(*this, o) && !touchesTop(*this, o))
      loops.push_back({o.low, {o.low.x, o.high.y}, o.high, {o.high.x, o.low.y}});
  return loops;
}

void Prism::addTo(SiteMesh& mesh) const {
  if (circleRadius > 0) {
    mesh.addCylinder(at({0, 0, 0}), at({0, 0, depth}), circleRadius, circleSides, axes[0]);
    return;
  }
  addCellPrism(*this, mesh);
}

}  // namespace alidade

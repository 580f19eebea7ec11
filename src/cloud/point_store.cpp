// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/point_store.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "cloud/node_spacing.h"

namespace alidade {

namespace {

/// In [0,1), from the node alone: which nodes round up first, so that many small prefixes do not jump together.
double ditherOf(std::uint32_t node) {
  return static_cast<double>((node + 1) * 0x9e3779b9u) * 0x1p-32;
}

}  // namespace

double AttributeColumn::at(std::uint64_t point, int component) const {
  const std::size_t each = numberSize(type);
  return numberAt(data.data() + (point * static_cast<std::uint64_t>(components) + static_cast<std::uint64_t>(component)) * each, type);
}

PointStore::PointStore(PointStoreData data) : m_data(std::move(data)) {
  if (!m_data.nodes.empty()) m_bounds = m_data.nodes[0].bounds;
  for (std::size_t c = 0; c < m_data.schema.columns.size(); ++c) {
    const ColumnShape& shape = m_data.schema.columns[c];
    m_attributes.push_back({shape.name, shape.type, shape.components, m_data.columns[c], shape.extra});
  }
  std::int32_t low = std::numeric_limits<std::int32_t>::max(), high = std::numeric_limits<std::int32_t>::min();
  std::vector<std::pair<double, std::uint64_t>> spacings;
  std::uint64_t measured = 0;
  for (std::uint32_t n = 0; n < m_data.nodes.size(); ++n) {
    const CloudNode& node = m_data.nodes[n];
    if (node.count == 0) continue;
    m_byFirst.push_back(n);
    low = std::min(low, m_data.places[n].firstStep);
    high = std::max(high, m_data.places[n].firstStep + static_cast<std::int32_t>(m_data.places[n].stepCount));
    if (node.spacing > 0) spacings.push_back({node.spacing, node.count}), measured += node.count;
  }
  std::sort(m_byFirst.begin(), m_byFirst.end(),
            [&](std::uint32_t a, std::uint32_t b) { return m_data.nodes[a].first < m_data.nodes[b].first; });
  std::sort(spacings.begin(), spacings.end());
  std::uint64_t below = 0;
  for (const auto& [spacing, count] : spacings) {
    below += count;
    if (2 * below < measured) continue;
    m_medianSpacing = spacing;
    break;
  }
  // A lone point tells no spacing: its surroundings' is the best guess.
  for (CloudNode& node : m_data.nodes)
    if (node.spacing <= 0) node.spacing = m_medianSpacing;
  m_below.assign(m_data.nodes.size(), {std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()});
  for (std::size_t n = m_data.nodes.size(); n-- > 0;) {
    const CloudNode& node = m_data.nodes[n];
    const PointStoreData::NodePlace& place = m_data.places[n];
    if (node.count > 0) m_below[n] = {place.firstStep, place.firstStep + static_cast<std::int32_t>(place.stepCount)};
    for (std::uint32_t c = 0; c < node.childCount; ++c) {
      const StepRange& child = m_below[static_cast<std::size_t>(node.firstChild) + c];
      m_below[n] = {std::min(m_below[n].low, child.low), std::max(m_below[n].high, child.high)};
    }
  }
  if (m_byFirst.empty()) return;
  m_lowestStep = low;
  m_cumulative.assign(static_cast<std::size_t>(high - low), 0);
  for (const std::uint32_t n : m_byFirst) {
    std::uint32_t before = 0;
    std::size_t at = static_cast<std::size_t>(m_data.places[n].firstStep - low);
    for (const std::uint32_t up : levelsOf(n).cumulative) m_cumulative[at++] += up - before, before = up;
  }
  for (std::size_t i = 1; i < m_cumulative.size(); ++i) m_cumulative[i] += m_cumulative[i - 1];
}

double PointStore::spacingOfLevel(double level) const {
  return kPoissonSide * m_data.lattice.step * std::exp2(kFinestPass - level);
}

double PointStore::levelOfSpacing(double meters) const {
  return kFinestPass - std::log2(meters / (kPoissonSide * m_data.lattice.step));
}

NodeLevels PointStore::levelsOf(std::uint32_t node) const {
  const PointStoreData::NodePlace& place = m_data.places[node];
  return {place.firstStep, m_data.tables.subspan(place.tableOffset, place.stepCount)};
}

std::uint32_t PointStore::countBelow(std::uint32_t node, double level) const {
  const NodeLevels levels = levelsOf(node);
  const double at = level * kLevelSteps - levels.firstStep;
  if (!(at > 0)) return 0;
  if (at >= static_cast<double>(levels.cumulative.size())) return m_data.nodes[node].count;
  const auto step = static_cast<std::size_t>(at);
  const std::uint32_t before = step > 0 ? levels.cumulative[step - 1] : 0, in = levels.cumulative[step] - before;
  const double part = (at - static_cast<double>(step)) * in + ditherOf(node);
  return before + std::min(in, static_cast<std::uint32_t>(part));
}

double PointStore::highestLevel() const {
  return (m_lowestStep + static_cast<double>(m_cumulative.size())) / kLevelSteps;
}

double PointStore::levelOfShare(double share) const {
  if (m_cumulative.empty() || !(share > 0)) return lowestLevel();
  const double wanted = std::min(share, 1.0) * static_cast<double>(m_cumulative.back());
  const auto found = std::lower_bound(m_cumulative.begin(), m_cumulative.end(), wanted,
                                      [](std::uint64_t count, double limit) { return static_cast<double>(count) < limit; });
  if (found == m_cumulative.end()) return highestLevel();
  const double before = found == m_cumulative.begin() ? 0.0 : static_cast<double>(*std::prev(found));
  const double in = static_cast<double>(*found) - before;
  const double part = in > 0 ? (wanted - before) / in : 1.0;
  return (m_lowestStep + static_cast<double>(found - m_cumulative.begin()) + part) / kLevelSteps;
}

std::uint32_t PointStore::nodeOf(std::uint64_t point) const {
  const auto after = std::upper_bound(m_byFirst.begin(), m_byFirst.end(), point,
                                      [&](std::uint64_t p, std::uint32_t n) { return p < m_data.nodes[n].first; });
  return *std::prev(after);
}

glm::dvec3 PointStore::sourcePosition(std::uint64_t point) const {
  if (const std::size_t bytes = m_data.lattice.exactBytes(); bytes > 0)
    return m_data.lattice.unpackExact(m_data.exact.data() + point * bytes);
  const DisplayPoint& p = m_data.points[point];
  return m_data.lattice.positionOf(m_data.places[nodeOf(point)].corner + glm::i64vec3(p.x, p.y, p.z));
}

const AttributeColumn* PointStore::attribute(std::string_view name) const {
  const auto found = std::find_if(m_attributes.begin(), m_attributes.end(),
                                  [&](const AttributeColumn& c) { return !c.extra && c.name == name; });
  return found == m_attributes.end() ? nullptr : &*found;
}

std::optional<glm::u8vec3> PointStore::sourceColour(std::uint64_t point) const {
  const AttributeColumn* rgb = attribute("rgb");
  if (rgb == nullptr) return std::nullopt;
  std::uint16_t c[3];
  std::memcpy(c, rgb->data.data() + point * sizeof c, sizeof c);
  const int shift = rgbWhite() > 255 ? 8 : 0;
  return glm::u8vec3(c[0] >> shift, c[1] >> shift, c[2] >> shift);
}

PointBatch PointStore::batch(std::uint64_t first, std::uint64_t count) const {
  PointBatch batch;
  first = std::min(first, pointCount());
  count = std::min(count, pointCount() - first);
  batch.position.resize(count);
  const std::size_t bytes = m_data.lattice.exactBytes();
  for (std::uint64_t i = 0; i < count;) {
    if (bytes > 0) {
      batch.position[i] = m_data.lattice.unpackExact(m_data.exact.data() + (first + i) * bytes);
      ++i;
      continue;
    }
    const std::uint32_t n = nodeOf(first + i);
    const std::uint64_t end = std::min(first + count, m_data.nodes[n].first + m_data.nodes[n].count);
    for (; first + i < end; ++i) {
      const DisplayPoint& p = m_data.points[first + i];
      batch.position[i] = m_data.lattice.positionOf(m_data.places[n].corner + glm::i64vec3(p.x, p.y, p.z));
    }
  }
  for (std::size_t c = 0; c < m_data.columns.size(); ++c)
    m_data.schema.unpack(c, m_data.columns[c].data() + first * m_data.schema.columns[c].bytes(), count, batch);
  return batch;
}

}  // namespace alidade

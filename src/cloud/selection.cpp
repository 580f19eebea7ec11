// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/selection.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/widest.h"
#include "cloud/key_sort.h"
#include "cloud/view_pyramid.h"

namespace alidade {

namespace {

struct Candidate {
  std::uint32_t store = 0, node = 0;
  float squaredDistance = 0;  ///< from the eye to the nearest point of the bounds, square metres
  std::int32_t step = 0;      ///< where it is cut at density 1, level steps
};

/// Above every level there is.
constexpr std::int32_t kEveryStep = 1 << 14;

std::int32_t stepOf(double level) {
  const double step = std::floor(level * kLevelSteps);
  return step >= kEveryStep ? kEveryStep : step <= -kEveryStep ? -kEveryStep : static_cast<std::int32_t>(step);
}

/// Where nodes of one store are cut at density 1.
class Cuts {
 public:
  Cuts(const PointStore& store, const Camera& camera, const SelectionOptions& options)
      : m_store(store), m_options(options), m_focal(std::sqrt(std::abs(camera.intrinsics().fx * camera.intrinsics().fy))),
        m_byDistance(store.levelKind() == LevelKind::BlueNoise && options.law == DensityLaw::PointsPerPixel &&
                     options.targetSpacingPx > 0),
        m_levelAtOneMetre(m_byDistance ? store.levelOfSpacing(options.targetSpacingPx / m_focal) : 0) {}

  /// How much of its area the node shows to the eye where that counts, else 1.
  double facingOf(const CloudNode& node, const glm::dvec3& eye, double squaredDistance) const {
    if (!m_options.byFacing || m_options.law != DensityLaw::PointsPerPixel || m_options.threshold != LevelThreshold::ByDistance) return 1.0;
    return alidade::facingOf(node.slab, eye - node.origin, std::sqrt(squaredDistance));
  }

  /// The level step at which a node is cut.
  std::int32_t stepOf(const CloudNode& node, double squaredDistance, double facing) const {
    if (m_byDistance) {
      // The usual law, without its roots: the level falls by one where the distance doubles.
      if (!(squaredDistance > 0)) return kEveryStep;
      return alidade::stepOf(m_levelAtOneMetre - 0.5 * std::log2(squaredDistance / facing));
    }
    const double wanted = spacingAt(std::sqrt(squaredDistance)) / std::sqrt(facing);
    if (!(wanted > 0)) return kEveryStep;
    if (m_store.levelKind() == LevelKind::BlueNoise) return alidade::stepOf(m_store.levelOfSpacing(wanted));
    // Coinciding points tell no spacing; they are drawn rather than lost.
    const double share = node.spacing / wanted * (node.spacing / wanted);
    if (!(node.spacing > 0) || !(share < 1.0)) return kEveryStep;
    return alidade::stepOf(m_store.levelLaw().levelOfShare(share) - m_store.lawShift());
  }

  /// The inverse: metres up to which a level of the node is drawn.
  double reachOf(const CloudNode& node, double level) const {
    const double spacing = m_store.levelKind() == LevelKind::BlueNoise
                               ? m_store.spacingOfLevel(level)
                               : node.spacing / std::sqrt(m_store.levelLaw().shareBelow(level + m_store.lawShift()));
    if (m_options.law == DensityLaw::PointsPerPixel) return spacing * m_focal / m_options.targetSpacingPx;
    return std::expm1(spacing * spacing * m_options.pointsPerSquareMetre);
  }

 private:
  /// Wanted metres between neighbours.
  double spacingAt(double distance) const {
    if (m_options.law == DensityLaw::PointsPerPixel) return m_options.targetSpacingPx * distance / m_focal;
    return std::sqrt(std::log1p(distance) / m_options.pointsPerSquareMetre);
  }

  const PointStore& m_store;
  const SelectionOptions& m_options;
  double m_focal;
  bool m_byDistance;
  double m_levelAtOneMetre;
};

void addVisible(const PointStore& store, std::uint32_t storeIndex, const ViewPyramid& view, const Cuts* cuts,
                std::vector<Candidate>& found) {
  const auto nodes = store.nodes();
  if (nodes.empty()) return;
  struct Visit {
    std::uint32_t node;
    unsigned planes;  ///< that may still cut it
  };
  std::vector<Visit> stack{{0, ViewPyramid::kAllPlanes}};
  while (!stack.empty()) {
    Visit visit = stack.back();
    stack.pop_back();
    const std::uint32_t index = visit.node;
    const CloudNode& node = nodes[index];
    if (visit.planes != 0) visit.planes = view.cutBy(node.bounds, visit.planes);
    if (visit.planes == ViewPyramid::kOutside) continue;
    const double squaredDistance = view.squaredDistanceTo(node.bounds);
    // What lies below is no nearer and of no lower level, but may face the eye more.
    const std::int32_t facingStep = cuts == nullptr ? kEveryStep : cuts->stepOf(node, squaredDistance, 1.0);
    if (store.levelKind() == LevelKind::BlueNoise && facingStep <= store.lowestStepBelow(index)) continue;
    // No deeper than there are points here: all of it is thinned from the first step of the slider on.
    const std::int32_t deepest = store.highestStepBelow(index);
    if (node.count > 0) {
      const std::int32_t step = cuts == nullptr ? kEveryStep : cuts->stepOf(node, squaredDistance, cuts->facingOf(node, view.eye(), squaredDistance));
      found.push_back({storeIndex, index, static_cast<float>(squaredDistance), std::min(step, deepest)});
    }
    for (std::uint32_t c = 0; c < node.childCount; ++c) stack.push_back({static_cast<std::uint32_t>(node.firstChild) + c, visit.planes});
  }
}

/// Distances are not negative: their bits order as they do. Those of equal distance stay in the order of their tree.
void sortFrontToBack(std::vector<Candidate>& candidates) {
  RawVector<std::uint64_t> keys(candidates.size());
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = std::uint64_t{std::bit_cast<std::uint32_t>(candidates[i].squaredDistance)} << 32 | i;
  sortKeys(keys);
  std::vector<Candidate> sorted;
  sorted.reserve(candidates.size());
  for (const std::uint64_t key : keys) sorted.push_back(candidates[key & 0xffffffff]);
  candidates.swap(sorted);
}

using Stores = std::span<const PointStore* const>;

/// Adds a table's own counts, step by step, to a histogram.
ALIDADE_WIDEST void addTo(std::uint64_t* histogram, const std::uint32_t* cumulative, std::size_t steps) {
  histogram[0] += cumulative[0];
  for (std::size_t i = 1; i < steps; ++i) histogram[i] += cumulative[i] - cumulative[i - 1];
}

/// How many points are drawn where all levels are lowered by delta steps: a histogram of the candidates'
/// points by how far below their cut they lie, so that the count can be solved for delta.
class CountByDelta {
 public:
  CountByDelta(Stores stores, const std::vector<Candidate>& candidates) {
    for (const Candidate& c : candidates) {
      const NodeLevels levels = stores[c.store]->levelsOf(c.node);
      const std::int32_t end = levels.firstStep + static_cast<std::int32_t>(levels.cumulative.size());
      const std::int32_t above = std::max(0, c.step - end);
      const std::int32_t drawn = std::min(c.step, end) - levels.firstStep;
      if (drawn <= 0) continue;
      const auto reach = static_cast<std::size_t>(above + drawn);
      if (m_below.size() < reach) m_below.insert(m_below.begin(), reach - m_below.size(), 0);
      addTo(m_below.data() + (m_below.size() - reach), levels.cumulative.data(), static_cast<std::size_t>(drawn));
      m_total += levels.cumulative[static_cast<std::size_t>(drawn) - 1];
    }
  }

  std::uint64_t total() const { return m_total; }

  /// The smallest delta, in steps, at which at most `count` are drawn.
  double deltaFor(double count) const {
    double left = static_cast<double>(m_total) - count;
    for (std::size_t k = 0; k < m_below.size() && left > 0; ++k) {
      const auto in = static_cast<double>(m_below[m_below.size() - 1 - k]);
      if (in >= left) return static_cast<double>(k) + left / in;
      left -= in;
    }
    return left > 0 ? static_cast<double>(m_below.size()) : 0.0;
  }

 private:
  std::vector<std::uint64_t> m_below;  ///< the last entry: points in the step just below their cut
  std::uint64_t m_total = 0;
};

std::vector<Selection> cut(Stores stores, const std::vector<Candidate>& candidates, double deltaSteps) {
  std::vector<Selection> selections(stores.size());
  for (const Candidate& c : candidates) {
    const PointStore& store = *stores[c.store];
    const CloudNode& node = store.nodes()[c.node];
    const double level = (c.step - deltaSteps) / kLevelSteps;
    const std::uint32_t count = store.countBelow(c.node, level);
    if (count == 0) continue;
    double spacing = node.spacing;
    if (store.levelKind() == LevelKind::BlueNoise) {
      spacing = std::max(spacing, store.spacingOfLevel(level));
    } else {
      const double share = store.levelLaw().shareBelow(level + store.lawShift());
      spacing /= std::sqrt(std::max(share, 1e-9));
    }
    selections[c.store].ranges.push_back({c.node, node.first, count, spacing});
    selections[c.store].pointCount += count;
  }
  return selections;
}

double farthestOf(const Bounds& bounds, const glm::dvec3& eye) {
  return glm::length(glm::max(glm::abs(bounds.min - eye), glm::abs(bounds.max - eye)));
}

/// Those of the range's points that their own distances want; false where that is all of them.
bool copyWanted(const PointStore& store, const Cuts& cuts, const glm::dvec3& eye, double deltaSteps, const SelectedRange& range,
                std::vector<DisplayPoint>& copy) {
  const CloudNode& node = store.nodes()[range.node];
  const NodeLevels levels = store.levelsOf(range.node);
  const auto reachOfStep = [&](std::size_t i) {
    // A step's points lie about its middle.
    return cuts.reachOf(node, (levels.firstStep + static_cast<double>(i) + 0.5 + deltaSteps) / kLevelSteps);
  };
  const auto placeOf = [&](std::uint32_t p) { return range.places != nullptr ? range.places[p] : p; };
  const auto last = static_cast<std::size_t>(std::ranges::lower_bound(levels.cumulative, placeOf(range.count - 1) + 1) - levels.cumulative.begin());
  if (!(reachOfStep(last) < farthestOf(node.bounds, eye))) return false;
  const glm::vec3 nodeFromEye(node.origin - eye);
  const auto unit = static_cast<float>(node.step);
  const DisplayPoint* points = range.styled != nullptr ? range.styled : store.points().data() + range.first;
  std::uint32_t p = 0;
  for (std::size_t i = 0; i <= last; ++i) {
    const double reach = reachOfStep(i);
    const float squared = static_cast<float>(reach * reach);
    for (; p < range.count && placeOf(p) < levels.cumulative[i]; ++p) {
      const glm::vec3 at = nodeFromEye + unit * glm::vec3(points[p].x, points[p].y, points[p].z);
      if (!(glm::dot(at, at) > squared)) copy.push_back(points[p]);
    }
  }
  return true;
}

/// Prefixes of nodes, and the delta that they were cut with.
std::vector<Selection> selectPrefixes(Stores stores, const Camera& camera, const RigidTransform& cameraFromWorld,
                                  const SelectionOptions& options, const std::vector<Cuts>& cuts, double& delta) {
  const double density = std::clamp(options.density, 0.0, 1.0);
  if (!(density > 0.0) || camera.width() <= 0 || !cameraFromWorld.isFinite()) return std::vector<Selection>(stores.size());
  const ViewPyramid view(camera, cameraFromWorld);
  std::vector<Candidate> candidates;
  for (std::uint32_t s = 0; s < stores.size(); ++s) addVisible(*stores[s], s, view, &cuts[s], candidates);
  sortFrontToBack(candidates);
  if (options.threshold == LevelThreshold::Uniform) {
    std::int32_t most = -kEveryStep;
    for (const Candidate& c : candidates) most = std::max(most, c.step);
    for (Candidate& c : candidates) c.step = most;
  }
  delta = 0;
  if (density < 1.0 || options.pointBudget > 0) {
    const CountByDelta counts(stores, candidates);
    double count = density * static_cast<double>(counts.total());
    if (options.pointBudget > 0) count = std::min(count, static_cast<double>(options.pointBudget));
    delta = counts.deltaFor(count);
    // Prefixes are whole points: their roundings may add up to a few more than the budget.
    for (double room = count; options.pointBudget > 0 && room > 0;) {
      auto selections = cut(stores, candidates, delta);
      std::uint64_t drawn = 0;
      for (const Selection& selection : selections) drawn += selection.pointCount;
      if (drawn <= options.pointBudget) return selections;
      room -= static_cast<double>(drawn - options.pointBudget) + 1.0;
      delta = counts.deltaFor(room);
    }
  }
  return cut(stores, candidates, delta);
}

std::vector<Selection> selectFrom(Stores stores, const Camera& camera, const RigidTransform& cameraFromWorld,
                                  const SelectionOptions& options) {
  std::vector<Cuts> cuts;
  for (const PointStore* store : stores) cuts.emplace_back(*store, camera, options);
  double delta = 0;
  std::vector<Selection> selections = selectPrefixes(stores, camera, cameraFromWorld, options, cuts, delta);
  for (std::size_t s = 0; s < stores.size(); ++s) {
    selections[s].loweredSteps = delta;
    if (options.threshold == LevelThreshold::ByPoint) cutByPoint(*stores[s], camera, cameraFromWorld, options, selections[s]);
  }
  return selections;
}

}  // namespace

std::vector<Selection> select(std::span<const std::shared_ptr<const PointStore>> stores, const Camera& camera,
                              const RigidTransform& cameraFromWorld, const SelectionOptions& options) {
  std::vector<const PointStore*> plain;
  for (const auto& store : stores) plain.push_back(store.get());
  return selectFrom(plain, camera, cameraFromWorld, options);
}

Selection select(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld,
                 const SelectionOptions& options) {
  const PointStore* const one = &store;
  return selectFrom({&one, 1}, camera, cameraFromWorld, options)[0];
}

void cutByPoint(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld,
                const SelectionOptions& options, Selection& selection) {
  const Cuts cuts(store, camera, options);
  const glm::dvec3 eye = cameraFromWorld.centre();
  std::erase_if(selection.ranges, [](const SelectedRange& range) { return range.count == 0; });
  auto copies = std::make_shared<std::vector<std::vector<DisplayPoint>>>(selection.ranges.size());
  parallelFor(selection.ranges.size(), 1, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      SelectedRange& range = selection.ranges[i];
      std::vector<DisplayPoint>& copy = (*copies)[i];
      if (!copyWanted(store, cuts, eye, selection.loweredSteps, range, copy)) continue;
      range.count = static_cast<std::uint32_t>(copy.size());
      range.styled = copy.data();
      range.places = nullptr;
    }
  });
  std::erase_if(selection.ranges, [](const SelectedRange& range) { return range.count == 0; });
  selection.pointCount = 0;
  for (const SelectedRange& range : selection.ranges) selection.pointCount += range.count;
  selection.owner = std::move(copies);
}

Selection selectAll(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld) {
  if (camera.width() <= 0 || !cameraFromWorld.isFinite()) return {};
  const PointStore* const one = &store;
  std::vector<Candidate> candidates;
  addVisible(store, 0, ViewPyramid(camera, cameraFromWorld), nullptr, candidates);
  sortFrontToBack(candidates);
  return cut({&one, 1}, candidates, 0.0)[0];
}

}  // namespace alidade

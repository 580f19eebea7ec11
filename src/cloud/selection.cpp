// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/selection.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "cloud/view_pyramid.h"

namespace alidade {

namespace {

struct Candidate {
  std::uint32_t store = 0, node = 0;
  float distance = 0;     ///< from the eye to the nearest point of the bounds, metres
  std::int32_t step = 0;  ///< where it is cut at density 1, level steps
};

/// Above every level there is.
constexpr std::int32_t kEveryStep = 1 << 14;

std::int32_t stepOf(double level) {
  const double step = std::floor(level * kLevelSteps);
  return step >= kEveryStep ? kEveryStep : step <= -kEveryStep ? -kEveryStep : static_cast<std::int32_t>(step);
}

/// Wanted metres between neighbours at a distance.
class Wanted {
 public:
  Wanted(const Camera& camera, const SelectionOptions& options)
      : m_options(options), m_focal(std::sqrt(std::abs(camera.intrinsics().fx * camera.intrinsics().fy))) {}

  double spacingAt(double distance) const {
    if (m_options.law == DensityLaw::PointsPerPixel) return m_options.targetSpacingPx * distance / m_focal;
    return std::sqrt(std::log1p(distance) / m_options.pointsPerSquareMetre);
  }

 private:
  const SelectionOptions& m_options;
  double m_focal;
};

/// The level step at which a node is cut for a wanted spacing.
std::int32_t wantedStep(const PointStore& store, double nodeSpacing, double wanted) {
  if (!(wanted > 0)) return kEveryStep;
  if (store.levelKind() == LevelKind::BlueNoise) return stepOf(store.levelOfSpacing(wanted));
  // Coinciding points tell no spacing; they are drawn rather than lost.
  const double share = nodeSpacing / wanted * (nodeSpacing / wanted);
  if (!(nodeSpacing > 0) || !(share < 1.0)) return kEveryStep;
  return stepOf(store.levelLaw().levelOfShare(share) - store.lawShift());
}

void addVisible(const PointStore& store, std::uint32_t storeIndex, const ViewPyramid& view, const Wanted* wanted,
                std::vector<Candidate>& found) {
  const auto nodes = store.nodes();
  if (nodes.empty()) return;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t index = stack.back();
    stack.pop_back();
    const CloudNode& node = nodes[index];
    if (!view.maySee(node.bounds)) continue;
    const double distance = view.distanceTo(node.bounds);
    const std::int32_t step = wanted == nullptr ? kEveryStep : wantedStep(store, node.spacing, wanted->spacingAt(distance));
    // What lies below is no nearer and of no lower level.
    if (store.levelKind() == LevelKind::BlueNoise && step <= store.lowestStepBelow(index)) continue;
    // No deeper than there are points here: all of it is thinned from the first step of the slider on.
    const std::int32_t deepest = store.highestStepBelow(index);
    if (node.count > 0) found.push_back({storeIndex, index, static_cast<float>(distance), std::min(step, deepest)});
    for (std::uint32_t c = 0; c < node.childCount; ++c) stack.push_back(static_cast<std::uint32_t>(node.firstChild) + c);
  }
}

void sortFrontToBack(std::vector<Candidate>& candidates) {
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    if (a.distance != b.distance) return a.distance < b.distance;
    return a.store != b.store ? a.store < b.store : a.node < b.node;
  });
}

using Stores = std::span<const PointStore* const>;

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
      std::uint64_t* out = m_below.data() + (m_below.size() - reach);
      std::uint32_t before = 0;
      for (std::int32_t i = 0; i < drawn; ++i) {
        const std::uint32_t up = levels.cumulative[static_cast<std::size_t>(i)];
        out[i] += up - before;
        before = up;
      }
      m_total += before;
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
    selections[c.store].ranges.push_back({c.node, node.first, count, spacing, nullptr});
    selections[c.store].pointCount += count;
  }
  return selections;
}

std::vector<Selection> selectFrom(Stores stores, const Camera& camera, const RigidTransform& cameraFromWorld,
                                  const SelectionOptions& options) {
  const double density = std::clamp(options.density, 0.0, 1.0);
  if (!(density > 0.0) || camera.width() <= 0 || !cameraFromWorld.isFinite()) return std::vector<Selection>(stores.size());
  const ViewPyramid view(camera, cameraFromWorld);
  const Wanted wanted(camera, options);
  std::vector<Candidate> candidates;
  for (std::uint32_t s = 0; s < stores.size(); ++s) addVisible(*stores[s], s, view, &wanted, candidates);
  sortFrontToBack(candidates);
  if (options.threshold == LevelThreshold::Uniform) {
    std::int32_t most = -kEveryStep;
    for (const Candidate& c : candidates) most = std::max(most, c.step);
    for (Candidate& c : candidates) c.step = most;
  }
  double delta = 0;
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

Selection selectAll(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld) {
  if (camera.width() <= 0 || !cameraFromWorld.isFinite()) return {};
  const PointStore* const one = &store;
  std::vector<Candidate> candidates;
  addVisible(store, 0, ViewPyramid(camera, cameraFromWorld), nullptr, candidates);
  sortFrontToBack(candidates);
  return cut({&one, 1}, candidates, 0.0)[0];
}

}  // namespace alidade

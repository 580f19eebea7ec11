// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/network.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "adjust/network_checks.h"
#include "adjust/network_description.h"
#include "adjust/resection_checks.h"
#include "adjust/robust.h"

namespace alidade {

namespace {

constexpr double largestScale = 20;

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// One adjustment: which terms take part, and the state they lead to.
class Adjustment {
 public:
  Adjustment(const Network& network, const NetworkOptions& options, const Progress& progress)
      : m_options(options), m_progress(progress), m_layout(network), m_terms(network, m_layout), m_normals(m_terms) {}

  Result<NetworkSummary> run();

 private:
  bool usable(const Term& term) const {
    return !term.heldOut && (term.point < 0 || std::isfinite(m_state.points[term.point].x));
  }
  std::optional<std::string> leaveOutBehind();
  bool fit(double huber);
  void robustStart();
  bool settleOutliers();
  void dropLoosePoints();
  void warnOfTwins();
  NetworkSummary refused(std::string reason);

  const NetworkOptions& m_options;
  const Progress& m_progress;
  NetworkLayout m_layout;
  NetworkTerms m_terms;
  NormalSystem m_normals;
  NetworkState m_start, m_state;
  std::vector<char> m_usable, m_active;
  std::vector<std::string> m_warnings;
  NetworkFit m_last;
  int m_iterations = 0;
  double m_scale = 1;
  double m_initialCost = 0;
};

NetworkSummary Adjustment::refused(std::string reason) {
  NetworkSummary summary = startSummary(m_terms, m_start);
  summary.reason = std::move(reason);
  summary.warnings = m_warnings;
  summary.iterations = m_iterations;
  return summary;
}

/// Observations without a value at the start take no part; where they are the most of a frame, its pose is wrong.
std::optional<std::string> Adjustment::leaveOutBehind() {
  const std::vector<double> sigmas = termSigmas(m_terms, m_state);
  const Network& network = m_terms.network();
  std::vector<std::pair<int, int>> counts(network.frames.size(), {0, 0});
  std::string first;
  int behind = 0;
  for (std::size_t t = 0; t < sigmas.size(); ++t) {
    const Term& term = m_terms.terms()[t];
    m_usable.push_back(usable(term) && std::isfinite(sigmas[t]));
    if (!usable(term) || term.frame < 0) continue;
    ++counts[term.frame].second;
    if (std::isfinite(sigmas[t])) continue;
    ++counts[term.frame].first;
    if (behind++ == 0) first = residualName(m_terms, static_cast<int>(t));
  }
  for (std::size_t f = 0; f < counts.size(); ++f)
    if (2 * counts[f].first > counts[f].second)
      return fmt::format("{} of {} observations of frame \"{}\" lie behind the camera at the start pose; correct the start "
                         "pose or the points", counts[f].first, counts[f].second, network.frames[f].name);
  if (behind > 0)
    m_warnings.push_back(fmt::format("{} observations lie behind their camera and take no part (\"{}\" first); check them",
                                     behind, first));
  return std::nullopt;
}

void Adjustment::warnOfTwins() {
  const Network& network = m_terms.network();
  std::vector<KnownPick> picks;
  for (const PictureObservation& o : network.observations) {
    const NetworkPoint& point = network.points[o.point];
    if (!o.heldOut && point.kind != PointKind::Tie) picks.push_back({o.frame, o.pixel, *point.world, point.name});
  }
  if (auto twins = warningOfTwins(std::move(picks))) m_warnings.push_back(std::move(*twins));
}

bool Adjustment::fit(double huber) {
  m_normals.use(m_active);
  m_last = fitNetwork(m_terms, m_normals, m_active, m_state, huber, m_options.maximumIterations, m_progress);
  m_state = m_last.state;
  m_iterations += m_last.iterations;
  return m_last.converged;
}

/// Far from the solution every residual is an outlier: the loss narrows as the state improves.
void Adjustment::robustStart() {
  std::vector<double> sizes;
  const std::vector<double> sigmas = termSigmas(m_terms, m_state);
  for (std::size_t t = 0; t < sigmas.size(); ++t)
    if (m_active[t] && m_terms.terms()[t].robust) sizes.push_back(sigmas[t]);
  const double median = medianOf(std::move(sizes));
  if (median > 2 * m_options.huberSigmas) fit(median);
  fit(m_options.huberSigmas);
}

/// Points that too few terms are left to hold take no part.
void Adjustment::dropLoosePoints() {
  std::vector<int> rows(m_layout.slotPoint.size(), 0);
  for (std::size_t t = 0; t < m_active.size(); ++t) {
    const Term& term = m_terms.terms()[t];
    if (m_active[t] && term.slot >= 0)
      rows[term.slot] += term.kind == ResidualKind::Coordinates ? 3
                         : term.kind == ResidualKind::Surface || term.kind == ResidualKind::Depth ? 1 : 2;
  }
  for (std::size_t t = 0; t < m_active.size(); ++t) {
    const Term& term = m_terms.terms()[t];
    if (m_active[t] && term.slot >= 0 && rows[term.slot] < 3) m_active[t] = 0;
  }
}

/// Least squares without a loss on what agrees, until the same terms agree again.
bool Adjustment::settleOutliers() {
  for (int round = 0; round < 8; ++round) {
    const std::vector<double> sigmas = termSigmas(m_terms, m_state);
    std::vector<double> robust;
    for (std::size_t t = 0; t < sigmas.size(); ++t)
      if (m_usable[t] && m_terms.terms()[t].robust) robust.push_back(sigmas[t]);
    // Of two normal residuals |r|/sigma has the median 1.1774; sigmas far too small are the observer's, not outliers.
    const double median = medianOf(robust) / 1.1774;
    m_scale = median > 2 ? std::min(median, largestScale) : 1;
    const double limit = std::max(m_options.outlierSigmas, chanceLimit(robust.size())) * m_scale;
    std::vector<char> next = m_usable;
    for (std::size_t t = 0; t < sigmas.size(); ++t)
      if (next[t] && m_terms.terms()[t].robust && !(sigmas[t] <= limit)) next[t] = 0;
    const std::vector<char> before = m_active;
    m_active = std::move(next);
    dropLoosePoints();
    if (round > 0 && m_active == before) return true;
    if (!fit(0)) return false;
  }
  // The last few at the border changed sides again and again: what took part last counts.
  return true;
}

Result<NetworkSummary> Adjustment::run() {
  auto start = startState(m_terms.network(), m_layout, m_warnings);
  if (!start) return fail(start.error());
  m_start = m_state = std::move(*start);
  warnOfTwins();
  if (m_layout.freeUnknowns == 0)
    return refused("Poses, offsets, calibrations and clocks are all locked, nothing is left to adjust; free one of them");
  if (const auto why = leaveOutBehind()) return refused(*why);
  m_active = m_usable;
  dropLoosePoints();
  m_usable = m_active;
  if (const auto why = refusalOfFrames(m_terms, m_state, m_active)) return refused(*why);
  m_initialCost = networkCost(m_terms, m_state, m_active, m_options.huberSigmas);

  bool settled = true;
  if (m_options.huberSigmas > 0) {
    robustStart();
    settled = settleOutliers();
  } else {
    settled = fit(0);
  }
  if (m_last.cancelled) return fail(cancelledError());
  if (!settled)
    return refused(fmt::format("The adjustment did not settle within {} iterations; give better start poses or look for "
                               "wrong observations", m_options.maximumIterations));
  if (const auto why = refusalOfFrames(m_terms, m_state, m_active)) return refused(*why);

  NetworkSummary summary = describe(m_terms, m_state, m_active, m_options);
  if (m_scale > 1) summary.sigmaScale = std::max(1.0, summary.sigma0);
  if (m_options.covariance && !m_options.freeNetwork) {
    m_normals.linearise(m_state, 0);
    if (!m_normals.factorUndamped()) {
      const auto weak = m_normals.weakest();
      return refused(fmt::format("The observations leave {} open (singular normal equations); give known points or a known "
                                 "pose that fix it, or lock what is known",
                                 unknownName(m_terms.network(), m_layout, weak.block, weak.column)));
    }
    m_normals.useSigmaScale(summary.sigmaScale);
    if (const auto why = refusalOfWeakness(m_terms, m_state, m_active, m_normals)) return refused(*why);
    describeAccuracy(m_terms, m_state, m_normals, m_options, summary);
  }
  summary.converged = true;
  summary.reason = reasonOfConvergence(m_scale > 1, summary.sigma0);
  summary.iterations = m_iterations;
  summary.initialCost = m_initialCost;
  summary.warnings = m_warnings;
  return summary;
}

}  // namespace

Result<void> NetworkOptions::validate() const {
  if (const auto valid = checkRobustOptions(huberSigmas, outlierSigmas, maximumIterations); !valid) return valid;
  for (const At& a : at)
    if (!std::isfinite(a.world.x + a.world.y + a.world.z))
      return fail("A point for the expected error is not finite", "at", "Give its coordinates in metres");
  return {};
}

Result<NetworkSummary> adjustNetwork(const Network& network, const NetworkOptions& options, const Progress& progress) {
  if (const auto valid = options.validate(); !valid) return fail(valid.error().in("adjustment options"));
  if (const auto good = checkNetwork(network); !good) return fail(good.error());
  for (const NetworkOptions::At& at : options.at)
    if (at.frame < 0 || at.frame >= static_cast<int>(network.frames.size()))
      return fail("A point for the expected error names a frame that does not exist", "at", "Give one of the network's frames");
  return Adjustment(network, options, progress).run();
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "adjust/network.h"
#include "geometry/angle.h"

namespace alidade {

int NetworkSummary::outlierCount() const {
  return static_cast<int>(std::count_if(residuals.begin(), residuals.end(), [](const auto& r) { return r.outlier; }));
}

double CameraAccuracy::std(int parameter) const {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(covariance.size()))));
  return std::sqrt(std::max(0.0, covariance[static_cast<std::size_t>(parameter) * (n + 1)]));
}

double CameraAccuracy::correlation(int a, int b) const {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(covariance.size()))));
  const double product = std(a) * std(b);
  return product > 0 ? covariance[static_cast<std::size_t>(a) * n + static_cast<std::size_t>(b)] / product : 0.0;
}

RigidTransform cameraFromWorld(const Network& network, const NetworkSummary& summary, int frame) {
  const NetworkFrame& f = network.frames[frame];
  const RigidTransform& body = summary.poses[f.pose].bodyFromWorld;
  return f.mount < 0 ? body : summary.cameraFromBody[f.mount] * body;
}

namespace {

using Out = std::back_insert_iterator<std::string>;

std::string numberOrDash(double value) {
  return std::isfinite(value) ? fmt::format("{:.3f}", value) : std::string("-");
}

void writeGroups(Out out, const NetworkSummary& summary) {
  fmt::format_to(out, "\n  {:<22} {:>8} {:>9} {:>9} {:>11}\n", "Residuals", "number", "outliers", "rms px", "rms sigmas");
  for (const ResidualGroup& g : summary.groups) {
    const std::string name = fmt::format("{}{}", residualKindName(g.kind), g.heldOut ? ", held out" : "");
    fmt::format_to(out, "  {:<22} {:>8} {:>9} {:>9} {:>11}\n", name, g.count, g.outliers, numberOrDash(g.rmsPx),
                   numberOrDash(g.rmsSigmas));
  }
}

void writePoses(Out out, const Network& network, const NetworkSummary& summary) {
  constexpr std::size_t most = 50;
  fmt::format_to(out, "\n  Poses: centre E N H m; standard deviations mm and mgon; 95 % ellipse mm\n");
  for (std::size_t i = 0; i < std::min(most, summary.poses.size()); ++i) {
    const AdjustedPose& pose = summary.poses[i];
    const glm::dvec3 c = pose.bodyFromWorld.centre(), mm = 1000.0 * pose.positionStdM, mgon = pose.rotationStdRad * gonFromRadians(1000);
    fmt::format_to(out, "  {:<16} {:.4f} {:.4f} {:.4f}", network.poses[i].name, c.x, c.y, c.z);
    if (summary.converged)
      fmt::format_to(out, "  {:.1f} {:.1f} {:.1f}  {:.2f} {:.2f} {:.2f}  {:.1f} × {:.1f} at {:.0f} gon, ± {:.1f} up", mm.x, mm.y,
                     mm.z, mgon.x, mgon.y, mgon.z, 1000 * pose.ellipse.semiMajorM, 1000 * pose.ellipse.semiMinorM,
                     gonFromRadians(pose.ellipse.azimuthRad), 1000 * pose.ellipse.heightM);
    fmt::format_to(out, "\n");
  }
  if (summary.poses.size() > most) fmt::format_to(out, "  … and {} more\n", summary.poses.size() - most);
}

void writeResiduals(Out out, const Network& network, const NetworkSummary& summary) {
  constexpr std::size_t most = 60;
  std::vector<const NetworkResidual*> sorted;
  for (const NetworkResidual& r : summary.residuals) sorted.push_back(&r);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto* a, const auto* b) { return a->sigmas > b->sigmas; });
  fmt::format_to(out, "\n  {:<20} {:<14} {:<12} {:>9} {:>9} {:>8}\n", "Worst first", "frame", "kind", "du px", "dv px", "sigmas");
  for (std::size_t i = 0; i < std::min(most, sorted.size()); ++i) {
    const NetworkResidual& r = *sorted[i];
    fmt::format_to(out, "  {:<20} {:<14} {:<12} {:>9} {:>9} {:>8}{}{}\n", r.name,
                   r.frame < 0 ? std::string() : network.frames[r.frame].name, residualKindName(r.kind),
                   numberOrDash(r.residualPx.x), numberOrDash(r.residualPx.y), numberOrDash(r.sigmas),
                   r.outlier ? "  outlier" : "", r.heldOut ? "  held out" : "");
  }
  if (sorted.size() > most) fmt::format_to(out, "  … and {} more\n", sorted.size() - most);
}

}  // namespace

std::string NetworkSummary::report(const Network& network) const {
  std::string text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "Adjustment: {}\n  {}\n", converged ? "converged" : "refused", reason);
  for (const std::string& warning : warnings) fmt::format_to(out, "  {}\n", warning);
  if (converged) {
    fmt::format_to(out, "  {} iterations, cost {:.6g} to {:.6g}, sigma0 {:.3f}, redundancy {}, {} outliers\n", iterations,
                   initialCost, finalCost, sigma0, redundancy, outlierCount());
    writeGroups(out, *this);
  }
  writePoses(out, network, *this);
  for (std::size_t i = 0; i < clockOffsetSecs.size(); ++i)
    fmt::format_to(out, "  Clock offset {:.4f} s, standard deviation {:.4f} s\n", clockOffsetSecs[i], clockStdSecs[i]);
  for (const CheckPoint& c : checkPoints)
    fmt::format_to(out, "  Check point {:<12} {:+.1f} {:+.1f} {:+.1f} mm\n", c.name, 1000 * c.differenceM.x,
                   1000 * c.differenceM.y, 1000 * c.differenceM.z);
  for (const std::string& sentence : correlations) fmt::format_to(out, "  {}\n", sentence);
  for (const ExpectedError& e : expected)
    fmt::format_to(out, "  Expected error, 95 %, at E {:.3f} N {:.3f} H {:.3f}: {:.2f} × {:.2f} px, {:.1f} mm\n", e.world.x,
                   e.world.y, e.world.z, e.ellipseSemiMajorPx, e.ellipseSemiMinorPx, e.millimetres);
  if (!residuals.empty()) writeResiduals(out, network, *this);
  return text;
}

}  // namespace alidade

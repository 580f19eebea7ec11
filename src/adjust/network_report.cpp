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
  fmt::format_to(out, "\n  {:<22} {:>8} {:>9} {:>9} {:>9} {:>11}\n", "Residuals", "number", "outliers", "rms px", "rms mm", "rms sigmas");
  for (const ResidualGroup& g : summary.groups) {
    const std::string name = fmt::format("{}{}", residualKindName(g.kind), g.heldOut ? ", held out" : "");
    fmt::format_to(out, "  {:<22} {:>8} {:>9} {:>9} {:>9} {:>11}\n", name, g.count, g.outliers, numberOrDash(g.rmsPx),
                   numberOrDash(1000 * g.rmsM), numberOrDash(g.rmsSigmas));
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

void writeCalibrations(Out out, const Network& network, const NetworkSummary& summary) {
  for (std::size_t i = 0; i < summary.cameraAccuracy.size(); ++i) {
    if (summary.cameraAccuracy[i].covariance.empty()) continue;
    const Intrinsics& lens = summary.cameras[i];
    const auto names = parameterNames(lens.model);
    const auto was = network.cameras[i].intrinsics.parameters(), values = lens.parameters();
    fmt::format_to(out, "\n  {:<22} {:>16} {:>16} {:>14}\n", network.cameras[i].name, "before", "adjusted", "± std");
    for (std::size_t k = 0; k < names.size(); ++k) {
      const double std = summary.cameraAccuracy[i].std(static_cast<int>(k));
      const bool pixels = names[k][0] == 'f' || names[k][0] == 'c';
      fmt::format_to(out, "  {:<22} {:>16.{}f} {:>16.{}f} {:>14}\n", names[k], was[k], pixels ? 3 : 8, values[k], pixels ? 3 : 8,
                     std > 0 ? fmt::format("{:.{}f}", std, pixels ? 3 : 8) : std::string("locked"));
    }
  }
}

}  // namespace

std::string mountsText(const Network& network, const NetworkSummary& summary) {
  std::string text;
  auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < summary.cameraFromBody.size(); ++i) {
    const RigidTransform was = network.mounts[i].cameraFromBody, is = summary.cameraFromBody[i];
    const glm::dvec3 at = is.centre(), mm = 1000.0 * (at - was.centre());
    fmt::format_to(out, "Mount {}: at {:.4f} {:.4f} {:.4f} m on its body, moved {:.1f} {:.1f} {:.1f} mm, turned {:.2f} mgon", network.mounts[i].name,
                   at.x, at.y, at.z, mm.x, mm.y, mm.z, gonFromRadians(1000 * rotationAngleBetween(was, is)));
    if (i < summary.mountAccuracy.size() && summary.mountAccuracy[i].offsetStdM != glm::dvec3(0)) {
      const glm::dvec3 std = 1000.0 * summary.mountAccuracy[i].offsetStdM, mgon = summary.mountAccuracy[i].rotationStdRad * gonFromRadians(1000);
      fmt::format_to(out, "; standard deviations {:.1f} {:.1f} {:.1f} mm, {:.2f} {:.2f} {:.2f} mgon about the camera's axes", std.x, std.y, std.z,
                     mgon.x, mgon.y, mgon.z);
    }
    fmt::format_to(out, "\n");
  }
  return text;
}

namespace {

/// Three residuals and their sigmas, or why there are none.
std::string valuesText(const NetworkResidual& r, const NetworkSummary& summary) {
  if (std::isfinite(r.sigmas))
    return fmt::format("{:>9} {:>9} {:>9} {:>8}", numberOrDash(r.residualPx.x), numberOrDash(r.residualPx.y),
                       numberOrDash(1000 * r.residualM), numberOrDash(r.sigmas));
  const bool lost = r.point >= 0 && !std::isfinite(summary.points[r.point].x);
  return fmt::format("{:>38}", lost ? "point not found" : "behind the camera");
}

void writeResiduals(Out out, const Network& network, const NetworkSummary& summary) {
  constexpr std::size_t most = 60;
  std::vector<const NetworkResidual*> sorted;
  for (const NetworkResidual& r : summary.residuals) sorted.push_back(&r);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto* a, const auto* b) { return a->sigmas > b->sigmas; });
  fmt::format_to(out, "\n  {:<20} {:<14} {:<12} {:>9} {:>9} {:>9} {:>8}\n", "Worst first", "frame", "kind", "du px", "dv px", "mm", "sigmas");
  for (std::size_t i = 0; i < std::min(most, sorted.size()); ++i) {
    const NetworkResidual& r = *sorted[i];
    fmt::format_to(out, "  {:<20} {:<14} {:<12} {}{}{}\n", r.name,
                   r.frame < 0 ? std::string() : network.frames[r.frame].name, residualKindName(r.kind),
                   valuesText(r, summary), r.outlier ? "  outlier" : "", r.heldOut ? "  held out" : "");
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
  writeCalibrations(out, network, *this);
  text += mountsText(network, *this);
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

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "adjust/resection.h"
#include "geometry/angle.h"

namespace alidade {

int ResectionSummary::outlierCount() const {
  return static_cast<int>(std::count_if(residuals.begin(), residuals.end(), [](const auto& r) { return r.outlier; }));
}

std::string ResectionSummary::report() const {
  std::string text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "Resection: {}\n", converged ? "converged" : "refused");
  fmt::format_to(out, "  {}\n", reason);
  for (const std::string& warning : warnings) fmt::format_to(out, "  {}\n", warning);
  const glm::dvec3 centre = cameraFromWorld.centre();
  fmt::format_to(out, "  Camera centre       E {:.4f}  N {:.4f}  H {:.4f} m\n", centre.x, centre.y, centre.z);
  if (converged) {
    fmt::format_to(out, "  Standard deviation  E {:.4f}  N {:.4f}  H {:.4f} m\n", positionStdM.x, positionStdM.y,
                   positionStdM.z);
    const glm::dvec3 mgon = rotationStdRad * gonFromRadians(1000);
    fmt::format_to(out, "                      about x {:.2f}  y {:.2f}  z {:.2f} mgon\n", mgon.x, mgon.y, mgon.z);
    fmt::format_to(out, "  95 % ellipse        {:.4f} × {:.4f} m at {:.0f} gon, height ± {:.4f} m\n", ellipse.semiMajorM,
                   ellipse.semiMinorM, gonFromRadians(ellipse.azimuthRad), ellipse.heightM);
    for (const std::string& sentence : correlations) fmt::format_to(out, "  {}\n", sentence);
    fmt::format_to(out, "  Observations        {}, of them {} outliers\n", residuals.size(), outlierCount());
    fmt::format_to(out, "  Residual rms        {:.3f} px, sigma0 {:.3f}, {} iterations\n", rmsPx, sigma0, iterations);
  }
  if (!residuals.empty()) fmt::format_to(out, "\n  {:<20} {:>9} {:>9} {:>8}\n", "Point", "du px", "dv px", "sigmas");
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const ResectionResidual& r = residuals[i];
    const std::string name = r.name.empty() ? fmt::format("#{}", i + 1) : r.name;
    if (!std::isfinite(r.sigmas)) {
      fmt::format_to(out, "  {:<20} {:>28}{}\n", name, "behind the camera", r.outlier ? "  outlier" : "");
      continue;
    }
    fmt::format_to(out, "  {:<20} {:>9.3f} {:>9.3f} {:>8.2f}{}\n", name, r.residualPx.x, r.residualPx.y, r.sigmas,
                   r.outlier ? "  outlier" : "");
  }
  if (!expected.empty()) fmt::format_to(out, "\n  Expected error of the overlay, 95 %\n");
  for (const ExpectedError& e : expected)
    fmt::format_to(out, "  E {:.3f} N {:.3f} H {:.3f}: {:.2f} × {:.2f} px, {:.1f} mm\n", e.world.x, e.world.y, e.world.z,
                   e.ellipseSemiMajorPx, e.ellipseSemiMinorPx, e.millimetres);
  return text;
}

}  // namespace alidade

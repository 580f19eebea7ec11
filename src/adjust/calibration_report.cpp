// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <iterator>

#include <fmt/format.h>

#include "adjust/calibration.h"
#include "geometry/angle.h"

namespace alidade {

std::string CalibrationSummary::report() const {
  std::string text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "Calibration: {}\n", converged ? "converged" : "refused");
  if (!converged) fmt::format_to(out, "  {}\n", reason);
  for (const std::string& warning : warnings) fmt::format_to(out, "  warning: {}\n", warning);
  if (!converged) return text;
  fmt::format_to(out, "  {} pictures of {} × {} px, {} corners, {} outliers, {} iterations, redundancy {}\n", pictures.size(),
                 intrinsics.width, intrinsics.height, residuals.size(), outliers, iterations, redundancy);
  fmt::format_to(out, "  rms {:.4f} px a corner, {:.4f} px a coordinate; corners in {:.0f} % of the picture's cells\n", rmsPx,
                 sigmaPx, 100 * coverage);
  if (heldOutRmsPx) fmt::format_to(out, "  rms {:.4f} px of pictures left out\n", *heldOutRmsPx);
  if (board)
    fmt::format_to(out, "  board: {:.3f} mm off its plane, {:.3f} mm within it (root mean squares), worst {:.3f} mm at corner {}\n",
                   1000 * board->offPlaneM, 1000 * board->inPlaneM, 1000 * board->worstM, board->worstCorner);
  fmt::format_to(out, "\n  {:<10} {:>16} {:>12}\n", cameraModelName(intrinsics.model), "value", "± std");
  const auto names = parameterNames(intrinsics.model);
  const auto values = intrinsics.parameters();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool pixels = names[i][0] == 'f' || names[i][0] == 'c';
    if (pixels) fmt::format_to(out, "  {:<10} {:>13.3f} px {:>9.3f} px\n", names[i], values[i], parameterStd[i]);
    else fmt::format_to(out, "  {:<10} {:>16.8f} {:>12.8f}\n", names[i], values[i], parameterStd[i]);
  }
  for (const std::string& sentence : correlations) fmt::format_to(out, "  {}\n", sentence);
  fmt::format_to(out, "\n  {:<24} {:>8} {:>9} {:>8} {:>12} {:>7}\n", "Picture", "corners", "outliers", "rms px", "left out px", "tilt");
  for (const CalibratedPicture& p : pictures)
    fmt::format_to(out, "  {:<24} {:>8} {:>9} {:>8.3f} {:>12} {:>6.1f}°\n", p.name, p.corners, p.outliers, p.rmsPx,
                   p.heldOutRmsPx ? fmt::format("{:.3f}", *p.heldOutRmsPx) : "-", degreesFromRadians(p.tiltRad));
  return text;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>

#include <fmt/format.h>

#include "geometry/angle.h"
#include "geometry/attitude.h"
#include "io/camera_export_parts.h"

namespace alidade {

Result<void> writePoseTable(const ExportedSet& set, const std::string& path) {
  const auto anyHas = [&](char c) {
    return std::any_of(set.frames.begin(), set.frames.end(), [&](const ExportedFrame& f) { return f.name.find(c) != std::string::npos; });
  };
  const char s = !anyHas(',') ? ',' : !anyHas(';') ? ';' : '\t';
  std::string text = fmt::format("name{0}x_m{0}y_m{0}z_m{0}omega_deg{0}phi_deg{0}kappa_deg{0}time_s\n", s);
  for (const ExportedFrame& each : set.frames) {
    const RigidTransform worldFromCamera = each.frame->cameraFromWorld->inverse();
    const glm::dvec3& p = worldFromCamera.translation;
    const OmegaPhiKappa a = omegaPhiKappaOf(worldFromCamera.rotation);
    text += fmt::format("{1}{0}{2}{0}{3}{0}{4}{0}{5}{0}{6}{0}{7}{0}{8}\n", s, each.name, p.x, p.y, p.z, degreesFromRadians(a.omega),
                        degreesFromRadians(a.phi), degreesFromRadians(a.kappa), each.frame->timeSecs);
  }
  return writeAtomically(path, text);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/level_fit.h"

#include <cmath>

#include "align/pose_search.h"
#include "align/row_photo.h"
#include "base/parallel.h"

namespace alidade {

double LevelFit::score() const {
  double sum = 0;
  for (std::size_t i = 0; i < observations.size(); ++i)
    if (!resection.residuals.empty() && !resection.residuals[i].outlier) sum += correlation[i];
  return anchors.empty() || !resection.converged ? 0 : sum / static_cast<double>(anchors.size());
}

LevelFit fitLevel(const AlignmentScene& scene, const PictureLevel& level, const RigidTransform& cameraFromWorld,
                  const LevelFitOptions& options) {
  LevelFit fit;
  fit.view = drawScanView(scene, level.camera, cameraFromWorld);
  fit.anchors = anchorsOf(fit.view, level.camera, cameraFromWorld, options.half, options.cellPx);
  const MiddleRowPhoto photo(level, fit.view);
  std::vector<std::optional<PatchPlace>> places(fit.anchors.size());
  parallelFor(places.size(), 4, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i)
      places[i] = findPatch(fit.anchors[i].patch, photo.luma(), options.radiusPx, options.leastCorrelation,
                            glm::ivec2(glm::round(photo.offsetOf(cameraFromWorld * fit.anchors[i].world))));
  });
  std::vector<glm::dvec3> world;
  for (std::size_t i = 0; i < places.size(); ++i) {
    world.push_back(fit.anchors[i].world);
    if (!places[i] || places[i]->sigmaPx > 0.5) continue;
    fit.anchorOf.push_back(static_cast<int>(i));
    fit.correlation.push_back(places[i]->correlation);
    ResectionObservation seen;
    seen.pixel = photo.middlePixel(places[i]->pixel, cameraFromWorld * fit.anchors[i].world);
    seen.world = fit.anchors[i].world;
    seen.sigmaPx = std::hypot(places[i]->sigmaPx, options.noisePx);
    fit.observations.push_back(std::move(seen));
  }
  fit.resection.cameraFromWorld = cameraFromWorld;
  if (fit.observations.size() < 6) {
    fit.resection.reason = "fewer than six places of the scene were found in the picture";
    return fit;
  }
  if (auto made = resect(level.camera, cameraFromWorld, fit.observations, options.resection)) fit.resection = std::move(*made);
  else fit.resection.reason = made.error().what;
  fit.movedPx = distancePx(world, level.camera, cameraFromWorld, fit.resection.cameraFromWorld);
  return fit;
}

}  // namespace alidade

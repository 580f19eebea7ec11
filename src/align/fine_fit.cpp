// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/fine_fit.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "align/pose_search.h"
#include "align/row_photo.h"
#include "base/parallel.h"

namespace alidade {

namespace {

using Places = std::vector<std::optional<PatchPlace>>;

Image<float> blurred(const Image<float>& image, double sigmaPx) {
  Image<float> to(image.width(), image.height());
  const cv::Mat from(image.height(), image.width(), CV_32F, const_cast<float*>(image.data()));
  cv::Mat into(image.height(), image.width(), CV_32F, to.data());
  cv::GaussianBlur(from, into, {}, sigmaPx);
  return to;
}

Places follow(const std::vector<Anchor>& anchors, const std::vector<glm::ivec2>& offsets, const Image<float>& photo, const FineFitOptions& options) {
  Places places(anchors.size());
  parallelFor(places.size(), 4, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i)
      places[i] = followPatch(anchors[i].patch, photo, options.radiusPx, options.leastCorrelation, offsets[i]);
  });
  return places;
}

double correlationSum(const Places& places) {
  double sum = 0;
  for (const auto& place : places)
    if (place) sum += place->correlation;
  return sum;
}

}  // namespace

int blockOf(const glm::dvec2& at, const Image<float>& photo) {
  return static_cast<int>(at.y * kBlockRows / photo.height()) * kBlockColumns + static_cast<int>(at.x * kBlockColumns / photo.width());
}

FineFit fineFit(const AlignmentScene& scene, const PictureLevel& level, const RigidTransform& cameraFromWorld,
                const FineFitOptions& options) {
  FineFit fit;
  fit.drawnAt = cameraFromWorld;
  fit.view = drawScanView(scene, level.camera, cameraFromWorld);
  fit.anchors = anchorsOf(fit.view, level.camera, cameraFromWorld, options.half, std::max(options.half, level.camera.width() / 40));
  fit.blurPx = std::max(0.0, options.blurPx);
  const MiddleRowPhoto sharp(level, fit.view);
  std::vector<glm::ivec2> offsets;
  for (const Anchor& anchor : fit.anchors) offsets.emplace_back(glm::round(sharp.offsetOf(cameraFromWorld * anchor.world)));
  fit.photo = fit.blurPx > 0 ? blurred(sharp.luma(), fit.blurPx) : sharp.luma();
  Places places = follow(fit.anchors, offsets, fit.photo, options);
  // A scan is seldom as sharp as a photo: of a few widths of blur, the one at which most is found best.
  if (options.blurPx < 0)
    for (const double sigmaPx : {0.8, 1.6, 3.2}) {
      Image<float> photo = blurred(sharp.luma(), sigmaPx);
      Places again = follow(fit.anchors, offsets, photo, options);
      if (correlationSum(again) <= correlationSum(places)) break;
      places = std::move(again), fit.photo = std::move(photo), fit.blurPx = sigmaPx;
    }
  std::vector<glm::dvec3> world;
  for (std::size_t i = 0; i < places.size(); ++i) {
    world.push_back(fit.anchors[i].world);
    if (!places[i]) continue;
    fit.anchorOf.push_back(static_cast<int>(i));
    fit.correlation.push_back(places[i]->correlation);
    const glm::dvec2 pixel = sharp.middlePixel(places[i]->pixel, cameraFromWorld * fit.anchors[i].world);
    fit.places.push_back({fit.anchors[i].world, pixel, places[i]->information, blockOf(glm::dvec2(fit.anchors[i].patch.at), level.luma)});
  }
  fit.estimate = estimatePose(level.camera, cameraFromWorld, fit.places, options.known);
  if (fit.estimate) fit.movedPx = distancePx(world, level.camera, cameraFromWorld, fit.estimate->cameraFromWorld);
  return fit;
}

}  // namespace alidade

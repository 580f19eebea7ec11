// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/scan_painter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "raster/eye_dome.h"
#include "raster/occlusion.h"
#include "raster/splatter.h"

namespace alidade {

namespace {

SelectionOptions selectionOptions(const DisplaySettings& display) {
  SelectionOptions options;
  options.density = display.density;
  options.law = display.densityLaw;
  options.pointsPerSquareMetre = display.pointsPerSquareMetre;
  return options;
}

SplatOptions splatOptions(const FrameDescription& frame) {
  const DisplaySettings& display = frame.display;
  SplatOptions options;
  options.colour = true;
  options.pointSize = display.pointSize;
  options.round = display.roundPoints;
  if (display.points.sizeLaw == PointSizeLaw::Screen)
    for (const ScanLayer& scan : frame.scans)
      options.worldSizeM = std::max(options.worldSizeM, scan.points.store->medianSpacing());
  options.fixedSize = display.points.sizeLaw == PointSizeLaw::Fixed;
  return options;
}

}  // namespace

ScanPainter::ScanPainter() = default;
ScanPainter::~ScanPainter() = default;

PointStyler& ScanPainter::stylerOf(const ScanPoints& points) {
  auto& styler = m_stylers[points.store.get()];
  if (!styler) styler = std::make_unique<PointStyler>(points);
  return *styler;
}

/// The density slider chooses which points are *shown*; what hides the design is judged with every point
/// in view that the style does not filter out, so that thinning the display never changes what is visible.
///
/// Points average the noise of many returns and see with all stations' eyes, so they are asked first; the
/// surface of the scanners' grid answers where they are too sparse to tell (sample site: 95.9 % right with
/// both, 95.3 with points, 94.8 with the surface alone). A filtered scan is judged by its points: its
/// surface holds what the filter leaves out.
DepthImage ScanPainter::occlusion(const FrameDescription& frame, const Camera& camera) {
  const PointStyle& style = frame.display.points;
  std::vector<SplatLayer> layers;
  Occluders surfaces;
  bool any = false;
  for (const ScanLayer& scan : frame.scans) {
    Selection all = selectAll(*scan.points.store, camera, frame.cameraFromWorld);
    stylerOf(scan.points).apply(style, PointStyler::Part::Filter, frame.cameraFromWorld.centre(), all);
    any = any || all.pointCount > 0;
    layers.push_back({scan.points.store, std::move(all)});
    if (scan.surface && !style.filters()) surfaces.meshes.push_back(scan.surface);
  }
  if (!any) return DepthImage(camera.width(), camera.height(), std::numeric_limits<float>::quiet_NaN());
  DepthImage depth = occlusionDepth(layers, camera, frame.cameraFromWorld).depth;
  if (surfaces.meshes.empty()) return depth;
  const DepthImage behind = occlusionDepth(surfaces, camera, frame.cameraFromWorld).depth;
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (std::isnan(depth.data()[i])) depth.data()[i] = behind.data()[i];
  return depth;
}

ScanPictures ScanPainter::draw(const FrameDescription& frame, const Camera& camera, SplatDevice* device) {
  std::erase_if(m_stylers, [&](const auto& entry) {
    return std::none_of(frame.scans.begin(), frame.scans.end(),
                        [&](const ScanLayer& scan) { return scan.points.store.get() == entry.first; });
  });
  ScanPictures pictures;
  std::vector<std::shared_ptr<const PointStore>> stores;
  for (const ScanLayer& scan : frame.scans) {
    stores.push_back(scan.points.store);
    pictures.total += scan.points.store->pointCount();
  }
  // Also with the depth pass off: the read-out under the cursor stands on it.
  pictures.depth = occlusion(frame, camera);
  const std::vector<Selection> selections =
      select(stores, camera, frame.cameraFromWorld, selectionOptions(frame.display));
  for (const Selection& selection : selections) pictures.drawn += selection.pointCount;
  if (!frame.display.pointPass) return pictures;

  std::vector<SplatLayer> layers;
  for (std::size_t i = 0; i < stores.size(); ++i) {
    layers.push_back({stores[i], selections[i]});
    stylerOf(frame.scans[i].points)
        .apply(frame.display.points, PointStyler::Part::ColourAndFilter, frame.cameraFromWorld.centre(),
               layers.back().selection);
  }
  SplatOptions options = splatOptions(frame);
  options.device = device;
  SplatImages splats = splat(layers, camera, frame.cameraFromWorld, options);
  if (frame.display.points.eyeDome)
    applyEyeDome(splats.depth, {frame.display.points.eyeDomeStrength, 1}, splats.colour);
  pictures.colour = std::move(splats.colour);
  return pictures;
}

}  // namespace alidade

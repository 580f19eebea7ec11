// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/point_painter.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "cloud/selection.h"
#include "raster/eye_dome.h"

namespace alidade {

namespace {

SelectionOptions selectionOptions(const DisplaySettings& display, const PointView& view) {
  SelectionOptions options;
  options.pointBudget = view.pointBudget;
  options.density = display.density;
  options.law = display.densityLaw;
  options.pointsPerSquareMetre = display.pointsPerSquareMetre;
  // By point only what is drawn is cut, once it is styled.
  options.threshold = display.levelThreshold == LevelThreshold::Uniform ? LevelThreshold::Uniform : LevelThreshold::ByDistance;
  options.byFacing = display.levelThreshold == LevelThreshold::ByDistance;  // cutByPoint() looks at distances alone
  return options;
}

SplatOptions splatOptions(const ChosenPoints& points, const DisplaySettings& display) {
  SplatOptions options;
  options.colour = true;
  options.pointSize = display.pointSize;
  options.round = display.roundPoints;
  if (display.points.sizeLaw == PointSizeLaw::Screen)
    for (const SplatLayer& layer : points.layers) options.worldSizeM = std::max(options.worldSizeM, layer.store->medianSpacing());
  options.fixedSize = display.points.sizeLaw == PointSizeLaw::Fixed;
  return options;
}

double millisecondsNow() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

PointPainter::PointPainter() : PointPainter(millisecondsNow) {}
PointPainter::PointPainter(Clock clock) : m_clock(std::move(clock)) {}
PointPainter::~PointPainter() = default;

PointStyler& PointPainter::stylerOf(const ScanPoints& scan) {
  auto& styler = m_stylers[scan.store.get()];
  if (!styler) styler = std::make_unique<PointStyler>(scan);
  return *styler;
}

/// While the view moves, what was selected for one view may serve the next ones, too: at the border of the view
/// points are then missing, and distances are a little off.
const std::vector<Selection>& PointPainter::selectionsFor(const std::vector<ScanPoints>& scans, const DisplaySettings& display,
                                                          const PointView& view) {
  std::vector<std::shared_ptr<const PointStore>> stores;
  for (const ScanPoints& scan : scans) stores.push_back(scan.store);
  const double now = m_clock();
  const bool fresh = now - m_selectedAt < view.selectionAgeMs;
  if (fresh && stores == m_stores) return m_selections;
  m_stores = std::move(stores);
  m_selections = select(m_stores, view.camera, view.cameraFromWorld, selectionOptions(display, view));
  m_selectedAt = now;
  return m_selections;
}

ChosenPoints PointPainter::choose(const std::vector<ScanPoints>& scans, const DisplaySettings& display, const PointView& view,
                                  PointStyler::Part part) {
  std::erase_if(m_stylers, [&](const auto& entry) {
    return std::none_of(scans.begin(), scans.end(), [&](const ScanPoints& scan) { return scan.store.get() == entry.first; });
  });
  ChosenPoints points;
  const std::vector<Selection>& selections = selectionsFor(scans, display, view);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    Selection selection = selections[i];
    points.chosen += selection.pointCount;
    stylerOf(scans[i]).apply(display.points, part, view.cameraFromWorld.centre(), selection);
    if (display.levelThreshold == LevelThreshold::ByPoint)
      cutByPoint(*scans[i].store, view.camera, view.cameraFromWorld, selectionOptions(display, view), selection);
    points.drawn += selection.pointCount;
    points.layers.push_back({scans[i].store, std::move(selection)});
  }
  return points;
}

SplatImages PointPainter::draw(const ChosenPoints& points, const DisplaySettings& display, const PointView& view, SplatDevice* device) const {
  SplatOptions options = splatOptions(points, display);
  options.device = device;
  SplatImages images = splat(points.layers, view.camera, view.cameraFromWorld, options);
  if (display.points.eyeDome) applyEyeDome(images.depth, {display.points.eyeDomeStrength, 1}, images.colour);
  return images;
}

}  // namespace alidade

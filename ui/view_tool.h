// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <QCursor>
#include <QMouseEvent>
#include <QString>

#include <glm/glm.hpp>

#include "survey/project.h"

class QPainter;

namespace alidade {

class OverlayView;

/// What the left button does in the picture.
class ViewTool {
 public:
  virtual ~ViewTool() = default;
  virtual QCursor cursor() const { return Qt::CrossCursor; }
  virtual QString hint() const { return {}; }
  virtual void press(OverlayView& view, const QMouseEvent& event) = 0;
  virtual void move(OverlayView&, const QMouseEvent&) {}
  virtual void release(OverlayView&, const QMouseEvent&) {}
  virtual void doubleClick(OverlayView&, const QMouseEvent&) {}
  virtual void paint(OverlayView&, QPainter&) {}
  /// Gives up what is half done; false where there was nothing.
  virtual bool escape() { return false; }
};

/// A measured distance between two scanned points, world metres.
struct MeasuredDistance {
  glm::dvec3 from{0}, to{0};
  std::optional<double> uncertaintyM;
};
using MeasuredDistances = std::vector<MeasuredDistance>;

/// Selects what is under the cursor; drags annotations; a double click edits their text.
std::unique_ptr<ViewTool> makeSelectTool();
/// Magnifier and scan depth; a click reports the point.
std::unique_ptr<ViewTool> makePickTool();
std::unique_ptr<ViewTool> makeMeasureTool(std::shared_ptr<MeasuredDistances> measurements);
std::unique_ptr<ViewTool> makeAnnotateTool(AnnotationKind kind);
/// One click with the magnifier. `wantsScan`: only where the scan supports the pixel.
std::unique_ptr<ViewTool> makePointTool(
    const QString& hint, bool wantsScan,
    std::function<void(const glm::dvec2& raw, const std::optional<glm::dvec3>& world)> picked,
    std::function<void()> cancelled);

/// The magnifier beside the cursor: the raw picture enlarged, a sub-pixel mark, the scan's depth along
/// the row beneath.
void paintMagnifier(OverlayView& view, QPainter& painter);
void paintDistances(OverlayView& view, QPainter& painter, const MeasuredDistances& measurements);

}  // namespace alidade

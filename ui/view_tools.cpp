// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <QApplication>
#include <QPainter>

#include "ui/format.h"
#include "ui/overlay_view.h"
#include "ui/view_tool.h"

namespace alidade {

namespace {

constexpr double kGrabPx = 10.0;  // screen pixels around a handle or a point

Annotation* findAnnotation(Project& project, AnnotationId id) {
  for (Annotation& annotation : project.annotations)
    if (annotation.id == id) return &annotation;
  return nullptr;
}

const Annotation* findAnnotation(const Project& project, AnnotationId id) {
  return findAnnotation(const_cast<Project&>(project), id);
}

/// Raw pixel that the annotation points at in the picture now shown.
std::optional<glm::dvec2> anchorOf(const OverlayView& view, const Annotation& annotation) {
  if (annotation.anchor == AnnotationAnchor::World) return view.probe().project(annotation.world);
  return annotation.pixel;
}

/// Ties the annotation to the world where the scan supports the pixel, else to the picture.
void setAnchor(OverlayView& view, Annotation& annotation, const glm::dvec2& raw) {
  const CursorReadout readout = view.probe().readout(raw);
  annotation.pixel = raw;
  annotation.anchor = readout.world ? AnnotationAnchor::World : AnnotationAnchor::Picture;
  if (readout.world) annotation.world = *readout.world;
}

void editAnnotation(OverlayView& view, AnnotationId id) {
  const Annotation* annotation = findAnnotation(*view.session().project(), id);
  if (!annotation) return;
  const auto anchor = anchorOf(view, *annotation);
  if (!anchor) return;
  const glm::dvec2 at =
      *anchor + (annotation->kind == AnnotationKind::Text ? glm::dvec2(0) : annotation->offsetPx);
  Session& session = view.session();
  view.editText(view.viewFromRaw(at), text(annotation->text), [&session, id](const QString& typed) {
    if (typed.isEmpty()) return;
    session.change(OverlayView::tr("Edit annotation"), [&](Project& project) {
      if (Annotation* a = findAnnotation(project, id)) a->text = typed.toStdString();
    });
  });
}

class SelectTool : public ViewTool {
 public:
  QCursor cursor() const override { return Qt::ArrowCursor; }

  void press(OverlayView& view, const QMouseEvent& event) override {
    const glm::dvec2 raw = view.rawFromView(event.position());
    Session& session = view.session();
    SelectionState selection;
    if (const AnnotationId annotation = view.probe().annotationAt(raw)) {
      selection.annotation = annotation;
      m_dragged = annotation;
      m_from = raw;
      m_moved = false;
      const Annotation* a = findAnnotation(*session.project(), annotation);
      const auto anchor = a ? anchorOf(view, *a) : std::nullopt;
      m_movesAnchor = !a || a->kind == AnnotationKind::Text ||
                      (anchor && glm::length(*anchor - raw) * view.zoom() < kGrabPx);
      if (a) m_original = *a;
    } else if (auto stake = view.probe().stakePointAt(raw, kGrabPx / view.zoom()); !stake.empty()) {
      selection.stakePoint = stake;
    } else if (const auto element = view.probe().elementAt(raw)) {
      selection.design = element->design;
      selection.element = element->element;
    }
    session.select(selection);
  }

  void move(OverlayView& view, const QMouseEvent& event) override {
    if (!m_dragged || !(event.buttons() & Qt::LeftButton)) return;
    const glm::dvec2 raw = view.rawFromView(event.position());
    if (!m_moved && glm::length(raw - m_from) * view.zoom() < 3.0) return;
    m_moved = true;
    view.session().dragChange([&](Project& project) {
      Annotation* a = findAnnotation(project, m_dragged);
      if (!a) return;
      if (!m_movesAnchor) {
        a->offsetPx = m_original.offsetPx + (raw - m_from);
        return;
      }
      const auto start = anchorOf(view, m_original);
      setAnchor(view, *a, (start ? *start : m_original.pixel) + (raw - m_from));
    });
  }

  void release(OverlayView& view, const QMouseEvent&) override {
    if (m_dragged && m_moved) view.session().commitDrag(OverlayView::tr("Move annotation"));
    m_dragged = {};
  }

  void doubleClick(OverlayView& view, const QMouseEvent& event) override {
    if (const AnnotationId id = view.probe().annotationAt(view.rawFromView(event.position())))
      editAnnotation(view, id);
  }

 private:
  AnnotationId m_dragged;
  Annotation m_original;
  glm::dvec2 m_from{0};
  bool m_moved = false, m_movesAnchor = false;
};

class PickTool : public ViewTool {
 public:
  QString hint() const override {
    return OverlayView::tr("Pick: click a point to read its coordinates. Esc leaves");
  }
  void press(OverlayView& view, const QMouseEvent& event) override {
    const glm::dvec2 raw = view.rawFromView(event.position());
    const CursorReadout readout = view.probe().readout(raw);
    if (!readout.world) {
      view.flash(OverlayView::tr("The scan supports nothing at this pixel. Pick where scan points are"));
      return;
    }
    QString words = formatWorld(*readout.world);
    if (readout.uncertaintyM) words += QStringLiteral(" ± %1").arg(formatMillimetres(*readout.uncertaintyM));
    view.session().messages().info(OverlayView::tr("Picked %1 at %2").arg(words, formatPixel(raw)));
    m_world = readout.world;
    m_words = words;
  }
  void paint(OverlayView& view, QPainter& painter) override {
    if (m_world) {
      if (const auto raw = view.probe().project(*m_world)) {
        const QPointF p = view.viewFromRaw(*raw);
        drawCasedLine(painter, p - QPointF(8, 0), p + QPointF(8, 0), Qt::white);
        drawCasedLine(painter, p - QPointF(0, 8), p + QPointF(0, 8), Qt::white);
        drawCasedText(painter, p + QPointF(12, -8), m_words, Qt::white);
      }
    }
    paintMagnifier(view, painter);
  }
  bool escape() override { return std::exchange(m_world, std::nullopt).has_value(); }

 private:
  std::optional<glm::dvec3> m_world;
  QString m_words;
};

class MeasureTool : public ViewTool {
 public:
  explicit MeasureTool(std::shared_ptr<MeasuredDistances> measurements)
      : m_measurements(std::move(measurements)) {}
  QString hint() const override {
    return m_first ? OverlayView::tr("Measure: click the second point. Esc starts again")
                   : OverlayView::tr("Measure: click the first point on the scan. Esc leaves");
  }
  void press(OverlayView& view, const QMouseEvent& event) override {
    const CursorReadout readout = view.probe().readout(view.rawFromView(event.position()));
    if (!readout.world) {
      view.flash(OverlayView::tr("The scan supports nothing at this pixel. Measure between scanned points"));
      return;
    }
    if (!m_first) {
      m_first = readout;
      return;
    }
    MeasuredDistance m{*m_first->world, *readout.world, std::nullopt};
    if (m_first->uncertaintyM && readout.uncertaintyM)
      m.uncertaintyM = std::hypot(*m_first->uncertaintyM, *readout.uncertaintyM);
    m_measurements->push_back(m);
    m_first.reset();
    view.session().messages().info(OverlayView::tr("Measured %1 m from %2 to %3")
                                       .arg(QString::number(glm::length(m.to - m.from), 'f', 3),
                                            formatWorld(m.from), formatWorld(m.to)));
  }
  void paint(OverlayView& view, QPainter& painter) override {
    paintDistances(view, painter, *m_measurements);
    if (m_first && view.cursorRaw()) {
      if (const auto raw = view.probe().project(*m_first->world)) {
        const QPointF a = view.viewFromRaw(*raw), b = view.viewFromRaw(*view.cursorRaw());
        drawCasedLine(painter, a, b, QColor(120, 230, 255));
        if (view.cursorReadout().world)
          drawCasedText(painter, b + QPointF(12, -10),
                        QStringLiteral("%1 m").arg(glm::length(*view.cursorReadout().world - *m_first->world),
                                                   0, 'f', 3),
                        Qt::white);
      }
    }
    paintMagnifier(view, painter);
  }
  bool escape() override { return std::exchange(m_first, std::nullopt).has_value(); }

 private:
  std::shared_ptr<MeasuredDistances> m_measurements;
  std::optional<CursorReadout> m_first;
};

class AnnotateTool : public ViewTool {
 public:
  explicit AnnotateTool(AnnotationKind kind) : m_kind(kind) {}
  QString hint() const override {
    switch (m_kind) {
      case AnnotationKind::Text:
        return OverlayView::tr("Text: click where it belongs. Esc leaves");
      case AnnotationKind::Arrow:
        return OverlayView::tr("Arrow: press on the point, drag to the tail. Esc leaves");
      case AnnotationKind::Callout:
        return OverlayView::tr("Callout: press on the point, drag to the text. Esc leaves");
    }
    return {};
  }
  void press(OverlayView& view, const QMouseEvent& event) override {
    m_tip = view.rawFromView(event.position());
  }

  void release(OverlayView& view, const QMouseEvent& event) override {
    if (!m_tip) return;
    const glm::dvec2 tip = *std::exchange(m_tip, std::nullopt);
    const glm::dvec2 end = view.rawFromView(event.position());
    Annotation made;
    made.kind = m_kind;
    made.frame = view.session().frame();
    setAnchor(view, made, tip);
    // Screen pixels, so that an annotation made by one click looks the same at any zoom.
    made.offsetPx = glm::length(end - tip) * view.zoom() > 6 ? end - tip : glm::dvec2(60, -40) / view.zoom();
    Session& session = view.session();
    if (m_kind == AnnotationKind::Arrow) {
      add(session, made);
      return;
    }
    const glm::dvec2 at = m_kind == AnnotationKind::Text ? tip : tip + made.offsetPx;
    view.editText(view.viewFromRaw(at), QString(), [&session, made](const QString& typed) mutable {
      if (typed.isEmpty()) return;
      made.text = typed.toStdString();
      add(session, made);
    });
  }

  void paint(OverlayView& view, QPainter& painter) override {
    if (m_tip && view.cursorRaw() && m_kind != AnnotationKind::Text)
      drawCasedLine(painter, view.viewFromRaw(*m_tip), view.viewFromRaw(*view.cursorRaw()),
                    QColor(255, 200, 0));
  }
  bool escape() override { return std::exchange(m_tip, std::nullopt).has_value(); }

 private:
  static void add(Session& session, Annotation made) {
    for (const Annotation& a : session.project()->annotations)
      made.id.value = std::max(made.id.value, a.id.value);
    ++made.id.value;
    session.change(OverlayView::tr("Add annotation"),
                   [&](Project& project) { project.annotations.push_back(made); });
    SelectionState selection;
    selection.annotation = made.id;
    session.select(selection);
  }

  AnnotationKind m_kind;
  std::optional<glm::dvec2> m_tip;
};

class PointTool : public ViewTool {
 public:
  using Picked = std::function<void(const glm::dvec2&, const std::optional<glm::dvec3>&)>;
  PointTool(const QString& hint, bool wantsScan, Picked picked, std::function<void()> cancelled)
      : m_hint(hint),
        m_wantsScan(wantsScan),
        m_picked(std::move(picked)),
        m_cancelled(std::move(cancelled)) {}
  QString hint() const override { return m_hint; }
  void press(OverlayView& view, const QMouseEvent& event) override {
    const glm::dvec2 raw = view.rawFromView(event.position());
    const CursorReadout readout = view.probe().readout(raw);
    if (m_wantsScan && !readout.world) {
      view.flash(OverlayView::tr("The scan supports nothing at this pixel. Pick where scan points are"));
      return;
    }
    // The callback may replace this very tool.
    const Picked picked = m_picked;
    picked(raw, readout.world);
  }
  void paint(OverlayView& view, QPainter& painter) override { paintMagnifier(view, painter); }
  bool escape() override {
    const auto cancelled = std::exchange(m_cancelled, nullptr);
    if (cancelled) cancelled();
    return cancelled != nullptr;
  }

 private:
  QString m_hint;
  bool m_wantsScan;
  Picked m_picked;
  std::function<void()> m_cancelled;
};

}  // namespace

std::unique_ptr<ViewTool> makeSelectTool() {
  return std::make_unique<SelectTool>();
}
std::unique_ptr<ViewTool> makePickTool() {
  return std::make_unique<PickTool>();
}
std::unique_ptr<ViewTool> makeMeasureTool(std::shared_ptr<MeasuredDistances> measurements) {
  return std::make_unique<MeasureTool>(std::move(measurements));
}
std::unique_ptr<ViewTool> makeAnnotateTool(AnnotationKind kind) {
  return std::make_unique<AnnotateTool>(kind);
}
std::unique_ptr<ViewTool> makePointTool(
    const QString& hint, bool wantsScan,
    std::function<void(const glm::dvec2&, const std::optional<glm::dvec3>&)> picked,
    std::function<void()> cancelled) {
  return std::make_unique<PointTool>(hint, wantsScan, std::move(picked), std::move(cancelled));
}

}  // namespace alidade

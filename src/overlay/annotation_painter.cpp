// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/annotation_painter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <QImage>
#include <QPainter>
#include <QPainterPath>

#include "overlay/annotation_layout.h"
#include "overlay/frame_uniform.h"
#include "overlay/text_sprites.h"

namespace alidade {

namespace {

const QColor kStakeColour(0, 200, 255);
const QColor kSelectionColour(255, 140, 13);
const QColor kResidualColour(255, 60, 60);
const QColor kCasing(10, 14, 20, 205);

QPointF point(const glm::dvec2& p) {
  return {p.x + 0.5, p.y + 0.5};
}  // QPainter's origin is the corner

/// How a mark is drawn for what the scan says of it; not at all where `drawn` is false.
struct Look {
  bool drawn = true;
  double opacity = 1;
  Qt::PenStyle line = Qt::SolidLine;
};

Look lookOf(Visibility visibility, HiddenStyle hidden) {
  if (visibility == Visibility::Unknown) return {true, 0.85, Qt::DotLine};
  if (visibility != Visibility::Hidden) return {};
  if (hidden == HiddenStyle::Hide) return {false, 0, Qt::SolidLine};
  if (hidden == HiddenStyle::Ghost) return {true, 0.35, Qt::SolidLine};
  return {true, 1, Qt::DashLine};
}

/// Everything that the marks of one picture share.
class Painter {
 public:
  Painter(OverlayPicture& picture, const FrameDescription& frame, const Camera& camera, TextSprites& texts)
      : m_picture(picture),
        m_frame(frame),
        m_camera(camera),
        m_image(reinterpret_cast<uchar*>(picture.colour.data()), picture.colour.width(),
                picture.colour.height(), 4 * picture.colour.width(), QImage::Format_RGBA8888_Premultiplied),
        m_paint(&m_image),
        m_scale(drawingScale(picture.colour.width(), picture.colour.height(), frame.enlargement)),
        m_texts(texts) {
    m_paint.setRenderHint(QPainter::Antialiasing);
  }

  void stakePoints();
  void annotations();
  void residuals();

 private:
  Visibility visibilityOf(const glm::dvec2& pixel, double depth) const;
  void stroke(const QPainterPath& path, const QColor& colour, double width, const Look& look);
  void stakeSymbol(const glm::dvec2& pixel, const QColor& colour, const Look& look, bool selected);
  void toleranceCircle(const StakePoint& stake, const QColor& colour, const Look& look);
  void label(const glm::dvec2& at, double clearance, const std::string& text, bool bold, const Look& look,
             bool must);
  void text(const TextBlock& block, const QRectF& box, const QFont& font, const QColor& colour);
  void annotation(const Annotation& annotation, const AnnotationLayout& layout, const Look& look);
  bool isFree(const QRectF& box) const;

  OverlayPicture& m_picture;
  const FrameDescription& m_frame;
  const Camera& m_camera;
  QImage m_image;
  QPainter m_paint;
  double m_scale;
  TextSprites& m_texts;
  std::vector<QRectF> m_taken;
};

Visibility Painter::visibilityOf(const glm::dvec2& pixel, double depth) const {
  if (!m_frame.display.depthPass || m_picture.pointsDrawn == 0 || m_picture.scanDepth.empty())
    return Visibility::Visible;
  return visibilityAt(m_picture.scanDepth, pixel, depth, m_frame.display.depthToleranceM);
}

/// Twice: a wide dark casing under the coloured line, so that it reads on dark and bright.
void Painter::stroke(const QPainterPath& path, const QColor& colour, double width, const Look& look) {
  m_paint.setBrush(Qt::NoBrush);
  m_paint.setOpacity(look.opacity);
  m_paint.setPen(QPen(kCasing, (width + 2.2) * m_scale,
                      look.line == Qt::SolidLine ? Qt::SolidLine : look.line, Qt::FlatCap, Qt::RoundJoin));
  if (look.line == Qt::SolidLine) m_paint.drawPath(path);
  QPen pen(colour, width * m_scale, look.line, Qt::FlatCap, Qt::RoundJoin);
  if (look.line != Qt::SolidLine) pen.setWidthF((width + 0.4) * m_scale);
  m_paint.setPen(pen);
  m_paint.drawPath(path);
  m_paint.setOpacity(1);
}

void Painter::stakeSymbol(const glm::dvec2& pixel, const QColor& colour, const Look& look, bool selected) {
  const QPointF c = point(pixel);
  const double r = (selected ? 9 : 7) * m_scale, arm = 1.6 * r;
  QPainterPath path;
  path.addEllipse(c, r, r);
  path.moveTo(c - QPointF(arm, 0));
  path.lineTo(c + QPointF(arm, 0));
  path.moveTo(c - QPointF(0, arm));
  path.lineTo(c + QPointF(0, arm));
  stroke(path, colour, selected ? 2.2 : 1.5, look);
}

/// Lies flat in the world, true to scale, bent by the lens like everything else.
void Painter::toleranceCircle(const StakePoint& stake, const QColor& colour, const Look& look) {
  if (!(stake.toleranceM > 0)) return;
  constexpr int corners = 48;
  QPainterPath path;
  double widest = 0;
  const auto centre = project(m_camera, m_frame.shutter, m_frame.cameraFromWorld * stake.position);
  for (int i = 0; i <= corners; ++i) {
    const double angle = 2 * std::numbers::pi * (i % corners) / corners;
    const glm::dvec3 rim =
        stake.position + stake.toleranceM * glm::dvec3(std::cos(angle), std::sin(angle), 0);
    const auto pixel = project(m_camera, m_frame.shutter, m_frame.cameraFromWorld * rim);
    if (!pixel || !centre) return;
    widest = std::max(widest, glm::length(*pixel - *centre));
    if (i == 0)
      path.moveTo(point(*pixel));
    else
      path.lineTo(point(*pixel));
  }
  if (widest > 1.5 * m_scale && widest < 4.0 * m_camera.width()) stroke(path, colour, 1.2, look);
}

bool Painter::isFree(const QRectF& box) const {
  const QRectF whole(0, 0, m_image.width(), m_image.height());
  return whole.contains(box) && std::none_of(m_taken.begin(), m_taken.end(),
                                             [&](const QRectF& other) { return other.intersects(box); });
}

/// On whole pixels, as letters are drawn.
void Painter::text(const TextBlock& block, const QRectF& box, const QFont& font, const QColor& colour) {
  const TextSprites::Sprite& sprite = m_texts.of(block, font, colour, m_scale);
  m_paint.drawImage(QPointF(std::round(box.left()) - sprite.margin, std::round(box.top()) - sprite.margin), sprite.image);
}

/// Beside its mark in the first free place of eight; left out where all are taken, unless it must stand.
void Painter::label(const glm::dvec2& at, double clearance, const std::string& words, bool bold,
                    const Look& look, bool must) {
  if (!m_frame.display.labels || words.empty() || !hasFonts()) return;
  const QFont font = overlayFont(m_scale, bold);
  const TextBlock block = layOutText(words, font);
  if (block.lines.isEmpty()) return;
  const double w = block.size.width(), h = block.size.height();
  const QPointF c = point(at);
  static constexpr std::array<std::array<double, 2>, 8> sides{
      {{1, -1}, {1, 1}, {-1, -1}, {-1, 1}, {1, 0}, {-1, 0}, {0, -1}, {0, 1}}};
  for (const double distance : {clearance, 2.5 * clearance}) {
    for (const auto& [sx, sy] : sides) {
      const double x = sx > 0 ? c.x() + distance : sx < 0 ? c.x() - distance - w : c.x() - 0.5 * w;
      const double y = sy > 0   ? c.y() + 0.6 * distance
                       : sy < 0 ? c.y() - 0.6 * distance - h
                                : c.y() - 0.5 * h;
      const QRectF box(QPointF(x, y), block.size);
      const bool last = must && distance > clearance && sx == 0 && sy > 0;
      if (!isFree(box) && !last) continue;
      m_taken.push_back(box);
      m_paint.setOpacity(std::max(look.opacity, 0.5));
      text(block, box, font, Qt::white);
      m_paint.setOpacity(1);
      return;
    }
  }
}

void Painter::stakePoints() {
  struct Seen {
    const StakePoint* stake;
    glm::dvec2 pixel;
    Look look;
    bool selected;
  };
  std::vector<Seen> seen;
  for (const StakePoint& stake : m_frame.stakePoints) {
    const auto pInCamera = pointAtItsRow(m_camera, m_frame.shutter, m_frame.cameraFromWorld * stake.position);
    const auto pixel = pInCamera ? m_camera.project(*pInCamera) : std::nullopt;
    if (!pixel || !m_camera.inPicture(*pixel)) continue;
    const auto& names = m_frame.selectedStakePoints;
    const bool selected = std::find(names.begin(), names.end(), stake.name) != names.end();
    const Look look = lookOf(visibilityOf(*pixel, pInCamera->z), m_frame.display.hidden);
    if (look.drawn || selected) seen.push_back({&stake, *pixel, look, selected});
  }
  for (const Seen& s : seen) {
    const double r = 10 * m_scale;
    m_taken.emplace_back(s.pixel.x - r, s.pixel.y - r, 2 * r, 2 * r);
    const QColor colour = s.selected ? kSelectionColour : kStakeColour;
    toleranceCircle(*s.stake, colour, s.look);
    stakeSymbol(s.pixel, colour, s.look, s.selected);
  }
  std::stable_partition(seen.begin(), seen.end(), [](const Seen& s) { return s.selected; });
  for (const Seen& s : seen) {
    const std::string code = s.stake->code.empty() ? "" : "\n" + s.stake->code;
    label(s.pixel, 12 * m_scale, s.stake->name + code, s.selected, s.look, s.selected);
  }
}

void Painter::annotation(const Annotation& what, const AnnotationLayout& layout, const Look& look) {
  const QColor colour(what.colour.r, what.colour.g, what.colour.b);
  const QPointF tip = point(layout.tip), tail = point(layout.tail);
  const double length = std::hypot(tip.x() - tail.x(), tip.y() - tail.y());
  if (what.kind != AnnotationKind::Text && length > 1) {
    QPainterPath path(tail);
    path.lineTo(tip);
    if (what.kind == AnnotationKind::Arrow) {
      const QPointF back = (tail - tip) / length * std::min(14 * m_scale, 0.5 * length);
      const QPointF side(-0.45 * back.y(), 0.45 * back.x());
      path.moveTo(tip + back + side);
      path.lineTo(tip);
      path.lineTo(tip + back - side);
    } else {
      path.addEllipse(tip, 3 * m_scale, 3 * m_scale);
    }
    stroke(path, colour, 2, look);
  }
  m_paint.setOpacity(std::max(look.opacity, 0.5));
  if (what.kind == AnnotationKind::Callout && !layout.box.isEmpty()) {
    m_paint.setPen(QPen(colour, 1.5 * m_scale, look.line));
    m_paint.setBrush(QColor(20, 24, 32, 215));
    m_paint.drawRoundedRect(layout.box, 4 * m_scale, 4 * m_scale);
  }
  const bool onDark = what.kind == AnnotationKind::Callout;
  if (!layout.box.isEmpty() && hasFonts())
    text(layout.text, layout.box, overlayFont(m_scale), onDark ? QColor(Qt::white) : colour);
  m_paint.setOpacity(1);
  if (what.id == m_frame.selectedAnnotation && what.id) {
    QRectF around = layout.box.isEmpty() ? QRectF(tip, tail).normalized() : layout.box;
    around.adjust(-4 * m_scale, -4 * m_scale, 4 * m_scale, 4 * m_scale);
    QPainterPath path;
    path.addRect(around);
    stroke(path, kSelectionColour, 1.5, {true, 1, Qt::DashLine});
  }
}

void Painter::annotations() {
  for (const Annotation& what : m_frame.annotations) {
    const auto layout = layOutAnnotation(what, m_frame, m_camera);
    if (!layout) continue;
    Look look;
    if (what.anchor == AnnotationAnchor::World)
      look = lookOf(visibilityOf(layout->tip, layout->depth), m_frame.display.hidden);
    if (look.drawn || what.id == m_frame.selectedAnnotation) annotation(what, *layout, look);
  }
}

void Painter::residuals() {
  for (const ResidualMark& mark : m_frame.residuals) {
    const glm::dvec2 observed = resultFromRaw(m_frame, m_camera, mark.observedPx);
    const glm::dvec2 projected = resultFromRaw(m_frame, m_camera, mark.projectedPx);
    const glm::dvec2 vector = m_frame.display.residualScale * (projected - observed);
    if (!m_camera.inPicture(observed) || !(glm::length(vector) < 1e5)) continue;
    const QPointF from = point(observed), to = point(observed + vector);
    const double arm = 5 * m_scale;
    QPainterPath cross(from - QPointF(arm, arm));
    cross.lineTo(from + QPointF(arm, arm));
    cross.moveTo(from + QPointF(-arm, arm));
    cross.lineTo(from + QPointF(arm, -arm));
    stroke(cross, Qt::white, 1.4, {});
    const double length = glm::length(vector);
    if (length > 0.5) {
      QPainterPath path(from);
      path.lineTo(to);
      const QPointF back = (from - to) / length * std::min(8 * m_scale, 0.5 * length);
      const QPointF side(-0.5 * back.y(), 0.5 * back.x());
      path.moveTo(to + back + side);
      path.lineTo(to);
      path.lineTo(to + back - side);
      stroke(path, kResidualColour, 1.6, {});
    }
    label(observed, 9 * m_scale, mark.name, false, {}, false);
  }
}

double distanceToSegment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 d = b - a;
  const double length2 = glm::dot(d, d);
  const double t = length2 > 0 ? std::clamp(glm::dot(p - a, d) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p - a - t * d);
}

}  // namespace

void paintAnnotations(OverlayPicture& picture, const FrameDescription& frame, const Camera& scaledCamera, TextSprites& texts) {
  const bool stakes = frame.display.stakePoints && !frame.stakePoints.empty();
  const bool remarks = frame.display.annotations && !frame.annotations.empty();
  if (picture.colour.empty() || (!stakes && !remarks && frame.residuals.empty())) return;
  Painter painter(picture, frame, scaledCamera, texts);
  if (stakes) painter.stakePoints();
  if (remarks) painter.annotations();
  painter.residuals();
}

AnnotationId annotationAt(const FrameDescription& frame, const Camera& scaledCamera,
                          const glm::dvec2& pixel) {
  if (!frame.display.annotations) return {};
  const double reach = 5 * drawingScale(scaledCamera.width(), scaledCamera.height(), frame.enlargement);
  // The last one is painted on top.
  for (auto it = frame.annotations.rbegin(); it != frame.annotations.rend(); ++it) {
    const auto layout = layOutAnnotation(*it, frame, scaledCamera);
    if (!layout) continue;
    if (layout->box.contains(point(pixel))) return it->id;
    const bool hasLine = it->kind != AnnotationKind::Text;
    if (hasLine && distanceToSegment(pixel, layout->tip, layout->tail) <= reach) return it->id;
  }
  return {};
}

}  // namespace alidade

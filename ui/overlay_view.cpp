// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/overlay_view.h"

#include <algorithm>
#include <cmath>

#include <QContextMenuEvent>
#include <QKeyEvent>
#include <QLineEdit>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QWheelEvent>

#include "ui/format.h"
#include "ui/theme.h"
#include "ui/view_tool.h"

namespace alidade {

namespace {

constexpr double kLargestZoom = 64.0;
constexpr int kMargin = 12;

QImage imageOver(const ColourImage& image) {
  if (image.empty()) return {};
  return QImage(reinterpret_cast<const uchar*>(image.data()), image.width(), image.height(),
                image.width() * 4, QImage::Format_RGBX8888);
}

}  // namespace

OverlayView::OverlayView(Session& session, QWidget* parent) : QWidget(parent), m_session(session) {
  setMouseTracking(true);
  setFocusPolicy(Qt::StrongFocus);
  setAttribute(Qt::WA_OpaquePaintEvent);
  setMinimumSize(240, 160);
  setObjectName(QStringLiteral("overlayView"));
  m_sizeTimer.setSingleShot(true);
  m_sizeTimer.setInterval(60);
  connect(&m_sizeTimer, &QTimer::timeout, this, &OverlayView::askForSize);
  m_flashTimer.setSingleShot(true);
  m_flashTimer.setInterval(2600);
  connect(&m_flashTimer, &QTimer::timeout, this, [this] {
    m_flash.clear();
    update();
  });
  connect(&session, &Session::pictureReady, this, &OverlayView::onRendered);
  connect(&session, &Session::structureChanged, this, &OverlayView::onStructure);
  connect(&session, &Session::frameChanged, this, [this] {
    if (rawSize() != m_lastRawSize) onStructure();
    update();
  });
  connect(&session, &Session::beforeShown, this, qOverload<>(&QWidget::update));
  connect(&session, &Session::selectionChanged, this, qOverload<>(&QWidget::update));
}

OverlayView::~OverlayView() = default;

QSize OverlayView::rawSize() const {
  if (const CameraRecord* camera = m_session.currentCamera()) {
    if (camera->camera.width() > 0) return {camera->camera.width(), camera->camera.height()};
  }
  return m_probe.empty() ? QSize() : QSize(m_probe.rawWidth(), m_probe.rawHeight());
}

double OverlayView::fitZoom() const {
  const QSize raw = rawSize();
  if (raw.isEmpty()) return 1.0;
  return std::min(static_cast<double>(width()) / raw.width(), static_cast<double>(height()) / raw.height());
}

QPointF OverlayView::viewFromRaw(const glm::dvec2& raw) const {
  return m_offset + QPointF((raw.x + 0.5) * m_zoom, (raw.y + 0.5) * m_zoom);
}

glm::dvec2 OverlayView::rawFromView(const QPointF& view) const {
  return {(view.x() - m_offset.x()) / m_zoom - 0.5, (view.y() - m_offset.y()) / m_zoom - 0.5};
}

QRectF OverlayView::pictureRect() const {
  const QSize raw = rawSize();
  return {m_offset, QSizeF(raw.width() * m_zoom, raw.height() * m_zoom)};
}

void OverlayView::fit() {
  m_fitted = true;
  m_zoom = fitZoom();
  const QSize raw = rawSize();
  m_offset = QPointF(std::round((width() - raw.width() * m_zoom) / 2),
                     std::round((height() - raw.height() * m_zoom) / 2));
  m_sizeTimer.start();
  emit zoomChanged(m_zoom);
  update();
}

void OverlayView::actualSize() {
  zoomAt(QPointF(width() / 2.0, height() / 2.0), 1.0 / devicePixelRatioF());
}

void OverlayView::zoomBy(double factor) {
  zoomAt(QPointF(width() / 2.0, height() / 2.0), m_zoom * factor);
}

void OverlayView::zoomAt(const QPointF& view, double zoom) {
  if (rawSize().isEmpty()) return;
  zoom = std::clamp(zoom, std::min(fitZoom(), 1.0) * 0.2, kLargestZoom);
  const glm::dvec2 raw = rawFromView(view);
  m_zoom = zoom;
  m_offset = view - QPointF((raw.x + 0.5) * zoom, (raw.y + 0.5) * zoom);
  m_fitted = false;
  m_sizeTimer.start();
  emit zoomChanged(m_zoom);
  update();
}

void OverlayView::askForSize() {
  const QSize raw = rawSize();
  if (raw.isEmpty()) return;
  const double scale = std::min(1.0, m_zoom * devicePixelRatioF());
  m_session.setViewSize(std::max(1, static_cast<int>(std::lround(raw.width() * scale))),
                        std::max(1, static_cast<int>(std::lround(raw.height() * scale))));
}

void OverlayView::onStructure() {
  if (!m_session.rendered()) {
    m_result.reset();
    m_probe = {};
    m_image = {};
  }
  m_lastRawSize = rawSize();
  if (m_lastRawSize.isValid()) {
    fit();
    askForSize();
  }
  update();
}

void OverlayView::onRendered(const std::shared_ptr<const RenderResult>& result) {
  m_result = result;
  m_probe = PictureProbe(result);
  m_image = imageOver(result->frame.picture.colour);
  if (rawSize() != m_lastRawSize) {
    m_lastRawSize = rawSize();
    fit();
  }
  updateCursorReadout();
  update();
}

void OverlayView::setTool(std::unique_ptr<ViewTool> tool) {
  m_tool = std::move(tool);
  if (m_tool) setCursor(m_tool->cursor());
  update();
}

bool OverlayView::escape() {
  if (m_edit) {
    m_edit->setProperty("cancelled", true);
    m_edit->clearFocus();
    return true;
  }
  const bool used = m_tool && m_tool->escape();
  update();
  return used;
}

void OverlayView::setPanHeld(bool held) {
  m_panHeld = held;
  if (held) m_pannedWhileHeld = false;
  if (!held) m_panFrom.reset();
  setCursor(held ? QCursor(Qt::OpenHandCursor) : m_tool ? m_tool->cursor() : QCursor(Qt::ArrowCursor));
}

void OverlayView::flash(const QString& words) {
  m_flash = words;
  m_flashTimer.start();
  update();
}

void OverlayView::updateCursorReadout() {
  m_readout = m_cursorRaw && !m_probe.empty() ? m_probe.readout(*m_cursorRaw) : CursorReadout{};
  emit cursorChanged();
}

void OverlayView::resizeEvent(QResizeEvent*) {
  if (m_fitted) fit();
  if (m_edit) m_edit->clearFocus();
}

void OverlayView::mousePressEvent(QMouseEvent* event) {
  setFocus(Qt::MouseFocusReason);
  const bool pan = event->button() == Qt::MiddleButton || (event->button() == Qt::LeftButton && m_panHeld);
  if (pan) {
    m_panFrom = event->position();
    setCursor(Qt::ClosedHandCursor);
    return;
  }
  if (event->button() == Qt::LeftButton && m_tool && !m_probe.empty()) m_tool->press(*this, *event);
  update();
}

void OverlayView::mouseMoveEvent(QMouseEvent* event) {
  if (m_panFrom) {
    m_offset += event->position() - *m_panFrom;
    m_panFrom = event->position();
    m_fitted = false;
    m_pannedWhileHeld = true;
  } else if (m_tool && !m_probe.empty()) {
    m_tool->move(*this, *event);
  }
  const QRectF picture = pictureRect();
  m_cursorRaw =
      picture.contains(event->position()) ? std::optional(rawFromView(event->position())) : std::nullopt;
  updateCursorReadout();
  update();
}

void OverlayView::mouseReleaseEvent(QMouseEvent* event) {
  if (m_panFrom && (event->button() == Qt::MiddleButton || event->button() == Qt::LeftButton)) {
    m_panFrom.reset();
    setCursor(m_panHeld ? QCursor(Qt::OpenHandCursor) : m_tool ? m_tool->cursor() : QCursor(Qt::ArrowCursor));
    return;
  }
  if (event->button() == Qt::LeftButton && m_tool && !m_probe.empty()) m_tool->release(*this, *event);
  update();
}

void OverlayView::mouseDoubleClickEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton && m_tool && !m_probe.empty()) m_tool->doubleClick(*this, *event);
}

void OverlayView::wheelEvent(QWheelEvent* event) {
  const QPoint angle = event->angleDelta();
  const double slow = event->modifiers() & Qt::ShiftModifier ? 0.25 : 1.0;
  const int turn = angle.y() != 0 ? angle.y() : angle.x();
  zoomAt(event->position(), m_zoom * std::pow(1.2, turn / 120.0 * slow));
  event->accept();
}

void OverlayView::leaveEvent(QEvent*) {
  m_cursorRaw.reset();
  updateCursorReadout();
  update();
}

void OverlayView::contextMenuEvent(QContextMenuEvent* event) {
  if (!m_probe.empty()) emit contextMenuWanted(event->globalPos(), rawFromView(event->pos()));
}

void OverlayView::editText(const QPointF& view, const QString& start,
                           const std::function<void(const QString&)>& done) {
  if (m_edit) m_edit->clearFocus();
  m_edit = new QLineEdit(start, this);
  m_edit->setObjectName(QStringLiteral("annotationText"));
  m_edit->setPlaceholderText(tr("Text, then Enter"));
  m_edit->resize(220, 28);
  const QPointF place(std::clamp(view.x(), 0.0, std::max(0.0, width() - 224.0)),
                      std::clamp(view.y(), 0.0, std::max(0.0, height() - 32.0)));
  m_edit->move(place.toPoint());
  m_edit->show();
  m_edit->setFocus();
  m_edit->selectAll();
  QLineEdit* const edit = m_edit;
  connect(edit, &QLineEdit::returnPressed, edit, &QLineEdit::clearFocus);
  connect(edit, &QLineEdit::editingFinished, this, [this, edit, done] {
    if (m_edit != edit) return;
    m_edit = nullptr;
    const bool cancelled = edit->property("cancelled").toBool();
    const QString typed = edit->text().trimmed();
    edit->deleteLater();
    setFocus();
    if (!cancelled) done(typed);
  });
}

void OverlayView::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), colours().pictureGround);
  if (m_image.isNull()) {
    paintEmpty(painter);
    return;
  }
  const double dpr = devicePixelRatioF();
  QRectF target = pictureRect();
  const bool oneToOne = std::abs(target.width() * dpr - m_image.width()) < 1.0;
  if (oneToOne) {
    // Whole device pixels, so that nothing is resampled.
    target = QRectF(QPointF(std::round(target.x() * dpr) / dpr, std::round(target.y() * dpr) / dpr),
                    QSizeF(m_image.width() / dpr, m_image.height() / dpr));
  }
  painter.setRenderHint(QPainter::SmoothPixmapTransform, !oneToOne && m_zoom * dpr < 4.0);
  painter.drawImage(target, m_image);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setFont(bodyFont());
  if (m_tool) m_tool->paint(*this, painter);
  paintBanners(painter);
}

void OverlayView::paintBanners(QPainter& painter) {
  const QRectF area = QRectF(rect()).adjusted(kMargin, kMargin, -kMargin, -kMargin);
  if (m_tool && !m_tool->hint().isEmpty())
    drawPlate(painter, area, Qt::AlignTop | Qt::AlignLeft, m_tool->hint());
  if (m_result && m_result->problem)
    drawPlate(painter, area, Qt::AlignTop | Qt::AlignHCenter, errorText(*m_result->problem));
  const RenderRequest* request = m_result ? &m_result->request : nullptr;
  if (request && request->rawOnly)
    drawPlate(painter, area, Qt::AlignTop | Qt::AlignRight, tr("Raw picture"));
  else if (request && request->before)
    drawPlate(painter, area, Qt::AlignTop | Qt::AlignRight, tr("Pose before the refinement"));
  else if (request && request->pose)
    drawPlate(painter, area, Qt::AlignTop | Qt::AlignRight,
              tr("Refined pose, not yet accepted. Hold B to compare"));
  if (!m_flash.isEmpty()) drawPlate(painter, area, Qt::AlignBottom | Qt::AlignHCenter, m_flash);
}

void OverlayView::paintEmpty(QPainter& painter) {
  QString words = tr("Loading the picture…");
  if (m_session.project()->frames.empty())
    words = tr("No pictures yet. Drop images or a video here, with the cameras that belong to them");
  painter.setPen(colours().dimText);
  painter.setFont(bodyFont());
  painter.drawText(rect().adjusted(24, 24, -24, -24), Qt::AlignCenter | Qt::TextWordWrap, words);
}

void drawCasedText(QPainter& painter, const QPointF& baseline, const QString& words, const QColor& fill) {
  QPainterPath path;
  path.addText(baseline, painter.font(), words);
  painter.strokePath(path, QPen(QColor(0, 0, 0, 200), 3, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
  painter.fillPath(path, fill);
}

void drawCasedLine(QPainter& painter, const QPointF& a, const QPointF& b, const QColor& fill, double width) {
  painter.setPen(QPen(QColor(0, 0, 0, 180), width + 2.4, Qt::SolidLine, Qt::RoundCap));
  painter.drawLine(a, b);
  painter.setPen(QPen(fill, width, Qt::SolidLine, Qt::RoundCap));
  painter.drawLine(a, b);
}

QRectF drawPlate(QPainter& painter, const QRectF& area, Qt::Alignment alignment, const QString& words) {
  painter.setFont(bodyFont());
  const int flags = Qt::TextWordWrap | Qt::AlignLeft;
  QRectF box = painter.boundingRect(area.adjusted(10, 5, -10, -5), flags, words);
  const QSizeF size(box.width() + 20, box.height() + 10);
  double x = area.left(), y = area.top();
  if (alignment & Qt::AlignHCenter) x = area.center().x() - size.width() / 2;
  if (alignment & Qt::AlignRight) x = area.right() - size.width();
  if (alignment & Qt::AlignBottom) y = area.bottom() - size.height();
  const QRectF plate(QPointF(std::round(x), std::round(y)), size);
  painter.setPen(Qt::NoPen);
  painter.setBrush(QColor(16, 16, 16, 215));
  painter.drawRoundedRect(plate, 4, 4);
  painter.setPen(QColor(240, 240, 240));
  painter.drawText(plate.adjusted(10, 5, -10, -5), flags, words);
  return plate;
}

}  // namespace alidade

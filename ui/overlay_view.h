// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <optional>

#include <QImage>
#include <QTimer>
#include <QWidget>

#include "ui/picture_probe.h"
#include "ui/session.h"

class QLineEdit;

namespace alidade {

class ViewTool;

/// Paints the rendered picture and lets it be zoomed, panned and worked on with the current tool.
/// Asks for the picture at the size it is shown, so that lines and text are crisp; while a better one
/// is on its way the last one is shown scaled.
///
/// "Raw" is the raw picture's pixel (OpenCV's origin), "view" a position in the widget.
class OverlayView : public QWidget {
  Q_OBJECT

 public:
  explicit OverlayView(Session& session, QWidget* parent = nullptr);
  ~OverlayView() override;

  Session& session() { return m_session; }
  const PictureProbe& probe() const { return m_probe; }

  double zoom() const { return m_zoom; }  ///< screen pixels a raw pixel
  bool fitted() const { return m_fitted; }
  void fit();
  void actualSize();
  void zoomBy(double factor);
  void zoomAt(const QPointF& view, double zoom);
  QPointF viewFromRaw(const glm::dvec2& raw) const;
  glm::dvec2 rawFromView(const QPointF& view) const;
  QRectF pictureRect() const;

  void setTool(std::unique_ptr<ViewTool> tool);
  ViewTool* tool() const { return m_tool.get(); }
  /// Esc: true where the tool had something to give up.
  bool escape();
  void setPanHeld(bool held);  ///< Space
  bool panned() const { return m_pannedWhileHeld; }

  /// A line edit at a place in the picture; `done` gets the text unless Esc closed it.
  void editText(const QPointF& view, const QString& start, const std::function<void(const QString&)>& done);
  bool editing() const { return m_edit != nullptr; }
  void flash(const QString& words);  ///< a hint that goes away by itself
  std::optional<glm::dvec2> cursorRaw() const { return m_cursorRaw; }
  const CursorReadout& cursorReadout() const { return m_readout; }

 signals:
  void cursorChanged();
  void contextMenuWanted(const QPoint& globalPosition, const glm::dvec2& raw);
  void zoomChanged(double zoom);
  void wheelZoomed();

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void leaveEvent(QEvent* event) override;
  void contextMenuEvent(QContextMenuEvent* event) override;

 private:
  void onRendered(const std::shared_ptr<const RenderResult>& result);
  void onStructure();
  QSize rawSize() const;
  double fitZoom() const;
  void askForSize();
  void updateCursorReadout();
  void paintEmpty(QPainter& painter);
  void paintBanners(QPainter& painter);

  Session& m_session;
  std::shared_ptr<const RenderResult> m_result;
  PictureProbe m_probe;
  QImage m_image;  ///< of m_result, not copied
  QSize m_lastRawSize;
  double m_zoom = 1.0;
  QPointF m_offset;  ///< view position of the picture's top-left corner
  bool m_fitted = true;
  std::unique_ptr<ViewTool> m_tool;
  std::optional<QPointF> m_panFrom;
  bool m_panHeld = false, m_pannedWhileHeld = false;
  std::optional<glm::dvec2> m_cursorRaw;
  CursorReadout m_readout;
  QTimer m_sizeTimer, m_flashTimer;
  QString m_flash;
  QLineEdit* m_edit = nullptr;
};

/// Dark text casing and light fill (or the other way round), readable over soil and sky.
void drawCasedText(QPainter& painter, const QPointF& baseline, const QString& text, const QColor& fill);
void drawCasedLine(QPainter& painter, const QPointF& a, const QPointF& b, const QColor& fill,
                   double width = 1.6);
/// A line of text on a dark plate, inside `area`; returns the plate's rectangle.
QRectF drawPlate(QPainter& painter, const QRectF& area, Qt::Alignment alignment, const QString& text);

}  // namespace alidade

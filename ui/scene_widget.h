// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <optional>

#include <QOpenGLWidget>
#include <QTimer>

#include "scene/site_view.h"
#include "ui/session.h"

namespace alidade {

/// The site in 3D, hosting scene/'s view in a QOpenGLWidget. Left orbits about what was clicked and,
/// without a drag, selects; middle or Shift+left pans; the wheel zooms at the cursor.
///
/// Nothing is handed to the view before the widget is first shown: a window that only ever shows
/// pictures pays nothing for it.
class SceneWidget : public QOpenGLWidget {
  Q_OBJECT

 public:
  explicit SceneWidget(Session& session, QWidget* parent = nullptr);
  ~SceneWidget() override;

  void fitAll();
  void lookFromFrame();
  std::optional<ScenePick> pickAt(const QPointF& position) const;

 signals:
  void contextMenuWanted(const QPoint& globalPosition);
  /// A point of the scan was clicked.
  void pointPicked(const glm::dvec3& world);

 protected:
  void initializeGL() override;
  void resizeGL(int width, int height) override;
  void paintGL() override;
  void showEvent(QShowEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;

 private:
  void releaseContext();
  void updateAll();
  void updateDesigns();
  void updateFrames();
  void updateCloudDisplay();
  void updateSelection();
  void refresh();
  void stopMovingSoon();
  glm::dvec2 devicePixels(const QPointF& position) const;

  Session& m_session;
  std::unique_ptr<SiteView> m_view;
  QTimer m_still;
  QPointF m_pressed, m_last;
  Qt::MouseButton m_button = Qt::NoButton;
  bool m_dragged = false, m_shown = false, m_painting = false, m_fitDue = false, m_stale = true;
  const LoadedData* m_framedData = nullptr;  ///< what was last fitted to; compared, never read
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/scene_widget.h"

#include <cmath>

#include <QMouseEvent>
#include <QOpenGLContext>
#include <QWheelEvent>

namespace alidade {

SceneWidget::SceneWidget(Session& session, QWidget* parent)
    : QOpenGLWidget(parent), m_session(session), m_view(std::make_unique<SiteView>()) {
  setObjectName(QStringLiteral("sceneWidget"));
  setFocusPolicy(Qt::StrongFocus);
  setMinimumSize(200, 160);
  m_still.setSingleShot(true);
  m_still.setInterval(180);
  connect(&m_still, &QTimer::timeout, this, [this] {
    m_view->setMoving(false);
    refresh();
  });
  connect(&session, &Session::structureChanged, this, &SceneWidget::updateAll);
  connect(&session, &Session::dataChanged, this, &SceneWidget::updateAll);
  connect(&session, &Session::projectChanged, this, [this] {
    updateDesigns();
    updateFrames();
  });
  connect(&session, &Session::displayChanged, this, &SceneWidget::updateCloudDisplay);
  connect(&session, &Session::selectionChanged, this, &SceneWidget::updateSelection);
  connect(&session, &Session::frameChanged, this, [this] {
    m_view->setCurrentFrame(m_session.frame());
    refresh();
  });
}

SceneWidget::~SceneWidget() {
  // The context outlives this object's own parts for a moment: nothing may call back by then.
  if (QOpenGLContext* own = context()) disconnect(own, nullptr, this, nullptr);
  releaseContext();
}

void SceneWidget::initializeGL() {
  connect(context(), &QOpenGLContext::aboutToBeDestroyed, this, &SceneWidget::releaseContext,
          Qt::DirectConnection);
  m_view->attach({[this] { makeCurrent(); },
                  [this] { return context() && QOpenGLContext::currentContext() == context(); }});
}

void SceneWidget::releaseContext() {
  if (!context()) return;
  makeCurrent();
  m_view->release();
  doneCurrent();
}

void SceneWidget::resizeGL(int, int) {
  const double ratio = devicePixelRatioF();
  m_view->resize(static_cast<int>(std::lround(width() * ratio)),
                 static_cast<int>(std::lround(height() * ratio)), ratio);
}

void SceneWidget::paintGL() {
  // VTK's render events may end in update(); a picture that asks for the next one would never rest.
  m_painting = true;
  if (std::exchange(m_fitDue, false)) m_view->fitAll();  // only now is the size known
  m_view->paint(defaultFramebufferObject());
  m_painting = false;
}

void SceneWidget::refresh() {
  if (!m_painting && m_shown) update();
}

void SceneWidget::showEvent(QShowEvent* event) {
  m_shown = true;
  if (m_stale) updateAll();
  QOpenGLWidget::showEvent(event);
}

void SceneWidget::updateAll() {
  m_stale = true;
  if (!m_shown) return;
  m_stale = false;
  const LoadedData& data = *m_session.data();
  std::vector<ScanPoints> clouds;
  for (const auto& [id, parts] : data.scans)
    for (const ScanLayer& part : parts) clouds.push_back(part.points);
  m_view->setDisplay(m_session.display());
  m_view->setClouds(clouds);
  m_view->setStakePoints(m_session.project()->stakePoints);
  updateDesigns();
  updateFrames();
  updateSelection();
  if (m_framedData != &data && !(data.scans.empty() && data.designs.empty())) {
    m_framedData = &data;
    m_fitDue = true;
  }
  refresh();
}

void SceneWidget::updateDesigns() {
  if (!m_shown) return;
  std::vector<SceneDesign> designs;
  for (const auto& [id, model] : m_session.data()->designs) {
    if (!m_session.designVisible(id)) continue;
    SceneDesign design{id, model, {}};
    for (std::size_t i = 0; i < model->elements.size(); ++i)
      design.elementVisible.push_back(m_session.elementVisible(id, static_cast<int>(i)) ? 1 : 0);
    designs.push_back(std::move(design));
  }
  m_view->setDesigns(designs);
  refresh();
}

void SceneWidget::updateFrames() {
  if (!m_shown) return;
  const Project& project = *m_session.project();
  std::vector<SceneFrustum> frusta;
  for (const Frame& frame : project.frames) {
    const CameraRecord* camera = project.findCamera(frame.camera);
    if (frame.cameraFromWorld && camera) frusta.push_back({frame.id, *frame.cameraFromWorld, camera->camera});
  }
  m_view->setFrames(frusta);
  m_view->setCurrentFrame(m_session.frame());
  refresh();
}

void SceneWidget::updateCloudDisplay() {
  if (!m_shown) return;
  m_view->setDisplay(m_session.display());
  refresh();
}

void SceneWidget::updateSelection() {
  if (!m_shown) return;
  m_view->setSelectedElement(m_session.selection().design, m_session.selection().element);
  m_view->setSelectedStakePoint(m_session.selection().stakePoint);
  refresh();
}

void SceneWidget::fitAll() {
  m_view->fitAll();
  refresh();
}

void SceneWidget::lookFromFrame() {
  m_view->lookFromFrame(m_session.frame());
  refresh();
}

glm::dvec2 SceneWidget::devicePixels(const QPointF& position) const {
  return glm::dvec2(position.x(), position.y()) * static_cast<double>(devicePixelRatioF());
}

std::optional<ScenePick> SceneWidget::pickAt(const QPointF& position) const {
  return m_view->pick(devicePixels(position));
}

void SceneWidget::stopMovingSoon() {
  m_view->setPace(m_session.pace());
  m_view->setMoving(true);
  m_still.start();
}

void SceneWidget::mousePressEvent(QMouseEvent* event) {
  setFocus(Qt::MouseFocusReason);
  m_button = event->button();
  m_pressed = m_last = event->position();
  m_dragged = false;
  m_view->beginDrag(devicePixels(event->position()));
}

void SceneWidget::mouseMoveEvent(QMouseEvent* event) {
  if (m_button == Qt::NoButton) return;
  if (!m_dragged && (event->position() - m_pressed).manhattanLength() < 4) return;
  m_dragged = true;
  const glm::dvec2 delta = devicePixels(event->position() - m_last);
  m_last = event->position();
  stopMovingSoon();
  const bool pan = m_button == Qt::MiddleButton || (event->modifiers() & Qt::ShiftModifier);
  if (pan)
    m_view->pan(delta);
  else if (m_button == Qt::LeftButton)
    m_view->orbit(delta);
  refresh();
}

void SceneWidget::mouseReleaseEvent(QMouseEvent* event) {
  const Qt::MouseButton button = std::exchange(m_button, Qt::NoButton);
  if (m_dragged) {
    m_view->setMoving(false);
    refresh();
    return;
  }
  const auto hit = m_view->pick(devicePixels(event->position()));
  if (button == Qt::LeftButton || button == Qt::RightButton) {
    SelectionState selection;
    if (hit && hit->element >= 0) selection.design = hit->design, selection.element = hit->element;
    if (hit) selection.stakePoint = hit->stakePoint;
    m_session.select(selection);
    const bool scanPoint = hit && hit->element < 0 && hit->stakePoint.empty() && !hit->frame;
    if (scanPoint && button == Qt::LeftButton) emit pointPicked(hit->world);
  }
  if (button == Qt::RightButton) emit contextMenuWanted(event->globalPosition().toPoint());
}

void SceneWidget::mouseDoubleClickEvent(QMouseEvent* event) {
  const auto hit = m_view->pick(devicePixels(event->position()));
  if (hit && hit->frame) m_session.setFrame(hit->frame);
}

void SceneWidget::wheelEvent(QWheelEvent* event) {
  stopMovingSoon();
  m_view->zoomAt(devicePixels(event->position()), std::pow(1.2, event->angleDelta().y() / 120.0));
  refresh();
  event->accept();
}

}  // namespace alidade

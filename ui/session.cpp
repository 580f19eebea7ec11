// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/session.h"

#include <algorithm>
#include <utility>

#include <QSettings>

#include "ui/format.h"
#include "ui/project_change.h"

namespace alidade {

Session::Session(QObject* parent)
    : QObject(parent), m_project(std::make_shared<Project>()), m_data(std::make_shared<LoadedData>()) {
  connect(&m_render, &RenderLoop::finished, this, &Session::onRendered, Qt::QueuedConnection);
  connect(&m_render, &RenderLoop::failed, this, &Session::onFailed, Qt::QueuedConnection);
  connect(&m_render, &RenderLoop::deviceFailed, this,
          [this](const Error& error) { m_messages.error(error); });
  connect(&m_undo, &QUndoStack::cleanChanged, this, &Session::modifiedChanged);
  const QSettings settings;
  m_pace.frameTimeMs = settings.value(QStringLiteral("frameTimeMs"), m_pace.frameTimeMs).toDouble();
  m_pace.selectionAgeMs = settings.value(QStringLiteral("selectionAgeMs"), m_pace.selectionAgeMs).toDouble();
  m_pace.mostPoints = settings.value(QStringLiteral("mostPoints"), QVariant::fromValue<qulonglong>(m_pace.mostPoints)).toULongLong();
  m_settle.setSingleShot(true);
  m_settle.setInterval(120);
  connect(&m_settle, &QTimer::timeout, this, [this] {
    m_dragging = false;
    requestRender();
  });
}

Session::~Session() {
  // Nobody is to be told of a session that is half gone.
  for (QObject* part :
       {static_cast<QObject*>(this), static_cast<QObject*>(&m_undo), static_cast<QObject*>(&m_messages),
        static_cast<QObject*>(&m_jobs), static_cast<QObject*>(&m_render)})
    part->disconnect();
  m_jobs.cancelAll();
}

int Session::frameIndex() const {
  const auto& frames = m_project->frames;
  const auto it = std::find_if(frames.begin(), frames.end(), [&](const Frame& f) { return f.id == m_frame; });
  return it == frames.end() ? -1 : static_cast<int>(it - frames.begin());
}

const Frame* Session::currentFrame() const {
  return m_project->findFrame(m_frame);
}

const Frame* Session::shownFrame() const {
  return m_candidate && !m_showBefore ? &*m_candidate : currentFrame();
}

const CameraRecord* Session::currentCamera() const {
  const Frame* frame = currentFrame();
  return frame ? m_project->findCamera(frame->camera) : nullptr;
}

Project Session::projectToSave() const {
  Project project = *m_project;
  project.display = m_display;
  return project;
}

void Session::setProject(Project project, bool unsaved) {
  m_display = project.display;
  m_project = std::make_shared<Project>(std::move(project));
  m_data = std::make_shared<LoadedData>();
  m_selection = {};
  m_candidate.reset();
  m_dragStart.reset();
  m_showBefore = false;
  m_rendered.reset();
  m_lastRenderError.clear();
  m_hasProject = true;
  m_unsaved = unsaved;
  m_displayUnsaved = false;
  m_undo.clear();
  m_render.dropPictures();
  // The first frame that has a pose shows the design at once; without one, the first picture.
  const auto& frames = m_project->frames;
  const auto posed =
      std::find_if(frames.begin(), frames.end(), [](const Frame& f) { return f.cameraFromWorld; });
  m_frame = posed != frames.end() ? posed->id : frames.empty() ? FrameId{} : frames.front().id;
  emit projectOpened();
  emit structureChanged();
  emit projectChanged();
  emit dataChanged();
  emit displayChanged();
  emit selectionChanged();
  emit frameChanged();
  emit modifiedChanged();
  requestRender();
}

void Session::closeProject() {
  setProject(Project{}, false);
  m_hasProject = false;
  emit structureChanged();
  emit modifiedChanged();
}

void Session::replaceProject(Project project) {
  m_project = std::make_shared<Project>(std::move(project));
  m_undo.clear();
  m_unsaved = true;
  if (!currentFrame()) {
    m_frame = m_project->frames.empty() ? FrameId{} : m_project->frames.front().id;
    emit frameChanged();
  }
  emit structureChanged();
  emit projectChanged();
  emit modifiedChanged();
  requestRender();
}

void Session::setData(LoadedData data) {
  m_data = std::make_shared<LoadedData>(std::move(data));
  emit dataChanged();
  requestRender();
}

void Session::markSaved(const std::string& path) {
  if (m_project->path != path) {
    auto project = std::make_shared<Project>(*m_project);
    project->path = path;
    m_project = std::move(project);
  }
  m_unsaved = false;
  m_displayUnsaved = false;
  m_undo.setClean();
  emit projectChanged();
  emit modifiedChanged();
}

bool Session::modified() const {
  return m_hasProject && (m_displayUnsaved || workUnsaved());
}

void Session::change(const QString& name, const std::function<void(Project&)>& edit) {
  auto after = std::make_shared<Project>(*m_project);
  edit(*after);
  m_undo.push(new ProjectChange(*this, name, m_project, std::move(after)));
}

void Session::dragChange(const std::function<void(Project&)>& edit) {
  if (!m_dragStart) m_dragStart = m_project;
  auto after = std::make_shared<Project>(*m_project);
  edit(*after);
  keepMoving();
  restore(std::move(after));
}

void Session::commitDrag(const QString& name) {
  if (!m_dragStart) return;
  const auto before = std::exchange(m_dragStart, nullptr);
  m_undo.push(new ProjectChange(*this, name, before, m_project));
}

void Session::cancelDrag() {
  if (m_dragStart) restore(std::exchange(m_dragStart, nullptr));
}

void Session::restore(std::shared_ptr<const Project> snapshot) {
  // Where the file lies is no part of the work that is undone.
  if (snapshot->path != m_project->path) {
    auto moved = std::make_shared<Project>(*snapshot);
    moved->path = m_project->path;
    snapshot = std::move(moved);
  }
  m_project = std::move(snapshot);
  emit projectChanged();
  requestRender();
}

void Session::setDisplay(const DisplaySettings& display, bool dragging) {
  m_display = display;
  m_displayUnsaved = true;
  if (dragging) keepMoving();
  emit displayChanged();
  emit modifiedChanged();
  requestRender();
}

void Session::setPace(const FramePace& pace) {
  m_pace = pace;
  QSettings settings;
  settings.setValue(QStringLiteral("frameTimeMs"), pace.frameTimeMs);
  settings.setValue(QStringLiteral("selectionAgeMs"), pace.selectionAgeMs);
  settings.setValue(QStringLiteral("mostPoints"), QVariant::fromValue<qulonglong>(pace.mostPoints));
}

void Session::select(const SelectionState& selection) {
  if (selection == m_selection) return;
  m_selection = selection;
  emit selectionChanged();
  requestRender();
}

void Session::setFrame(FrameId frame) {
  if (frame == m_frame || !m_project->findFrame(frame)) return;
  m_frame = frame;
  m_candidate.reset();
  m_showBefore = false;
  emit frameChanged();
  requestRender();
}

void Session::setFrameIndex(int index) {
  const int count = static_cast<int>(m_project->frames.size());
  if (count == 0) return;
  setFrame(m_project->frames[static_cast<std::size_t>(std::clamp(index, 0, count - 1))].id);
}

void Session::stepFrames(int by) {
  if (const int index = frameIndex(); index >= 0) setFrameIndex(index + by);
}

const DesignModel* Session::model(DesignId design) const {
  const auto it = m_data->designs.find(design);
  return it == m_data->designs.end() ? nullptr : it->second.get();
}

bool Session::designVisible(DesignId id) const {
  for (const Design& design : m_project->designs)
    if (design.id == id) return design.visible;
  return false;
}

bool Session::elementVisible(DesignId id, int element) const {
  const DesignModel* loaded = model(id);
  if (!loaded || element < 0 || element >= static_cast<int>(loaded->elements.size())) return false;
  const std::string& globalId = loaded->elements[static_cast<std::size_t>(element)].globalId;
  for (const Design& design : m_project->designs) {
    if (design.id != id) continue;
    return design.visible && std::find(design.hiddenElements.begin(), design.hiddenElements.end(),
                                       globalId) == design.hiddenElements.end();
  }
  return false;
}

void Session::setElementsVisible(const QString& name, DesignId id, const std::vector<int>& elements,
                                 bool visible) {
  const DesignModel* loaded = model(id);
  if (!loaded) return;
  change(name, [&](Project& project) {
    for (Design& design : project.designs) {
      if (design.id != id) continue;
      for (const int element : elements) {
        const std::string& globalId = loaded->elements[static_cast<std::size_t>(element)].globalId;
        std::erase(design.hiddenElements, globalId);
        if (!visible) design.hiddenElements.push_back(globalId);
      }
      if (visible) design.visible = true;
    }
  });
}

void Session::setRawOnly(bool on) {
  if (std::exchange(m_rawOnly, on) != on) requestRender();
}

void Session::setResidualsShown(bool on) {
  if (std::exchange(m_residuals, on) != on) requestRender();
}

void Session::setCandidate(std::optional<Frame> frame) {
  const bool was = m_candidate.has_value();
  m_candidate = std::move(frame);
  if (was || m_candidate) emit shownPoseChanged();
  requestRender();
}

bool Session::canShowBefore() const {
  const Frame* frame = currentFrame();
  return frame && (m_candidate || frame->originalCameraFromWorld);
}

void Session::setShowBefore(bool on) {
  if (on && !canShowBefore()) return;
  if (std::exchange(m_showBefore, on) == on) return;
  emit beforeShown(on);
  emit shownPoseChanged();
  requestRender();
}

void Session::setViewSize(int width, int height) {
  if (width == m_width && height == m_height) return;
  m_width = width;
  m_height = height;
  requestRender();
}

void Session::keepMoving() {
  m_dragging = true;
  m_settle.start();
}

void Session::requestRender() {
  if (m_requestDue) return;
  m_requestDue = true;  // several changes in one event make one request
  QMetaObject::invokeMethod(this, &Session::sendRequest, Qt::QueuedConnection);
}

RenderRequest Session::requestOf(const Frame& frame) {
  RenderRequest request;
  request.project = m_project;
  request.data = m_data;
  request.display = m_display;
  request.frame = frame.id;
  request.selection = m_selection;
  request.rawOnly = m_rawOnly;
  request.residuals = m_residuals;
  request.width = m_width;
  request.height = m_height;
  return request;
}

void Session::sendRequest() {
  m_requestDue = false;
  const Frame* frame = currentFrame();
  if (!frame || m_playing) return;
  RenderRequest request = requestOf(*frame);
  if (m_showBefore)
    request.pose = m_candidate ? frame->cameraFromWorld : frame->originalCameraFromWorld;
  else
    request.pose = m_candidate ? m_candidate->cameraFromWorld : std::nullopt;
  request.before = m_showBefore;
  if (m_dragging) request.pace = m_pace;
  if (request.pace && m_pace.frameTimeMs > 0 && m_renderMs > m_pace.frameTimeMs && m_width > 0) {
    request.shrink = 2;
    request.width = std::max(1, m_width / request.shrink);
    request.height = std::max(1, m_height / request.shrink);
  }
  ++m_requestsSent;
  request.serial = m_requestsSent;
  m_render.request(std::move(request));
}

void Session::setPlaying(bool on) {
  if (std::exchange(m_playing, on) == on || on) return;
  m_render.dropPlayed();
  emit frameChanged();  // for those that kept still meanwhile
  requestRender();
}

void Session::requestPlayed(int index, const std::vector<int>& next, int run, int shrink) {
  const auto& frames = m_project->frames;
  if (index < 0 || index >= static_cast<int>(frames.size())) return;
  RenderRequest request = requestOf(frames[static_cast<std::size_t>(index)]);
  request.played = true;
  request.run = run;
  // A played frame has the camera's step; what the user set for dragging is the least.
  request.pace = m_pace;
  if (m_pace.frameTimeMs > 0) request.pace->frameTimeMs = std::max(m_pace.frameTimeMs, 55.0);
  // Even sizes, so that what hides the design may be judged on half of them.
  const CameraRecord* camera = m_project->findCamera(frames[static_cast<std::size_t>(index)].camera);
  if (request.width == 0 && camera) request.width = camera->camera.width(), request.height = camera->camera.height();
  request.width = request.width / shrink & ~1, request.height = request.height / shrink & ~1;
  request.shrink = shrink;
  for (const int i : next)
    if (i >= 0 && i < static_cast<int>(frames.size())) request.next.push_back(frames[static_cast<std::size_t>(i)].id);
  request.serial = m_requestsSent;
  m_render.request(std::move(request));
}

void Session::showPlayed(const std::shared_ptr<const RenderResult>& result) {
  if (!m_project->findFrame(result->request.frame)) return;
  m_frame = result->request.frame;
  m_candidate.reset();
  m_showBefore = false;
  m_rendered = result;
  emit frameChanged();
  emit pictureReady(result);
}

bool Session::upToDate() const {
  return !m_requestDue && !m_settle.isActive() && m_requestsAnswered == m_requestsSent && !m_render.busy();
}

void Session::onRendered(const std::shared_ptr<const RenderResult>& result) {
  m_requestsAnswered = result->request.serial;
  if (result->request.played) {
    if (m_playing && result->request.project == m_project) emit playedReady(result);
    return;
  }
  const std::string problem = result->problem ? result->problem->text() : std::string();
  if (!problem.empty() && problem != m_lastRenderError) m_messages.error(*result->problem);
  m_lastRenderError = problem;
  if (result->request.frame != m_frame && !result->request.project->findFrame(m_frame))
    return;  // a closed project
  m_rendered = result;
  if (!result->request.pace) m_renderMs = result->renderMs;
  emit pictureReady(result);
}

void Session::onFailed(FrameId frame, quint64 serial, const Error& error) {
  m_requestsAnswered = serial;
  if (m_playing) {
    m_messages.error(error);
    emit playedFailed();
    return;
  }
  if (frame != m_frame) return;
  // The same trouble again and again, while a slider moves, is one message.
  if (error.text() != m_lastRenderError) m_messages.error(error);
  m_lastRenderError = error.text();
  emit renderFailed(error);
}

}  // namespace alidade

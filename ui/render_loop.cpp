// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/render_loop.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace alidade {

namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

RenderLoop::RenderLoop(QObject* parent) : QObject(parent), m_pictures(12) {
  qRegisterMetaType<std::shared_ptr<const RenderResult>>();
  qRegisterMetaType<Error>("alidade::Error");
  qRegisterMetaType<FrameId>("alidade::FrameId");
  m_thread = std::thread([this] { loop(); });
}

RenderLoop::~RenderLoop() {
  {
    const std::lock_guard lock(m_mutex);
    m_stop = true;
  }
  m_wake.notify_all();
  m_thread.join();
}

void RenderLoop::request(RenderRequest request) {
  {
    const std::lock_guard lock(m_mutex);
    if (request.played) m_played.push_back(std::move(request));
    else m_waiting = std::move(request);
  }
  m_wake.notify_all();
}

bool RenderLoop::busy() const {
  const std::lock_guard lock(m_mutex);
  return m_rendering || m_waiting.has_value() || !m_played.empty();
}

void RenderLoop::dropPlayed() {
  const std::lock_guard lock(m_mutex);
  m_played.clear();
}

void RenderLoop::runOnThread(std::function<void(OverlayRenderer&, PictureCache&)> task) {
  {
    const std::lock_guard lock(m_mutex);
    m_tasks.push_back(std::move(task));
  }
  m_wake.notify_all();
}

void RenderLoop::dropPictures() {
  m_pictures.clear();
}

void RenderLoop::loop() {
  auto renderer = OverlayRenderer::create();
  if (!renderer) {
    emit deviceFailed(renderer.error());
  } else {
    emit deviceReady(QString::fromStdString((*renderer)->deviceName()));
  }
  std::unique_lock lock(m_mutex);
  while (true) {
    m_wake.wait(lock, [this] { return m_stop || m_waiting || !m_tasks.empty() || !m_played.empty(); });
    if (m_stop) return;
    m_rendering = true;
    if (!m_tasks.empty()) {
      auto task = std::move(m_tasks.front());
      m_tasks.pop_front();
      lock.unlock();
      if (renderer) task(**renderer, m_pictures);
    } else {
      const RenderRequest request = m_waiting ? *std::exchange(m_waiting, std::nullopt) : std::move(m_played.front());
      if (request.played) m_played.pop_front();
      lock.unlock();
      if (renderer) render(**renderer, request);
    }
    lock.lock();
    m_rendering = false;
  }
}

void RenderLoop::render(OverlayRenderer& renderer, const RenderRequest& request) {
  auto result = std::make_shared<RenderResult>();
  result->request = request;
  const Project& project = *request.project;
  const Frame* frame = project.findFrame(request.frame);
  if (!frame) return;

  const auto start = Clock::now();
  auto picture = m_pictures.picture(project, *frame);
  if (!request.next.empty()) m_pictures.expect(project, request.next);
  result->decodeMs = millisecondsSince(start);
  if (!picture) {
    emit failed(request.frame, request.serial, picture.error());
    return;
  }
  auto description = describeFrame(project, *request.data, request.frame, *picture, request.selection, request.pose);
  if (!description) {
    // A picture without a pose is still worth looking at.
    result->problem = description.error();
    result->frame.description.image = *picture;
    result->frame.picture.colour = **picture;
    emit finished(result);
    return;
  }
  description->display = request.display;
  if (request.played) allowForPlaying(*description);
  description->width = request.width;
  description->height = request.height;
  description->enlargement = request.shrink;
  if (!request.residuals) description->residuals.clear();
  if (request.rawOnly) {
    description->designs.clear();
    description->scans.clear();
    description->stakePoints.clear();
    description->annotations.clear();
    description->residuals.clear();
  }
  const auto drawing = Clock::now();
  description->pointBudget = m_pacer.begin(request.pace);
  description->selectionAgeMs = request.pace ? request.pace->selectionAgeMs : 0;
  auto rendered = renderer.render(*description);
  result->renderMs = millisecondsSince(drawing);
  if (!rendered) {
    emit failed(request.frame, request.serial, rendered.error());
    return;
  }
  m_pacer.end(std::max(rendered->pointsJudged, rendered->pointsDrawn));
  result->frame.poseQuality = frame->quality;
  result->frame.scanSpacingM = scanSpacing(*description);
  result->frame.description = std::move(*description);
  result->frame.picture = std::move(*rendered);
  emit finished(result);
}

}  // namespace alidade

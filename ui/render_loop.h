// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include <QObject>

#include "app/jobs.h"
#include "app/workspace.h"
#include "cloud/frame_pacer.h"

namespace alidade {

/// Everything one picture depends on: immutable, so that the GUI thread may go on changing its own.
struct RenderRequest {
  std::shared_ptr<const Project> project;
  std::shared_ptr<const LoadedData> data;
  DisplaySettings display;
  FrameId frame;
  SelectionState selection;
  std::optional<RigidTransform> pose;  ///< instead of the frame's own, while a refinement is judged
  bool before = false;                 ///< `pose` is the one before the refinement
  bool rawOnly = false;                ///< the picture as the camera saw it
  bool residuals = true;
  int width = 0, height = 0;  ///< of the result; 0: the raw picture's
  quint64 serial = 0;         ///< counts requests; a later one wins
  std::optional<FramePace> pace;  ///< something is being dragged or played: in time before complete
  int shrink = 1;             ///< a draft is drawn so many times smaller than it is shown
  /// Of a video being played: waits for its turn instead of replacing what waits, and is drawn as playing allows.
  bool played = false;
  int run = 0;  ///< the playing that it belongs to
  std::vector<FrameId> next;  ///< pictures to be decoded meanwhile
};

struct RenderResult {
  RenderRequest request;
  RenderedFrame frame;
  std::optional<Error> problem;  ///< why only the raw picture is shown: no pose, no camera
  double decodeMs = 0, renderMs = 0;
};

/// The thread that renders. Latest wins: a request made while another is being rendered replaces the one that waits;
/// only played frames queue up behind each other. Owns the renderer, so that its device is also made off the GUI thread.
class RenderLoop : public QObject {
  Q_OBJECT

 public:
  explicit RenderLoop(QObject* parent = nullptr);
  ~RenderLoop() override;

  void request(RenderRequest request);
  bool busy() const;
  /// Forgets played frames that wait.
  void dropPlayed();
  /// Runs on the render thread, before any waiting request: exports share the one device.
  void runOnThread(std::function<void(OverlayRenderer&, PictureCache&)> task);
  void dropPictures();

 signals:
  void finished(std::shared_ptr<const alidade::RenderResult> result);
  void failed(alidade::FrameId frame, quint64 serial, const alidade::Error& error);
  void deviceReady(const QString& name);
  void deviceFailed(const alidade::Error& error);

 private:
  void loop();
  void render(OverlayRenderer& renderer, const RenderRequest& request);

  PictureCache m_pictures;
  FramePacer m_pacer;  ///< of the render thread
  mutable std::mutex m_mutex;
  std::condition_variable m_wake;
  std::optional<RenderRequest> m_waiting;
  std::deque<RenderRequest> m_played;
  std::deque<std::function<void(OverlayRenderer&, PictureCache&)>> m_tasks;
  bool m_rendering = false;
  bool m_stop = false;
  std::thread m_thread;
};

}  // namespace alidade

Q_DECLARE_METATYPE(std::shared_ptr<const alidade::RenderResult>)

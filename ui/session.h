// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <memory>
#include <optional>

#include <QObject>
#include <QString>
#include <QTimer>
#include <QUndoStack>

#include "app/workspace.h"
#include "ui/job_list.h"
#include "ui/message_list.h"
#include "ui/render_loop.h"

namespace alidade {

/// What the window is about: the project, its loaded data, the current frame, what is selected, how
/// it is shown. Widgets ask it and change it; none of them keeps any of this. Lives on the GUI thread;
/// the project and the data are immutable snapshots that workers may hold.
///
/// Undo covers what belongs to the work (show and hide, annotations, poses); how things are displayed
/// changes without a trace in it.
class Session : public QObject {
  Q_OBJECT

 public:
  explicit Session(QObject* parent = nullptr);
  ~Session() override;

  bool hasProject() const { return m_hasProject; }
  const std::shared_ptr<const Project>& project() const { return m_project; }
  const std::shared_ptr<const LoadedData>& data() const { return m_data; }
  const DisplaySettings& display() const { return m_display; }
  const FramePace& pace() const { return m_pace; }
  const SelectionState& selection() const { return m_selection; }
  FrameId frame() const { return m_frame; }
  int frameIndex() const;  ///< in Project::frames; -1: none
  const Frame* currentFrame() const;
  const CameraRecord* currentCamera() const;
  /// The project with the display settings in force, as it is saved.
  Project projectToSave() const;

  QUndoStack& undo() { return m_undo; }
  JobList& jobs() { return m_jobs; }
  MessageList& messages() { return m_messages; }
  RenderLoop& renderLoop() { return m_render; }

  void setProject(Project project, bool unsaved);
  void closeProject();
  /// Replaces the project without undo: after a save, after adding files.
  void replaceProject(Project project);
  void setData(LoadedData data);
  void markSaved(const std::string& path);
  bool modified() const;
  /// Something that undo knows is not saved; display settings apart.
  bool workUnsaved() const { return m_hasProject && (m_unsaved || !m_undo.isClean()); }

  /// One undoable change. Nothing happens where `edit` changes nothing worth a snapshot.
  void change(const QString& name, const std::function<void(Project&)>& edit);
  /// A change being dragged: shown at once, undone as one. Ends with commitDrag or cancelDrag.
  void dragChange(const std::function<void(Project&)>& edit);
  void commitDrag(const QString& name);
  void cancelDrag();

  void setDisplay(const DisplaySettings& display, bool dragging = false);
  void setPace(const FramePace& pace);  ///< kept in the user's settings
  void select(const SelectionState& selection);
  void setFrame(FrameId frame);
  void setFrameIndex(int index);  ///< clamped
  void stepFrames(int by);

  bool designVisible(DesignId design) const;
  bool elementVisible(DesignId design, int element) const;
  const DesignModel* model(DesignId design) const;
  void setElementsVisible(const QString& name, DesignId design, const std::vector<int>& elements,
                          bool visible);

  // What only this window shows: kept out of the project.
  void setRawOnly(bool on);
  void setResidualsShown(bool on);
  void setCandidate(std::optional<Frame> frame);  ///< the current frame with a pose that is not yet accepted
  const std::optional<Frame>& candidate() const { return m_candidate; }
  /// The current frame with the pose that is shown: the candidate's, unless what was before is looked at.
  const Frame* shownFrame() const;
  void setShowBefore(bool on);
  bool canShowBefore() const;
  void setViewSize(int width, int height);  ///< of the result wanted, pixels; 0: raw size

  const std::shared_ptr<const RenderResult>& rendered() const { return m_rendered; }
  bool upToDate() const;

  // Playing: frames are asked for ahead and shown when they are due, so that nothing waits on this thread.
  bool playing() const { return m_playing; }
  void setPlaying(bool on);  ///< off: the current frame is drawn as it is when still
  void requestPlayed(int index, const std::vector<int>& next, int run, int shrink);
  void showPlayed(const std::shared_ptr<const RenderResult>& result);
  double renderMs() const { return m_renderMs; }
  void requestRender();
  /// The view moves, and will be still soon: quick pictures until then.
  void keepMoving();

 signals:
  void projectOpened();  ///< before anything else of a new project is told
  void projectChanged();
  void structureChanged();  ///< another project, or sources came or went
  void dataChanged();
  void displayChanged();
  void selectionChanged();
  void frameChanged();
  void pictureReady(std::shared_ptr<const alidade::RenderResult> result);
  void renderFailed(const alidade::Error& error);
  void modifiedChanged();
  void beforeShown(bool on);
  void shownPoseChanged();  ///< of the same frame: a candidate came or went, or before and after
  void playedReady(std::shared_ptr<const alidade::RenderResult> result);  ///< to be shown when it is due
  void playedFailed();

 private:
  friend class ProjectChange;
  void restore(std::shared_ptr<const Project> snapshot);
  RenderRequest requestOf(const Frame& frame);
  void sendRequest();
  void onRendered(const std::shared_ptr<const RenderResult>& result);
  void onFailed(FrameId frame, quint64 serial, const Error& error);

  std::shared_ptr<const Project> m_project;
  std::shared_ptr<const LoadedData> m_data;
  std::shared_ptr<const Project> m_dragStart;
  bool m_hasProject = false;
  bool m_unsaved = false;
  bool m_displayUnsaved = false;
  DisplaySettings m_display;
  FramePace m_pace;
  SelectionState m_selection;
  FrameId m_frame;

  bool m_rawOnly = false, m_residuals = true, m_showBefore = false, m_dragging = false, m_playing = false;
  std::optional<Frame> m_candidate;
  int m_width = 0, m_height = 0;
  std::shared_ptr<const RenderResult> m_rendered;
  double m_renderMs = 0;
  std::string m_lastRenderError;
  bool m_requestDue = false;
  quint64 m_requestsSent = 0, m_requestsAnswered = 0;
  QTimer m_settle;  ///< after a drag: the full picture

  QUndoStack m_undo;
  MessageList m_messages;
  JobList m_jobs;
  RenderLoop m_render;
};

}  // namespace alidade

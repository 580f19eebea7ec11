// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>

#include <QMainWindow>

#include "ui/actions.h"
#include "ui/playback.h"
#include "ui/pose_refinement.h"
#include "ui/project_files.h"
#include "ui/session.h"
#include "ui/theme.h"
#include "ui/view_tool.h"

class QDockWidget;
class QSplitter;
class QStackedWidget;

namespace alidade {

class CalibrationDialog;
class CleaningPanel;
class CommandPalette;
class ExportDialog;
class HoldKeys;
class JobStrip;
class OverlayView;
class ProjectPanel;
class ProjectTreeModel;
class ResectionPanel;
class ScanWork;
class SceneWidget;
class ValueSlider;
class WelcomePage;

/// Puts the window together: panels in their places, commands on what they do. Keeps no state of the
/// work itself; see Session.
class MainWindow : public QMainWindow {
  Q_OBJECT

 public:
  explicit MainWindow(QWidget* parent = nullptr);
  ~MainWindow() override;

  Session& session() { return *m_session; }
  ProjectFiles& files() { return *m_files; }
  ScanWork& scanWork() { return *m_scanWork; }
  PoseRefinement& refinement() { return *m_refinement; }
  Playback& playback() { return *m_playback; }
  const Actions& actions() const { return *m_actions; }
  OverlayView& overlay() { return *m_overlay; }
  SceneWidget& scene() { return *m_scene; }
  ProjectTreeModel& tree() { return *m_tree; }
  ExportDialog* exportDialog() const { return m_export; }
  CalibrationDialog* calibrationDialog() const { return m_calibration; }

  /// Opens a project or makes one of the files; for the command line.
  void openPaths(const QStringList& paths);
  /// Loaded, rendered, nothing running: what a screenshot waits for.
  bool settled() const;

 protected:
  void closeEvent(QCloseEvent* event) override;
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dragLeaveEvent(QDragLeaveEvent* event) override;
  void dropEvent(QDropEvent* event) override;

 private:
  void buildCentre();
  void buildToolBar();
  void buildDocks();
  void buildMenus();
  QDockWidget* dock(const QString& title, const QString& name, QWidget* content, Qt::DockWidgetArea area);
  void connectFileActions();
  void connectEditActions();
  void connectViewActions();
  void connectFrameActions();
  void connectToolActions();
  void connectHoldKeys();
  void connectSession();
  void showMode(Command mode);
  void floatScene(bool on);
  bool eventFilter(QObject* watched, QEvent* event) override;
  Command mode() const;
  void useTool();
  void chooseTheme(Theme theme);
  void editDisplay(const std::function<void(DisplaySettings&)>& edit, bool dragging = false);
  void refreshDisplayActions();
  void refreshTitle();
  void refreshEnabled();
  void showWorkspace(bool on);
  void refillRecentMenu();
  void showContextMenu(const QPoint& globalPosition, const glm::dvec2* raw);
  void hideSelected();
  void isolateStorey();
  void showKeys();
  void chooseFiles();
  void chooseProject();
  void chooseSavePath();
  void openExport();
  /// False where there are unsaved changes to ask about first; `goOn` runs once they are saved.
  bool mayClose(const std::function<void()>& goOn);
  void closeThen(const std::function<void()>& goOn);
  void saveLayout();
  void defaultLayout();

  std::unique_ptr<Session> m_session;
  ProjectFiles* m_files;
  PoseRefinement* m_refinement;
  ScanWork* m_scanWork;
  Playback* m_playback;
  Actions* m_actions;
  ProjectTreeModel* m_tree;
  HoldKeys* m_hold;

  QStackedWidget* m_pages;
  WelcomePage* m_welcome;
  QSplitter* m_splitter;
  OverlayView* m_overlay;
  SceneWidget* m_scene;
  ProjectPanel* m_projectPanel;
  ResectionPanel* m_resectionPanel;
  CleaningPanel* m_cleaningPanel;
  ValueSlider* m_density;
  ValueSlider* m_pointSize;
  CommandPalette* m_palette;
  ExportDialog* m_export = nullptr;
  CalibrationDialog* m_calibration = nullptr;
  QToolBar* m_toolBar;
  QWidget* m_timeline;
  QList<QDockWidget*> m_docks;
  QDockWidget *m_projectDock, *m_propertiesDock, *m_displayDock, *m_pointsDock, *m_clockDock, *m_mountDock, *m_resectionDock, *m_cleaningDock,
      *m_messageDock;
  QMenu* m_recentMenu;
  std::shared_ptr<MeasuredDistances> m_measurements;
  bool m_workspaceShown = false;
  std::function<void()> m_afterSave;  ///< what the unsaved changes held up
};

}  // namespace alidade

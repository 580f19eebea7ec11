// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/main_window.h"

#include <QAction>
#include <QCloseEvent>
#include <QDockWidget>
#include <QFileInfo>
#include <QLabel>
#include <QMenuBar>
#include <QMessageBox>
#include <QMimeData>
#include <QScrollArea>
#include <QSettings>
#include <QSplitter>
#include <QStackedWidget>
#include <QStatusBar>
#include <QStyle>
#include <QToolBar>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/calibration_dialog.h"
#include "ui/cleaning_panel.h"
#include "ui/clock_panel.h"
#include "ui/command_palette.h"
#include "ui/display_panel.h"
#include "ui/export_dialog.h"
#include "ui/format.h"
#include "ui/hold_keys.h"
#include "ui/job_strip.h"
#include "ui/message_panel.h"
#include "ui/mount_panel.h"
#include "ui/overlay_view.h"
#include "ui/points_panel.h"
#include "ui/project_panel.h"
#include "ui/properties_panel.h"
#include "ui/resection_panel.h"
#include "ui/scene_widget.h"
#include "ui/status_line.h"
#include "ui/timeline.h"
#include "ui/value_slider.h"
#include "ui/welcome_page.h"

namespace alidade {

namespace {

/// A panel that is higher than the screen scrolls; it must not make the window so high.
QWidget* scrolling(QWidget* content) {
  if (qobject_cast<QAbstractScrollArea*>(content)) return content;
  auto* area = new QScrollArea;
  area->setWidget(content);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  area->setMinimumWidth(content->minimumSizeHint().width() + area->style()->pixelMetric(QStyle::PM_ScrollBarExtent));
  return area;
}

constexpr int kLayoutVersion = 4;

}  // namespace

MainWindow::MainWindow(QWidget* parent)
    : QMainWindow(parent),
      m_session(std::make_unique<Session>()),
      m_measurements(std::make_shared<MeasuredDistances>()) {
  setObjectName(QStringLiteral("mainWindow"));
  setAcceptDrops(true);
  setDockNestingEnabled(true);
  setTabPosition(Qt::AllDockWidgetAreas, QTabWidget::North);
  resize(1600, 980);
  m_files = new ProjectFiles(*m_session, this);
  m_refinement = new PoseRefinement(*m_session, this);
  m_scanWork = new ScanWork(*m_session, this);
  m_playback = new Playback(*m_session, this);
  m_actions = new Actions(this);
  m_tree = new ProjectTreeModel(*m_session, this);
  m_hold = new HoldKeys(*this);
  buildCentre();
  buildToolBar();
  buildDocks();
  buildMenus();
  m_palette = new CommandPalette(*m_actions, this);
  connectFileActions();
  connectEditActions();
  connectViewActions();
  connectFrameActions();
  connectToolActions();
  connectHoldKeys();
  connectSession();
  (*m_actions)[Command::ToolSelect]->trigger();
  (*m_actions)[Command::ShowOverlay]->setChecked(true);
  const QSettings settings;
  if (settings.contains(QStringLiteral("geometry")))
    restoreGeometry(settings.value(QStringLiteral("geometry")).toByteArray());
  showWorkspace(false);
  refreshTitle();
  refreshEnabled();
  refreshDisplayActions();
}

MainWindow::~MainWindow() {
  // Widgets ask the session until they are gone (a field that loses the focus hands its figure over), so
  // they go first.
  hide();
  for (QToolBar* bar : findChildren<QToolBar*>(QString(), Qt::FindDirectChildrenOnly)) delete bar;
  delete m_export;
  delete m_calibration;
  delete m_palette;
  if (m_scene->isWindow()) m_splitter->addWidget(m_scene);  // out in its own window: it goes with the rest
  delete takeCentralWidget();
  for (QDockWidget* dock : m_docks) delete dock;
  delete statusBar();
}

void MainWindow::buildCentre() {
  m_overlay = new OverlayView(*m_session);
  m_scene = new SceneWidget(*m_session);
  m_splitter = new QSplitter(Qt::Horizontal);
  m_splitter->setObjectName(QStringLiteral("viewSplitter"));
  m_splitter->addWidget(m_overlay);
  m_splitter->addWidget(m_scene);
  m_splitter->setChildrenCollapsible(false);
  m_splitter->setHandleWidth(3);
  m_scene->hide();
  m_welcome = new WelcomePage(*m_files, *m_actions);
  m_pages = new QStackedWidget;
  m_pages->addWidget(m_welcome);
  m_pages->addWidget(m_splitter);
  setCentralWidget(m_pages);

  auto* line = new StatusLine(*m_session, *m_overlay);
  statusBar()->setSizeGripEnabled(false);
  statusBar()->addPermanentWidget(line, 1);
  connect(line, &StatusLine::messagesWanted, this,
          [this] { (*m_actions)[Command::ShowMessages]->setChecked(true); });
}

void MainWindow::buildToolBar() {
  m_toolBar = addToolBar(tr("Tools"));
  m_toolBar->setObjectName(QStringLiteral("toolBar"));
  m_toolBar->setMovable(false);
  m_toolBar->setIconSize({16, 16});
  m_toolBar->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  m_toolBar->setContextMenuPolicy(Qt::PreventContextMenu);
  const Actions& a = *m_actions;
  for (const Command tool : {Command::ToolSelect, Command::ToolPick, Command::ToolMeasure, Command::ToolArrow,
                             Command::ToolText, Command::ToolCallout})
    m_toolBar->addAction(a[tool]);
  m_toolBar->addSeparator();
  m_toolBar->addAction(a[Command::CycleHidden]);
  m_toolBar->addSeparator();
  m_density = new ValueSlider(tr("Density"), QStringLiteral("density"),
                              {0, 1, 1, false, 100, 0, QStringLiteral("%")});
  m_density->setObjectName(QStringLiteral("densitySlider"));
  m_density->setToolTip(
      tr("How many of the scan's points are drawn. Drag; Shift is slow; double click for automatic; "
         "type a figure (hold D)"));
  m_pointSize = new ValueSlider(tr("Point size"), QStringLiteral("pointsize"),
                                {0.2, 8, 1, true, 1, 2, QStringLiteral("×")});
  m_pointSize->setObjectName(QStringLiteral("pointSizeSlider"));
  m_pointSize->setToolTip(tr("Size of the points against the automatic one (hold P)"));
  m_toolBar->addWidget(m_density);
  m_toolBar->addSeparator();
  m_toolBar->addWidget(m_pointSize);
  auto* gap = new QWidget;
  gap->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
  m_toolBar->addWidget(gap);
  for (const Command view : {Command::ShowOverlay, Command::ShowScene, Command::ShowBoth})
    m_toolBar->addAction(a[view]);
  for (QToolButton* button : m_toolBar->findChildren<QToolButton*>()) button->setFocusPolicy(Qt::TabFocus);
  connect(m_density, &ValueSlider::changed, this, [this](double value, bool dragging) {
    editDisplay([&](DisplaySettings& d) { d.density = value; }, dragging);
  });
  connect(m_pointSize, &ValueSlider::changed, this, [this](double value, bool dragging) {
    editDisplay([&](DisplaySettings& d) { d.pointSize = value; }, dragging);
  });
}

QDockWidget* MainWindow::dock(const QString& title, const QString& name, QWidget* content,
                              Qt::DockWidgetArea area) {
  auto* dock = new QDockWidget(title, this);
  dock->setObjectName(name);
  dock->setWidget(scrolling(content));
  addDockWidget(area, dock);
  m_docks << dock;
  return dock;
}

void MainWindow::buildDocks() {
  m_projectPanel = new ProjectPanel(*m_session, *m_tree);
  m_resectionPanel = new ResectionPanel(*m_session, *m_refinement, *m_overlay);
  m_projectDock = dock(tr("Project"), QStringLiteral("projectDock"), m_projectPanel, Qt::LeftDockWidgetArea);
  m_propertiesDock = dock(tr("Properties"), QStringLiteral("propertiesDock"), new PropertiesPanel(*m_session),
                          Qt::RightDockWidgetArea);
  m_displayDock = dock(tr("Display"), QStringLiteral("displayDock"), new DisplayPanel(*m_session),
                       Qt::RightDockWidgetArea);
  m_pointsDock = dock(tr("Points"), QStringLiteral("pointsDock"), new PointsPanel(*m_session), Qt::RightDockWidgetArea);
  m_clockDock = dock(tr("Clock"), QStringLiteral("clockDock"), new ClockPanel(*m_session), Qt::RightDockWidgetArea);
  m_mountDock = dock(tr("Mount"), QStringLiteral("mountDock"), new MountPanel(*m_session), Qt::RightDockWidgetArea);
  m_resectionDock =
      dock(tr("Refine pose"), QStringLiteral("resectionDock"), m_resectionPanel, Qt::RightDockWidgetArea);
  m_cleaningPanel = new CleaningPanel(*m_session, *m_scanWork);
  m_cleaningDock = dock(tr("Clean scans"), QStringLiteral("cleaningDock"), m_cleaningPanel, Qt::RightDockWidgetArea);
  m_messageDock = dock(tr("Messages"), QStringLiteral("messageDock"), new MessagePanel(m_session->messages()),
                       Qt::BottomDockWidgetArea);

  // The strip and the jobs are no panels that anyone closes: a dock without a title keeps them below all
  // others.
  auto* bottom = new QWidget;
  auto* layout = new QVBoxLayout(bottom);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  m_timeline = new Timeline(*m_session, *m_playback, *m_actions);
  layout->addWidget(m_timeline);
  layout->addWidget(new JobStrip(m_session->jobs()));
  auto* bar = new QToolBar(tr("Timeline"));
  bar->setObjectName(QStringLiteral("timelineBar"));
  bar->setMovable(false);
  bar->setContextMenuPolicy(Qt::PreventContextMenu);
  bar->addWidget(bottom);
  bar->setStyleSheet(
      QStringLiteral("QToolBar { padding: 0; border-bottom: 0; border-top: 1px solid palette(mid); }"));
  bottom->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
  addToolBar(Qt::BottomToolBarArea, bar);
  defaultLayout();
}

void MainWindow::defaultLayout() {
  for (QDockWidget* dock : m_docks) {
    dock->setFloating(false);
    dock->show();
  }
  addDockWidget(Qt::LeftDockWidgetArea, m_projectDock);
  addDockWidget(Qt::RightDockWidgetArea, m_propertiesDock);
  splitDockWidget(m_propertiesDock, m_displayDock, Qt::Vertical);
  tabifyDockWidget(m_propertiesDock, m_resectionDock);
  tabifyDockWidget(m_displayDock, m_pointsDock);
  tabifyDockWidget(m_displayDock, m_cleaningDock);
  tabifyDockWidget(m_displayDock, m_clockDock);
  tabifyDockWidget(m_displayDock, m_mountDock);
  addDockWidget(Qt::BottomDockWidgetArea, m_messageDock);
  m_propertiesDock->raise();
  m_displayDock->raise();
  m_resectionDock->hide();
  m_cleaningDock->hide();
  m_mountDock->hide();
  m_messageDock->hide();
  resizeDocks({m_projectDock, m_propertiesDock}, {270, 300}, Qt::Horizontal);
  resizeDocks({m_propertiesDock, m_displayDock}, {380, 400}, Qt::Vertical);
  resizeDocks({m_messageDock}, {130}, Qt::Vertical);
}

void MainWindow::showWorkspace(bool on) {
  if (m_workspaceShown && !on) saveLayout();
  m_pages->setCurrentWidget(on ? static_cast<QWidget*>(m_splitter) : m_welcome);
  m_toolBar->setVisible(on);
  m_timeline->setVisible(on);
  statusBar()->setVisible(on);
  if (!on) {
    for (QDockWidget* dock : m_docks) dock->hide();
  } else if (!m_workspaceShown) {
    defaultLayout();
    const QByteArray state = QSettings().value(QStringLiteral("layout")).toByteArray();
    if (!state.isEmpty()) restoreState(state, kLayoutVersion);
    // Whatever was stored, these belong to the workspace.
    m_toolBar->show();
  }
  m_workspaceShown = on;
}

void MainWindow::saveLayout() {
  if (!m_workspaceShown) return;
  QSettings settings;
  settings.setValue(QStringLiteral("layout"), saveState(kLayoutVersion));
}

bool MainWindow::settled() const {
  const bool rendered = !m_session->currentFrame() || (m_session->rendered() && m_session->upToDate());
  return m_session->jobs().idle() && (!m_session->hasProject() || rendered);
}

void MainWindow::openPaths(const QStringList& paths) {
  m_files->openAny(paths);
}

void MainWindow::refreshTitle() {
  if (!m_session->hasProject()) {
    setWindowTitle(tr("Alidade"));
    setWindowModified(false);
    return;
  }
  const Project& project = *m_session->project();
  const QString name =
      project.path.empty() ? text(project.name) : QFileInfo(text(project.path)).completeBaseName();
  setWindowTitle(tr("%1[*] – Alidade").arg(name.isEmpty() ? tr("Untitled") : name));
  setWindowModified(m_session->modified());
}

bool MainWindow::mayClose(const std::function<void()>& goOn) {
  // Slider positions alone are not worth a question.
  const bool worthAsking = m_session->hasProject() && m_session->workUnsaved();
  if (!worthAsking) return true;
  QMessageBox box(QMessageBox::Question, tr("Unsaved changes"),
                  tr("%1 has changes that are not saved.").arg(text(m_session->project()->name)),
                  QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, this);
  box.setDefaultButton(QMessageBox::Save);
  const int answer = box.exec();
  if (answer == QMessageBox::Save) {
    // It goes on once all is saved: a save that fails must not lose the work.
    m_afterSave = goOn;
    m_files->save();
    return false;
  }
  return answer == QMessageBox::Discard;
}

void MainWindow::closeThen(const std::function<void()>& goOn) {
  if (mayClose(goOn)) goOn();
}

void MainWindow::closeEvent(QCloseEvent* event) {
  if (!mayClose([this] { close(); })) {
    event->ignore();
    return;
  }
  saveLayout();
  QSettings().setValue(QStringLiteral("geometry"), saveGeometry());
  m_playback->setPlaying(false);
  m_session->jobs().cancelAll();
  event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  if (!event->mimeData()->hasUrls()) return;
  event->acceptProposedAction();
  m_welcome->setDropHighlighted(true);
}

void MainWindow::dragLeaveEvent(QDragLeaveEvent*) {
  m_welcome->setDropHighlighted(false);
}

void MainWindow::dropEvent(QDropEvent* event) {
  m_welcome->setDropHighlighted(false);
  QStringList paths;
  for (const QUrl& url : event->mimeData()->urls())
    if (url.isLocalFile()) paths << url.toLocalFile();
  if (paths.isEmpty()) return;
  event->acceptProposedAction();
  m_files->openAny(paths);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// The second half of MainWindow: what each command of the table does.

#include <QAction>
#include <QActionGroup>
#include <QApplication>
#include <QClipboard>
#include <QDockWidget>
#include <QFileDialog>
#include <QFileInfo>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>
#include <QSettings>
#include <QSplitter>
#include <QToolBar>

#include "app/shown_elements.h"
#include "app/version.h"
#include "ui/calibration_dialog.h"
#include "ui/cleaning_panel.h"
#include "ui/command_palette.h"
#include "ui/export_dialog.h"
#include "ui/format.h"
#include "ui/hold_keys.h"
#include "ui/keys_page.h"
#include "ui/main_window.h"
#include "ui/overlay_view.h"
#include "ui/project_panel.h"
#include "ui/resection_panel.h"
#include "ui/scene_widget.h"
#include "ui/value_slider.h"

namespace alidade {

namespace {

constexpr double kScrubPixels = 400.0;  // of mouse way for a slider's whole range

using C = Command;

}  // namespace

void MainWindow::buildMenus() {
  const Actions& a = *m_actions;
  const auto fill = [&](const QString& title, std::initializer_list<int> rows) {
    QMenu* menu = menuBar()->addMenu(title);
    for (const int row : rows) {
      if (row < 0)
        menu->addSeparator();
      else
        menu->addAction(a[static_cast<Command>(row)]);
    }
    return menu;
  };
  const auto id = [](Command c) { return static_cast<int>(c); };
  QMenu* file = fill(tr("&File"), {id(C::NewProject), id(C::OpenProject), id(C::AddFiles), id(C::OpenSample),
                                   -1, id(C::Save), id(C::SaveAs), id(C::CloseProject), -1,
                                   id(C::ExportPicture), -1, id(C::Quit)});
  m_recentMenu = new QMenu(tr("Open recent"), this);
  file->insertMenu(a[C::AddFiles], m_recentMenu);
  fill(tr("&Edit"), {id(C::Undo), id(C::Redo), -1, id(C::Delete), id(C::CopyCoordinates),
                     id(C::ClearSelection), -1, id(C::CommandPalette)});
  QMenu* view = fill(tr("&View"), {id(C::ShowOverlay),
                                   id(C::ShowScene),
                                   id(C::ShowBoth),
                                   id(C::FloatScene),
                                   id(C::CycleView),
                                   -1,
                                   id(C::Fit),
                                   id(C::ActualSize),
                                   id(C::ZoomIn),
                                   id(C::ZoomOut),
                                   id(C::FitScene),
                                   id(C::LookFromFrame),
                                   -1,
                                   id(C::PassImage),
                                   id(C::PassDepth),
                                   id(C::PassDesign),
                                   id(C::PassPoints),
                                   id(C::CycleHidden),
                                   id(C::GrayscaleImage),
                                   id(C::StakePoints),
                                   id(C::Labels),
                                   id(C::RawPicture),
                                   -1});
  QMenu* panels = view->addMenu(tr("Panels"));
  for (QDockWidget* dock : m_docks)
    if (dock != m_messageDock) panels->addAction(dock->toggleViewAction());
  panels->addAction(a[C::ShowMessages]);
  panels->addAction(a[C::ShowPoints]);
  panels->addAction(a[C::ShowClock]);
  panels->addAction(a[C::ShowMount]);
  panels->addSeparator();
  panels->addAction(a[C::ResetLayout]);
  QMenu* theme = view->addMenu(icon(QStringLiteral("theme")), tr("Theme"));
  for (const Command c : {C::ThemeDark, C::ThemeLight, C::ThemeContrast}) theme->addAction(a[c]);
  fill(tr("F&rame"), {id(C::Play), id(C::PreviousFrame), id(C::NextFrame), id(C::PreviousTen), id(C::NextTen),
                      id(C::FirstFrame), id(C::LastFrame)});
  fill(tr("A&lign"), {id(C::Resection), id(C::AutoAlign), id(C::AlignSequence), id(C::RefinePose), id(C::AcceptPose), id(C::DropPose), -1,
                      id(C::CalibrateCamera)});
  fill(tr("&Inspect"), {id(C::ToolSelect), id(C::ToolPick), id(C::ToolMeasure), id(C::ClearMeasurements), -1,
                        id(C::HideSelected), id(C::IsolateStorey), id(C::ShowAllElements), -1, id(C::ShowCleaning)});
  fill(tr("A&nnotate"), {id(C::ToolText), id(C::ToolArrow), id(C::ToolCallout), -1, id(C::Delete)});
  fill(tr("&Help"), {id(C::Keys), id(C::CommandPalette), -1, id(C::About)});
  for (QMenu* menu : findChildren<QMenu*>()) menu->setToolTipsVisible(true);
}

void MainWindow::connectFileActions() {
  const Actions& a = *m_actions;
  connect(a[C::NewProject], &QAction::triggered, this,
          [this] { closeThen([this] { m_files->newEmpty(); }); });
  connect(a[C::OpenProject], &QAction::triggered, this, [this] { closeThen([this] { chooseProject(); }); });
  connect(a[C::AddFiles], &QAction::triggered, this, &MainWindow::chooseFiles);
  connect(m_files, &ProjectFiles::wantsFiles, this, &MainWindow::chooseFiles);
  connect(a[C::OpenSample], &QAction::triggered, this,
          [this] { closeThen([this] { m_files->openSample(); }); });
  connect(a[C::Save], &QAction::triggered, m_files, &ProjectFiles::save);
  connect(a[C::SaveAs], &QAction::triggered, this, &MainWindow::chooseSavePath);
  connect(m_files, &ProjectFiles::needsPath, this, &MainWindow::chooseSavePath);
  connect(a[C::CloseProject], &QAction::triggered, this, [this] {
    closeThen([this] {
      showWorkspace(false);
      m_session->closeProject();
    });
  });
  connect(m_files, &ProjectFiles::saveFinished, this, [this](bool saved) {
    const auto goOn = std::exchange(m_afterSave, nullptr);
    if (saved && goOn) goOn();
  });
  connect(a[C::ExportPicture], &QAction::triggered, this, &MainWindow::openExport);
  connect(a[C::Quit], &QAction::triggered, this, &QWidget::close);
  connect(m_files, &ProjectFiles::recentChanged, this, &MainWindow::refillRecentMenu);
  refillRecentMenu();
}

void MainWindow::refillRecentMenu() {
  m_recentMenu->clear();
  for (const QString& path : m_files->recent()) {
    QAction* action = m_recentMenu->addAction(QFileInfo(path).completeBaseName());
    action->setToolTip(path);
    connect(action, &QAction::triggered, this, [this, path] {
      closeThen([this, path] { m_files->open(path); });
    });
  }
  m_recentMenu->setEnabled(!m_recentMenu->isEmpty());
}

void MainWindow::chooseFiles() {
  const QStringList paths =
      QFileDialog::getOpenFileNames(this, tr("Add scans, pictures, cameras, designs or points"),
                                    QSettings().value(QStringLiteral("openFolder")).toString());
  if (paths.isEmpty()) return;
  QSettings().setValue(QStringLiteral("openFolder"), QFileInfo(paths.front()).absolutePath());
  m_files->add(paths);
}

void MainWindow::chooseProject() {
  const QStringList paths = QFileDialog::getOpenFileNames(
      this, tr("Open"), QSettings().value(QStringLiteral("openFolder")).toString(),
      tr("Projects (*.alidade);;All files (*)"));
  if (paths.isEmpty()) return;
  QSettings().setValue(QStringLiteral("openFolder"), QFileInfo(paths.front()).absolutePath());
  m_files->openAny(paths);
}

void MainWindow::chooseSavePath() {
  const QString start = QFileInfo(QSettings().value(QStringLiteral("openFolder")).toString(),
                                  text(m_session->project()->name) + QStringLiteral(".alidade"))
                            .filePath();
  const QString path =
      QFileDialog::getSaveFileName(this, tr("Save project"), start, tr("Projects (*.alidade)"));
  if (path.isEmpty()) m_afterSave = nullptr;
  else m_files->saveAs(path);
}

void MainWindow::openExport() {
  if (!m_export) {
    m_export = new ExportDialog(*m_session, this);
    connect(m_export, &QObject::destroyed, this, [this] { m_export = nullptr; });
  }
  m_export->show();
  m_export->raise();
  m_export->activateWindow();
}

void MainWindow::connectEditActions() {
  const Actions& a = *m_actions;
  connect(a[C::Undo], &QAction::triggered, &m_session->undo(), &QUndoStack::undo);
  connect(a[C::Redo], &QAction::triggered, &m_session->undo(), &QUndoStack::redo);
  connect(&m_session->undo(), &QUndoStack::indexChanged, this, [this] {
    const QUndoStack& stack = m_session->undo();
    (*m_actions)[C::Undo]->setText(stack.canUndo() ? tr("Undo: %1").arg(stack.undoText()) : tr("Undo"));
    (*m_actions)[C::Redo]->setText(stack.canRedo() ? tr("Redo: %1").arg(stack.redoText()) : tr("Redo"));
    refreshEnabled();
  });
  connect(a[C::Delete], &QAction::triggered, this, [this] {
    const AnnotationId id = m_session->selection().annotation;
    if (!id) return;
    m_session->select({});
    m_session->change(tr("Delete annotation"), [&](Project& project) {
      std::erase_if(project.annotations, [&](const Annotation& annotation) { return annotation.id == id; });
    });
  });
  connect(a[C::CopyCoordinates], &QAction::triggered, this, [this] {
    const auto& world = m_overlay->cursorReadout().world;
    if (!world) {
      m_overlay->flash(tr("Nothing scanned under the cursor"));
      return;
    }
    // Plain figures, as other programs read them.
    QApplication::clipboard()->setText(QStringLiteral("%1 %2 %3")
                                           .arg(world->x, 0, 'f', 3)
                                           .arg(world->y, 0, 'f', 3)
                                           .arg(world->z, 0, 'f', 3));
    m_overlay->flash(tr("Copied %1").arg(formatWorld(*world)));
  });
  connect(a[C::CommandPalette], &QAction::triggered, m_palette, &CommandPalette::open);
  connect(a[C::ClearSelection], &QAction::triggered, this, [this] {
    if (m_overlay->escape()) return;
    if (!(*m_actions)[C::ToolSelect]->isChecked())
      (*m_actions)[C::ToolSelect]->trigger();
    else
      m_session->select({});
  });
  connect(a[C::HideSelected], &QAction::triggered, this, &MainWindow::hideSelected);
  connect(a[C::IsolateStorey], &QAction::triggered, this, &MainWindow::isolateStorey);
  connect(a[C::ShowAllElements], &QAction::triggered, this, [this] {
    m_session->change(tr("Show all elements"), [](Project& project) {
      for (Design& design : project.designs) design.visible = true, design.hiddenElements.clear();
    });
  });
  connect(a[C::Keys], &QAction::triggered, this, &MainWindow::showKeys);
  connect(a[C::About], &QAction::triggered, this, [this] {
    m_session->messages().info(text(softwareName()));
    m_overlay->flash(text(softwareName()));
  });
}

void MainWindow::hideSelected() {
  const SelectionState selection = m_session->selection();
  const DesignModel* model = m_session->model(selection.design);
  if (!model || selection.element < 0) return;
  const QString name = text(model->elements[static_cast<std::size_t>(selection.element)].name);
  m_session->setElementsVisible(tr("Hide %1").arg(name), selection.design, {selection.element}, false);
  m_session->select({});
}

void MainWindow::isolateStorey() {
  const SelectionState selection = m_session->selection();
  const DesignModel* model = m_session->model(selection.design);
  if (!model || selection.element < 0) return;
  const std::string storey = model->elements[static_cast<std::size_t>(selection.element)].storey;
  m_session->change(tr("Show only %1").arg(text(storey)), [&](Project& project) {
    for (Design& design : project.designs)
      if (design.id == selection.design) showOnlyStorey(design, *model, storey);
  });
}

void MainWindow::connectViewActions() {
  const Actions& a = *m_actions;
  for (const Command c : {C::ShowOverlay, C::ShowScene, C::ShowBoth})
    connect(a[c], &QAction::toggled, this, [this, c](bool on) {
      if (on) showMode(c);
    });
  connect(a[C::FloatScene], &QAction::toggled, this, &MainWindow::floatScene);
  m_scene->installEventFilter(this);
  connect(a[C::CycleView], &QAction::triggered, this, [this] {
    const Command next = mode() == C::ShowOverlay ? C::ShowScene
                         : mode() == C::ShowScene ? C::ShowBoth
                                                  : C::ShowOverlay;
    (*m_actions)[next]->setChecked(true);
  });
  // Tab moves the focus inside panels; only over the views it goes to the next view.
  a[C::CycleView]->setShortcutContext(Qt::WidgetWithChildrenShortcut);
  removeAction(a[C::CycleView]);
  m_splitter->addAction(a[C::CycleView]);
  connect(a[C::Fit], &QAction::triggered, this,
          [this] { mode() == C::ShowScene ? m_scene->fitAll() : m_overlay->fit(); });
  connect(a[C::ActualSize], &QAction::triggered, m_overlay, &OverlayView::actualSize);
  connect(a[C::ZoomIn], &QAction::triggered, this, [this] { m_overlay->zoomBy(1.25); });
  connect(a[C::ZoomOut], &QAction::triggered, this, [this] { m_overlay->zoomBy(0.8); });
  connect(a[C::FitScene], &QAction::triggered, m_scene, &SceneWidget::fitAll);
  connect(a[C::LookFromFrame], &QAction::triggered, m_scene, &SceneWidget::lookFromFrame);
  connect(a[C::CycleHidden], &QAction::triggered, this, [this] {
    editDisplay([](DisplaySettings& d) {
      d.hidden = d.hidden == HiddenStyle::Ghost  ? HiddenStyle::Dash
                 : d.hidden == HiddenStyle::Dash ? HiddenStyle::Hide
                                                 : HiddenStyle::Ghost;
    });
  });
  const std::pair<Command, bool DisplaySettings::*> switches[] = {
      {C::PassImage, &DisplaySettings::imagePass},
      {C::PassDepth, &DisplaySettings::depthPass},
      {C::PassDesign, &DisplaySettings::designPass},
      {C::PassPoints, &DisplaySettings::pointPass},
      {C::GrayscaleImage, &DisplaySettings::grayscaleImage},
      {C::StakePoints, &DisplaySettings::stakePoints},
      {C::Labels, &DisplaySettings::labels}};
  for (const auto& [command, member] : switches)
    connect(a[command], &QAction::triggered, this,
            [this, member = member](bool on) { editDisplay([&](DisplaySettings& d) { d.*member = on; }); });
  connect(a[C::RawPicture], &QAction::toggled, m_session.get(), &Session::setRawOnly);
  connect(a[C::ShowMessages], &QAction::toggled, m_messageDock, &QWidget::setVisible);
  connect(m_messageDock, &QDockWidget::visibilityChanged, this, [this] {
    (*m_actions)[C::ShowMessages]->setChecked(m_messageDock->toggleViewAction()->isChecked());
  });
  connect(a[C::ShowClock], &QAction::triggered, this, [this] {
    m_clockDock->show();
    m_clockDock->raise();
  });
  connect(a[C::ShowMount], &QAction::triggered, this, [this] {
    m_mountDock->show();
    m_mountDock->raise();
  });
  connect(a[C::ShowPoints], &QAction::triggered, this, [this] {
    m_pointsDock->show();
    m_pointsDock->raise();
  });
  connect(a[C::ShowCleaning], &QAction::triggered, this, [this] {
    m_cleaningDock->show();
    m_cleaningDock->raise();
  });
  connect(a[C::CleanScan], &QAction::triggered, m_cleaningPanel, &CleaningPanel::clean);
  connect(a[C::RegisterScan], &QAction::triggered, m_cleaningPanel, &CleaningPanel::registerScan);
  const std::pair<Command, Theme> themes[] = {
      {C::ThemeDark, Theme::Dark}, {C::ThemeLight, Theme::Light}, {C::ThemeContrast, Theme::HighContrast}};
  for (const auto& [command, theme] : themes) {
    a[command]->setChecked(currentTheme() == theme);
    connect(a[command], &QAction::triggered, this, [this, theme = theme] { chooseTheme(theme); });
  }
  connect(a[C::ResetLayout], &QAction::triggered, this, &MainWindow::defaultLayout);
}

void MainWindow::floatScene(bool on) {
  if (!on) {
    m_splitter->addWidget(m_scene);
    showMode(mode());
    return;
  }
  m_scene->setParent(this, Qt::Window);
  m_scene->setWindowTitle(tr("Alidade – 3D"));
  m_scene->resize(960, 720);
  m_scene->show();
  showMode(mode());
}

/// Closing the 3D view's own window puts the view back where it was.
bool MainWindow::eventFilter(QObject* watched, QEvent* event) {
  QAction* floating = (*m_actions)[C::FloatScene];
  if (watched == m_scene && event->type() == QEvent::Close && floating->isChecked()) {
    event->ignore();
    floating->setChecked(false);
    return true;
  }
  return QMainWindow::eventFilter(watched, event);
}

void MainWindow::showMode(Command mode) {
  if ((*m_actions)[C::FloatScene]->isChecked()) {
    m_overlay->setVisible(true);
    m_overlay->setFocus();
    return;
  }
  m_overlay->setVisible(mode != C::ShowScene);
  m_scene->setVisible(mode != C::ShowOverlay);
  if (mode == C::ShowBoth) m_splitter->setSizes({m_splitter->width() * 3 / 5, m_splitter->width() * 2 / 5});
  (mode == C::ShowScene ? static_cast<QWidget*>(m_scene) : m_overlay)->setFocus();
}

Command MainWindow::mode() const {
  for (const Command c : {C::ShowScene, C::ShowBoth})
    if ((*m_actions)[c]->isChecked()) return c;
  return C::ShowOverlay;
}

void MainWindow::chooseTheme(Theme theme) {
  applyTheme(*qApp, theme);
  QSettings().setValue(QStringLiteral("theme"), themeName(theme));
  for (QWidget* widget : findChildren<QWidget*>()) widget->update();
}

void MainWindow::connectFrameActions() {
  const Actions& a = *m_actions;
  const std::pair<Command, int> steps[] = {
      {C::PreviousFrame, -1}, {C::NextFrame, 1}, {C::PreviousTen, -10}, {C::NextTen, 10}};
  for (const auto& [command, by] : steps)
    connect(a[command], &QAction::triggered, this, [this, by = by] { m_session->stepFrames(by); });
  connect(a[C::FirstFrame], &QAction::triggered, this, [this] { m_session->setFrameIndex(0); });
  connect(a[C::LastFrame], &QAction::triggered, this,
          [this] { m_session->setFrameIndex(static_cast<int>(m_session->project()->frames.size()) - 1); });
  connect(a[C::Play], &QAction::triggered, m_playback, &Playback::setPlaying);
  connect(m_playback, &Playback::changed, this, [this] {
    QAction* play = (*m_actions)[C::Play];
    play->setChecked(m_playback->playing());
    play->setText(m_playback->playing() ? tr("Stop") : tr("Play"));
    play->setIcon(icon(m_playback->playing() ? QStringLiteral("pause") : QStringLiteral("play")));
  });
  connect(a[C::Resection], &QAction::triggered, this, [this] {
    m_resectionDock->show();
    m_resectionDock->raise();
  });
  connect(a[C::AutoAlign], &QAction::triggered, this, [this] {
    (*m_actions)[C::Resection]->trigger();
    m_refinement->alignAutomatically();
  });
  connect(a[C::AlignSequence], &QAction::triggered, this, [this] {
    (*m_actions)[C::Resection]->trigger();
    m_refinement->alignSequence();
  });
  connect(a[C::RefinePose], &QAction::triggered, m_refinement, &PoseRefinement::refine);
  connect(a[C::AcceptPose], &QAction::triggered, m_refinement, &PoseRefinement::accept);
  connect(a[C::DropPose], &QAction::triggered, m_refinement, &PoseRefinement::drop);
  connect(a[C::CalibrateCamera], &QAction::triggered, this, [this] {
    if (!m_calibration) {
      m_calibration = new CalibrationDialog(*m_session, this);
      connect(m_calibration, &QObject::destroyed, this, [this] { m_calibration = nullptr; });
    }
    m_calibration->show();
    m_calibration->raise();
    m_calibration->activateWindow();
  });
  connect(m_refinement, &PoseRefinement::changed, this, &MainWindow::refreshEnabled);
}

void MainWindow::connectToolActions() {
  for (const Command c :
       {C::ToolSelect, C::ToolPick, C::ToolMeasure, C::ToolArrow, C::ToolText, C::ToolCallout})
    connect((*m_actions)[c], &QAction::triggered, this, &MainWindow::useTool);
  connect((*m_actions)[C::ClearMeasurements], &QAction::triggered, this, [this] {
    m_measurements->clear();
    m_overlay->update();
  });
  connect(m_resectionPanel, &ResectionPanel::toolReturned, this, &MainWindow::useTool);
  connect(m_scene, &SceneWidget::pointPicked, this, [this](const glm::dvec3& world) {
    if (m_resectionDock->isVisible() && mode() == C::ShowBoth) m_resectionPanel->useWorldPoint(world);
  });
  connect(m_overlay, &OverlayView::contextMenuWanted, this,
          [this](const QPoint& at, const glm::dvec2& raw) { showContextMenu(at, &raw); });
  connect(m_scene, &SceneWidget::contextMenuWanted, this,
          [this](const QPoint& at) { showContextMenu(at, nullptr); });
  connect(m_projectPanel, &ProjectPanel::contextMenuWanted, this,
          [this](const QPoint& at) { showContextMenu(at, nullptr); });
}

void MainWindow::useTool() {
  const Actions& a = *m_actions;
  std::unique_ptr<ViewTool> tool = makeSelectTool();
  if (a[C::ToolPick]->isChecked()) tool = makePickTool();
  if (a[C::ToolMeasure]->isChecked()) tool = makeMeasureTool(m_measurements);
  if (a[C::ToolArrow]->isChecked()) tool = makeAnnotateTool(AnnotationKind::Arrow);
  if (a[C::ToolText]->isChecked()) tool = makeAnnotateTool(AnnotationKind::Text);
  if (a[C::ToolCallout]->isChecked()) tool = makeAnnotateTool(AnnotationKind::Callout);
  m_overlay->setTool(std::move(tool));
  if (m_workspaceShown && mode() == C::ShowScene) (*m_actions)[C::ShowOverlay]->setChecked(true);
}

void MainWindow::connectHoldKeys() {
  m_hold->onHold(Qt::Key_B, [this](bool held) {
    if (held && !m_session->canShowBefore())
      m_overlay->flash(tr("This frame's pose was not refined: there is no before"));
    m_session->setShowBefore(held);
  });
  m_hold->onHold(Qt::Key_V, [this](bool held) { m_session->setResidualsShown(!held); });
  m_hold->onHold(Qt::Key_R, [this](bool held) {
    m_session->setRawOnly(held || (*m_actions)[C::RawPicture]->isChecked());
  });
  m_hold->onHold(Qt::Key_Space, [this](bool held) {
    m_overlay->setPanHeld(held);
    if (!held && !m_overlay->panned() && m_workspaceShown) m_playback->toggle();
  });
  const auto scrub = [this](int key, ValueSlider* slider, const QString& name) {
    m_hold->onScrub(
        key,
        [this, slider, name](double pixels) {
          slider->step(pixels / kScrubPixels, true);
          m_overlay->flash(QStringLiteral("%1 %2").arg(name, slider->figure()));
        },
        [slider] { emit slider->changed(slider->value(), false); });
  };
  scrub(Qt::Key_D, m_density, tr("Density"));
  scrub(Qt::Key_P, m_pointSize, tr("Point size"));
}

void MainWindow::connectSession() {
  connect(m_session.get(), &Session::structureChanged, this, [this] {
    m_measurements->clear();
    if (m_session->hasProject()) showWorkspace(true);
    refreshTitle();
    refreshEnabled();
  });
  connect(m_session.get(), &Session::projectChanged, this, &MainWindow::refreshTitle);
  connect(m_session.get(), &Session::modifiedChanged, this, &MainWindow::refreshTitle);
  connect(m_session.get(), &Session::displayChanged, this, &MainWindow::refreshDisplayActions);
  connect(m_session.get(), &Session::selectionChanged, this, &MainWindow::refreshEnabled);
  connect(m_session.get(), &Session::frameChanged, this, &MainWindow::refreshEnabled);
  // A note with a next step is worth showing at once; it takes no focus.
  connect(&m_session->messages(), &MessageList::added, this, [this](const Message& message) {
    if (message.severity == Severity::Info) return;
    if (m_workspaceShown || message.severity == Severity::Error)
      (*m_actions)[C::ShowMessages]->setChecked(true);
  });
}

void MainWindow::editDisplay(const std::function<void(DisplaySettings&)>& edit, bool dragging) {
  DisplaySettings display = m_session->display();
  edit(display);
  m_session->setDisplay(display, dragging);
}

void MainWindow::refreshDisplayActions() {
  const DisplaySettings& d = m_session->display();
  const Actions& a = *m_actions;
  a[C::PassImage]->setChecked(d.imagePass);
  a[C::PassDepth]->setChecked(d.depthPass);
  a[C::PassDesign]->setChecked(d.designPass);
  a[C::PassPoints]->setChecked(d.pointPass);
  a[C::GrayscaleImage]->setChecked(d.grayscaleImage);
  a[C::StakePoints]->setChecked(d.stakePoints);
  a[C::Labels]->setChecked(d.labels);
  m_density->setValue(d.density);
  m_pointSize->setValue(d.pointSize);
  switch (d.hidden) {
    case HiddenStyle::Hide:
      a[C::CycleHidden]->setText(tr("Hidden: not drawn"));
      break;
    case HiddenStyle::Ghost:
      a[C::CycleHidden]->setText(tr("Hidden: ghost"));
      break;
    case HiddenStyle::Dash:
      a[C::CycleHidden]->setText(tr("Hidden: dashed"));
      break;
  }
}

void MainWindow::refreshEnabled() {
  const Actions& a = *m_actions;
  const bool project = m_session->hasProject();
  const bool frames = project && m_session->currentFrame();
  const bool element = m_session->selection().element >= 0;
  for (const Command c : {C::Save, C::SaveAs, C::CloseProject, C::AddFiles, C::ShowAllElements})
    a[c]->setEnabled(project);
  for (const Command c :
       {C::ExportPicture, C::Play, C::PreviousFrame, C::NextFrame, C::PreviousTen, C::NextTen, C::FirstFrame,
        C::LastFrame, C::Resection, C::LookFromFrame, C::RawPicture})
    a[c]->setEnabled(frames);
  a[C::Undo]->setEnabled(m_session->undo().canUndo());
  a[C::Redo]->setEnabled(m_session->undo().canRedo());
  a[C::Delete]->setEnabled(static_cast<bool>(m_session->selection().annotation));
  a[C::HideSelected]->setEnabled(element);
  a[C::IsolateStorey]->setEnabled(element);
  a[C::RefinePose]->setEnabled(frames && !m_refinement->running() && !m_refinement->observations(m_refinement->scope()).empty());
  a[C::AutoAlign]->setEnabled(frames && !m_refinement->running() && m_session->currentFrame()->cameraFromWorld);
  a[C::AlignSequence]->setEnabled(frames && m_session->project()->frames.size() > 1 && !m_refinement->running());
  a[C::AcceptPose]->setEnabled(m_refinement->hasCandidate());
  a[C::DropPose]->setEnabled(m_refinement->hasCandidate());
}

void MainWindow::showContextMenu(const QPoint& globalPosition, const glm::dvec2* raw) {
  const Actions& a = *m_actions;
  if (raw) {
    // What is under the cursor is what the menu is about.
    SelectionState selection;
    const PictureProbe& probe = m_overlay->probe();
    selection.annotation = probe.annotationAt(*raw);
    if (!selection.annotation) selection.stakePoint = probe.stakePointAt(*raw, 10.0 / m_overlay->zoom());
    if (const auto element = probe.elementAt(*raw);
        element && !selection.annotation && selection.stakePoint.empty())
      selection.design = element->design, selection.element = element->element;
    m_session->select(selection);
  }
  auto* menu = new QMenu(this);
  menu->setAttribute(Qt::WA_DeleteOnClose);
  const SelectionState& selection = m_session->selection();
  if (const DesignModel* model = m_session->model(selection.design); model && selection.element >= 0) {
    menu->addSection(text(model->elements[static_cast<std::size_t>(selection.element)].name));
    menu->addAction(a[C::HideSelected]);
    menu->addAction(a[C::IsolateStorey]);
  }
  if (selection.annotation) menu->addAction(a[C::Delete]);
  menu->addAction(a[C::ShowAllElements]);
  if (raw) {
    menu->addSeparator();
    menu->addAction(a[C::CopyCoordinates]);
    for (const Command c : {C::ToolMeasure, C::ToolText, C::ToolArrow, C::ToolCallout}) menu->addAction(a[c]);
    menu->addSeparator();
    menu->addAction(a[C::Fit]);
    menu->addAction(a[C::ExportPicture]);
  } else {
    menu->addAction(a[C::FitScene]);
    menu->addAction(a[C::LookFromFrame]);
  }
  menu->popup(globalPosition);
}

void MainWindow::showKeys() {
  auto* page = new KeysPage(this);
  page->show();
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <map>
#include <vector>

#include <QObject>

class QAction;
class QActionGroup;
class QWidget;

namespace alidade {

/// Every command of the window.
enum class Command {
  NewProject,
  OpenProject,
  AddFiles,
  OpenSample,
  Save,
  SaveAs,
  CloseProject,
  ExportPicture,
  Quit,
  Undo,
  Redo,
  Delete,
  CopyCoordinates,
  CommandPalette,
  ShowOverlay,
  ShowScene,
  ShowBoth,
  FloatScene,
  CycleView,
  Fit,
  ActualSize,
  ZoomIn,
  ZoomOut,
  CycleHidden,
  PassImage,
  PassDepth,
  PassDesign,
  PassPoints,
  GrayscaleImage,
  StakePoints,
  Labels,
  RawPicture,
  ShowMessages,
  ShowPoints,
  ShowCleaning,
  CleanScan,
  RegisterScan,
  ShowClock,
  ShowMount,
  ThemeDark,
  ThemeLight,
  ThemeContrast,
  ResetLayout,
  PreviousFrame,
  NextFrame,
  PreviousTen,
  NextTen,
  FirstFrame,
  LastFrame,
  Play,
  ToolSelect,
  ToolPick,
  ToolMeasure,
  ToolArrow,
  ToolText,
  ToolCallout,
  Resection,
  AutoAlign,
  AlignSequence,
  RefinePose,
  AcceptPose,
  DropPose,
  CalibrateCamera,
  LookFromFrame,
  FitScene,
  HideSelected,
  ShowAllElements,
  IsolateStorey,
  ClearSelection,
  ClearMeasurements,
  Keys,
  About
};

/// One row of the table: what a command is called, how it looks, which key it has, what it does.
struct ActionSpec {
  Command command;
  const char* name;      ///< objectName: for tests and settings
  const char* text;      ///< menu text
  const char* icon;      ///< of resources/icons; "" for none
  const char* shortcut;  ///< QKeySequence text; "" for none
  const char* tip;       ///< what it does; the key is added by itself
  bool checkable = false;
};
const std::vector<ActionSpec>& actionTable();

/// The QActions made from the table. Tools and views are exclusive groups.
class Actions : public QObject {
  Q_OBJECT

 public:
  explicit Actions(QWidget* window);
  QAction* operator[](Command command) const { return m_actions.at(command); }
  const std::map<Command, QAction*>& all() const { return m_actions; }

 private:
  void group(std::initializer_list<Command> commands);
  std::map<Command, QAction*> m_actions;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/actions.h"

#include <QAction>
#include <QActionGroup>
#include <QKeySequence>
#include <QWidget>

#include "ui/theme.h"

namespace alidade {

const std::vector<ActionSpec>& actionTable() {
  using C = Command;
  static const std::vector<ActionSpec> table = {
      {C::NewProject, "newProject", "New project", "new", "Ctrl+N", "Starts an empty project"},
      {C::OpenProject, "openProject", "Open…", "open", "Ctrl+O",
       "Opens a project, or scans, pictures and designs as a new one"},
      {C::AddFiles, "addFiles", "Add files…", "add", "Ctrl+Shift+O",
       "Adds scans, pictures, cameras, designs or points to the project"},
      {C::OpenSample, "openSample", "Open sample inspection", "sample", "",
       "Makes a small synthetic site once and opens it"},
      {C::Save, "save", "Save", "save", "Ctrl+S", "Saves the project"},
      {C::SaveAs, "saveAs", "Save as…", "", "Ctrl+Shift+S", "Saves the project under another name"},
      {C::CloseProject, "closeProject", "Close project", "", "Ctrl+W",
       "Closes the project and shows the start page"},
      {C::ExportPicture, "exportPicture", "Export picture…", "export", "Ctrl+E",
       "Shows the picture with its title block and saves it"},
      {C::Quit, "quit", "Quit", "quit", "Ctrl+Q", "Leaves Alidade"},
      {C::Undo, "undo", "Undo", "undo", "Ctrl+Z", "Takes the last change back"},
      {C::Redo, "redo", "Redo", "redo", "Ctrl+Y", "Makes the change that was taken back again"},
      {C::Delete, "delete", "Delete annotation", "delete", "Del", "Deletes the selected annotation"},
      {C::CopyCoordinates, "copyCoordinates", "Copy coordinates", "copy", "Ctrl+Shift+C",
       "Copies E, N, H of the point last under the cursor"},
      {C::CommandPalette, "commandPalette", "Find a command…", "palette", "Ctrl+K",
       "Finds any command by its name"},
      {C::ShowOverlay, "showOverlay", "Overlay", "overlay", "", "Shows the picture with the design on it",
       true},
      {C::ShowScene, "showScene", "3D", "scene", "", "Shows the site in 3D", true},
      {C::ShowBoth, "showBoth", "Both", "both", "", "Shows the picture and the site side by side", true},
      {C::FloatScene, "floatScene", "3D in its own window", "panel", "F11",
       "Takes the 3D view out, for a second screen; closing it puts it back", true},
      {C::CycleView, "cycleView", "Next view", "", "Tab", "Goes from overlay to 3D to both"},
      {C::Fit, "fit", "Fit", "fit", "F", "Fits the picture into the view"},
      {C::ActualSize, "actualSize", "Actual size", "actual", "Ctrl+0",
       "Shows one picture pixel as one screen pixel"},
      {C::ZoomIn, "zoomIn", "Zoom in", "", "Ctrl++", "Zooms in on the middle"},
      {C::ZoomOut, "zoomOut", "Zoom out", "", "Ctrl+-", "Zooms out"},
      {C::CycleHidden, "cycleHidden", "Hidden parts", "hidden", "H",
       "Draws what the scan hides as ghost, dashed, or not at all"},
      {C::PassImage, "passImage", "Camera picture", "", "1", "Draws the camera's picture", true},
      {C::PassDepth, "passDepth", "Hiding by the scan", "", "2", "Lets the scan hide the design", true},
      {C::PassDesign, "passDesign", "Design", "", "3", "Draws the design", true},
      {C::PassPoints, "passPoints", "Scan points", "", "4", "Draws the scan's points in their own colour",
       true},
      {C::GrayscaleImage, "grayscaleImage", "Picture in grey", "", "G",
       "Draws the picture in grey, so that the design stands out", true},
      {C::StakePoints, "stakePoints", "Stake-out points", "stake", "",
       "Draws stake-out points and their tolerance circles", true},
      {C::Labels, "labels", "Labels", "", "L", "Writes names beside points", true},
      {C::RawPicture, "rawPicture", "Raw picture only", "raw", "",
       "Shows the picture as the camera saw it (hold R)", true},
      {C::ShowMessages, "showMessages", "Messages", "messages", "Ctrl+M",
       "Shows what happened, with details to copy", true},
      {C::ShowPoints, "showPoints", "Points", "scan", "Ctrl+Shift+P",
       "Shows how the scan's points are coloured, filtered and cut"},
      {C::ShowCleaning, "showCleaning", "Clean scans…", "scan", "",
       "Shows how a scan is thinned, cleaned, classified and fitted to another one"},
      {C::CleanScan, "cleanScan", "Clean the scan", "", "", "Cleans the scan that the panel names, as it is ticked there"},
      {C::RegisterScan, "registerScan", "Register the scan", "", "", "Fits the scan that the panel names to the one that stays"},
      {C::ShowClock, "showClock", "Clock", "", "",
       "Shows how pictures and poses agree in time: clock offset, row read-out"},
      {C::ShowMount, "showMount", "Camera mount", "camera", "",
       "Shows where the camera sits on the body that carries it, and sets it"},
      {C::ThemeDark, "themeDark", "Dark", "", "", "Neutral dark grey, so that the picture is judged fairly",
       true},
      {C::ThemeLight, "themeLight", "Light", "", "", "Light surroundings", true},
      {C::ThemeContrast, "themeContrast", "High contrast", "", "", "Black, white and yellow", true},
      {C::ResetLayout, "resetLayout", "Reset layout", "panel", "", "Puts all panels back in their places"},
      {C::PreviousFrame, "previousFrame", "Previous frame", "previous", "Left", "Goes one frame back"},
      {C::NextFrame, "nextFrame", "Next frame", "next", "Right", "Goes one frame on"},
      {C::PreviousTen, "previousTen", "Ten frames back", "", "Shift+Left", "Goes ten frames back"},
      {C::NextTen, "nextTen", "Ten frames on", "", "Shift+Right", "Goes ten frames on"},
      {C::FirstFrame, "firstFrame", "First frame", "", "Home", "Goes to the first frame"},
      {C::LastFrame, "lastFrame", "Last frame", "", "End", "Goes to the last frame"},
      {C::Play, "play", "Play", "play", "", "Plays at the camera's rate, or stops (Space)", true},
      {C::ToolSelect, "toolSelect", "Select", "select", "S",
       "Selects design elements, stake-out points and annotations", true},
      {C::ToolPick, "toolPick", "Pick", "pick", "K",
       "Reads the scanned point under the cursor, with a magnifier", true},
      {C::ToolMeasure, "toolMeasure", "Measure", "measure", "M",
       "Measures the distance between two scanned points", true},
      {C::ToolArrow, "toolArrow", "Arrow", "arrow", "A", "Draws an arrow to a point", true},
      {C::ToolText, "toolText", "Text", "text", "T", "Writes a text at a point", true},
      {C::ToolCallout, "toolCallout", "Callout", "callout", "C",
       "Writes a text in a box that points at something", true},
      {C::Resection, "resection", "Refine pose from points…", "align", "Ctrl+R",
       "Opens the panel where picked points refine this frame's pose", true},
      {C::AutoAlign, "autoAlign", "Align with scan or design automatically", "align", "Ctrl+Shift+R",
       "Finds this frame's pose from the picture and the scan, or the design where there is no scan"},
      {C::AlignSequence, "alignSequence", "Align all frames together", "align", "",
       "Aligns all frames and adjusts them together; warns where a camera that stood still was moved"},
      {C::RefinePose, "refinePose", "Refine", "align", "Ctrl+Return",
       "Solves for the pose that fits the picked points"},
      {C::AcceptPose, "acceptPose", "Accept pose", "pass", "", "Keeps the refined pose"},
      {C::DropPose, "dropPose", "Drop pose", "cancel", "", "Goes back to the pose before the refinement"},
      {C::CalibrateCamera, "calibrateCamera", "Calibrate camera…", "camera", "",
       "Finds a camera's lens from pictures of a chessboard or ChArUco board"},
      {C::LookFromFrame, "lookFromFrame", "Look from this frame", "camera", "Shift+L",
       "Moves the 3D view to the camera of this frame"},
      {C::FitScene, "fitScene", "Fit site in 3D", "fit", "Shift+F", "Shows the whole site in 3D"},
      {C::HideSelected, "hideSelected", "Hide selected element", "hidden", "Shift+H",
       "Hides the selected design element"},
      {C::ShowAllElements, "showAllElements", "Show all elements", "", "Ctrl+Shift+H",
       "Shows every design element again"},
      {C::IsolateStorey, "isolateStorey", "Show only this storey", "storey", "",
       "Hides all elements but those of the selected one's storey"},
      {C::ClearSelection, "clearSelection", "Clear selection", "", "Esc",
       "Leaves the tool, then clears the selection"},
      {C::ClearMeasurements, "clearMeasurements", "Clear measurements", "", "",
       "Removes all measured distances from the view"},
      {C::Keys, "keys", "Keys and mouse", "help", "F1", "Lists every key"},
      {C::About, "about", "About Alidade", "", "", "Says which version this is"},
  };
  return table;
}

Actions::Actions(QWidget* window) : QObject(window) {
  for (const ActionSpec& spec : actionTable()) {
    auto* action = new QAction(tr(spec.text), window);
    action->setObjectName(QString::fromLatin1(spec.name));
    if (*spec.icon) action->setIcon(icon(QString::fromLatin1(spec.icon)));
    if (*spec.shortcut) action->setShortcut(QKeySequence(QString::fromLatin1(spec.shortcut)));
    action->setCheckable(spec.checkable);
    const QString key = action->shortcut().toString(QKeySequence::NativeText);
    action->setToolTip(key.isEmpty() ? tr(spec.tip) : QStringLiteral("%1 (%2)").arg(tr(spec.tip), key));
    action->setStatusTip(QString());
    window->addAction(action);
    m_actions[spec.command] = action;
  }
  m_actions[Command::Redo]->setShortcuts({QKeySequence(QStringLiteral("Ctrl+Y")), QKeySequence::Redo});
  m_actions[Command::Delete]->setShortcuts({QKeySequence(Qt::Key_Delete), QKeySequence(Qt::Key_Backspace)});
  group({Command::ToolSelect, Command::ToolPick, Command::ToolMeasure, Command::ToolArrow, Command::ToolText,
         Command::ToolCallout});
  group({Command::ShowOverlay, Command::ShowScene, Command::ShowBoth});
  group({Command::ThemeDark, Command::ThemeLight, Command::ThemeContrast});
}

void Actions::group(std::initializer_list<Command> commands) {
  auto* group = new QActionGroup(this);
  for (const Command command : commands) group->addAction(m_actions[command]);
}

}  // namespace alidade

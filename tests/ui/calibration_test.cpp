// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <QAction>
#include <QComboBox>
#include <QFileInfo>
#include <QLabel>
#include <QPushButton>

#include "ui/calibration_dialog.h"
#include "ui/window_fixture.h"

namespace alidade::test {

TEST_F(OpenWindow, ACameraIsCalibratedAcceptedIntoTheProjectAndUndone) {
  const QString folder = QStringLiteral(ALIDADE_SHARED_DATA_DIR "/calib_chessboard_8x6/calibration_wide/");
  if (!QFileInfo::exists(folder)) GTEST_SKIP() << "SKIPPED: " << folder.toStdString() << " is not there";
  window->actions()[Command::CalibrateCamera]->trigger();
  CalibrationDialog* dialog = window->calibrationDialog();
  ASSERT_NE(dialog, nullptr);
  QStringList pictures;
  for (const int number : {32, 38, 40, 43, 53, 64, 66, 68}) pictures << folder + QStringLiteral("GOPR00%1.jpg").arg(number);
  dialog->addPictures(pictures);
  dialog->setBoard({BoardKind::Chessboard, 8, 6, 0.025, 0, {}});
  auto* start = dialog->findChild<QPushButton*>("calibrationStart");
  auto* accept = dialog->findChild<QPushButton*>("calibrationAccept");
  auto* state = dialog->findChild<QLabel*>("calibrationState");
  ASSERT_TRUE(start && accept && state);
  EXPECT_FALSE(accept->isEnabled());
  start->click();
  ASSERT_TRUE(waitFor([&] { return !dialog->running(); }, 300'000));
  ASSERT_TRUE(dialog->outcome()) << state->text().toStdString();
  const CalibrationSummary& summary = dialog->outcome()->summary;
  ASSERT_TRUE(summary.converged) << summary.reason;
  EXPECT_NEAR(summary.intrinsics.fx, 560, 12);

  // The demo's camera takes pictures of another size: it is left as it is, and the dialog says so.
  const std::size_t cameras = session().project()->cameras.size();
  accept->click();
  EXPECT_NE(state->text().indexOf("takes pictures of"), -1) << state->text().toStdString();
  auto* name = dialog->findChildren<QComboBox*>().back();
  for (QComboBox* box : dialog->findChildren<QComboBox*>())
    if (box->isEditable()) name = box;
  name->setCurrentText(QStringLiteral("gopro"));
  accept->click();
  ASSERT_EQ(session().project()->cameras.size(), cameras + 1);
  EXPECT_EQ(session().project()->cameras.back().name, "gopro");
  EXPECT_EQ(session().project()->cameras.back().camera.intrinsics().fx, summary.intrinsics.fx);
  session().undo().undo();
  EXPECT_EQ(session().project()->cameras.size(), cameras);
}

}  // namespace alidade::test

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <memory>
#include <optional>

#include <QDialog>

#include "app/calibrate.h"
#include "ui/session.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QListWidget;
class QPlainTextEdit;
class QPushButton;
class QSpinBox;
class QTabWidget;

namespace alidade {

/// Calibrates a camera from pictures of a board: what goes in on the left, what came out on the right, kept in the
/// project (with undo), in a calibration file or in a report. Not modal; the work runs as a job.
class CalibrationDialog : public QDialog {
  Q_OBJECT

 public:
  explicit CalibrationDialog(Session& session, QWidget* parent = nullptr);

  void addPictures(const QStringList& paths);  ///< files, or folders
  void setBoard(const Board& board);
  Board board() const;
  void setModel(CameraModel model);
  void start();
  void accept() override;  ///< gives the calibration to the project
  bool running() const { return m_job != 0; }
  const std::shared_ptr<const CalibrationOutcome>& outcome() const { return m_outcome; }

 signals:
  void finished();

 protected:
  void resizeEvent(QResizeEvent* event) override;
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  QWidget* buildInputs();
  QWidget* buildResults();
  void refresh();
  void refillCameras();
  void showOutcome(Result<CalibrationOutcome> result);
  void drawPlots();
  void saveCalibration();
  void saveReport();
  CalibrationJob job() const;

  Session& m_session;
  QListWidget* m_pictures;
  QComboBox *m_kind, *m_dictionary, *m_model, *m_camera;
  QSpinBox *m_columns, *m_rows;
  QDoubleSpinBox *m_square, *m_marker;
  QPushButton *m_start, *m_accept, *m_saveFile, *m_saveReport;
  QTabWidget* m_tabs;
  QPlainTextEdit* m_figures;
  std::array<QLabel*, 3> m_plots{};
  QLabel* m_state;
  int m_job = 0;
  std::shared_ptr<const CalibrationOutcome> m_outcome;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/calibration_dialog.h"

#include <algorithm>

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QFontDatabase>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QPlainTextEdit>
#include <QPointer>
#include <QPushButton>
#include <QSettings>
#include <QSpinBox>
#include <QTabWidget>
#include <QVBoxLayout>

#include "app/version.h"
#include "io/calibration_writer.h"
#include "report/calibration_plots.h"
#include "report/calibration_report.h"
#include "ui/figure_spin.h"
#include "ui/format.h"
#include "ui/theme.h"

namespace alidade {

namespace {

constexpr CalibrationPlot kPlots[] = {CalibrationPlot::Residuals, CalibrationPlot::Radial, CalibrationPlot::Coverage};

QSpinBox* countBox(int value) {
  auto* box = new QSpinBox;
  box->setRange(3, 100);
  box->setValue(value);
  return box;
}

QDoubleSpinBox* lengthBox(double millimetres) {
  auto* box = new FigureSpin;
  box->setRange(0.1, 10000);
  box->setDecimals(2);
  box->setSuffix(QStringLiteral(" mm"));
  box->setValue(millimetres);
  return box;
}

}  // namespace

CalibrationDialog::CalibrationDialog(Session& session, QWidget* parent) : QDialog(parent), m_session(session) {
  setObjectName(QStringLiteral("calibrationDialog"));
  setAttribute(Qt::WA_DeleteOnClose);
  setWindowTitle(tr("Calibrate camera"));
  resize(1120, 720);
  auto* layout = new QHBoxLayout(this);
  layout->addWidget(buildInputs());
  layout->addWidget(buildResults(), 1);
  connect(&session, &Session::projectChanged, this, &CalibrationDialog::refillCameras);
  refillCameras();
  refresh();
}

QWidget* CalibrationDialog::buildInputs() {
  auto* side = new QWidget;
  side->setFixedWidth(330);
  auto* layout = new QVBoxLayout(side);
  layout->setContentsMargins(0, 0, 8, 0);
  layout->addWidget(new QLabel(tr("Pictures of the board, or folders of them")));
  m_pictures = new QListWidget;
  m_pictures->setObjectName(QStringLiteral("calibrationPictures"));
  m_pictures->setSelectionMode(QAbstractItemView::ExtendedSelection);
  layout->addWidget(m_pictures, 1);
  auto* buttons = new QHBoxLayout;
  auto* files = new QPushButton(tr("Add pictures…"));
  auto* folder = new QPushButton(tr("Add folder…"));
  auto* remove = new QPushButton(tr("Remove"));
  for (QPushButton* button : {files, folder, remove}) buttons->addWidget(button);
  layout->addLayout(buttons);
  const auto startFolder = [] { return QSettings().value(QStringLiteral("openFolder")).toString(); };
  connect(files, &QPushButton::clicked, this, [this, startFolder] {
    addPictures(QFileDialog::getOpenFileNames(this, tr("Pictures of the board"), startFolder(),
                                              tr("Pictures (*.jpg *.jpeg *.png *.tif *.tiff *.bmp *.webp);;All files (*)")));
  });
  connect(folder, &QPushButton::clicked, this, [this, startFolder] {
    const QString path = QFileDialog::getExistingDirectory(this, tr("Folder with pictures of the board"), startFolder());
    if (!path.isEmpty()) addPictures({path});
  });
  connect(remove, &QPushButton::clicked, this, [this] {
    qDeleteAll(m_pictures->selectedItems());
    refresh();
  });

  auto* form = new QFormLayout;
  m_kind = new QComboBox;
  m_kind->addItems({tr("Chessboard"), tr("ChArUco board")});
  m_columns = countBox(8);
  m_rows = countBox(6);
  m_square = lengthBox(25);
  m_marker = lengthBox(18);
  m_dictionary = new QComboBox;
  for (const std::string& name : markerDictionaries()) m_dictionary->addItem(text(name));
  m_dictionary->setCurrentText(QStringLiteral("DICT_5X5_100"));
  m_model = new QComboBox;
  m_model->setObjectName(QStringLiteral("calibrationModel"));
  for (int i = 0; i <= static_cast<int>(CameraModel::BrownSkewed); ++i)
    m_model->addItem(QString::fromUtf8(cameraModelName(static_cast<CameraModel>(i)).data()), i);
  setModel(CameraModel::OpenCv5);
  form->addRow(tr("Board"), m_kind);
  form->addRow(tr("Columns"), m_columns);
  form->addRow(tr("Rows"), m_rows);
  form->addRow(tr("Square"), m_square);
  form->addRow(tr("Marker"), m_marker);
  form->addRow(tr("Dictionary"), m_dictionary);
  form->addRow(tr("Camera model"), m_model);
  layout->addLayout(form);
  connect(m_kind, &QComboBox::currentIndexChanged, this, &CalibrationDialog::refresh);
  m_start = new QPushButton(tr("Calibrate"));
  m_start->setObjectName(QStringLiteral("calibrationStart"));
  m_start->setDefault(true);
  connect(m_start, &QPushButton::clicked, this, &CalibrationDialog::start);
  layout->addWidget(m_start);
  return side;
}

QWidget* CalibrationDialog::buildResults() {
  auto* side = new QWidget;
  auto* layout = new QVBoxLayout(side);
  layout->setContentsMargins(0, 0, 0, 0);
  m_tabs = new QTabWidget;
  m_figures = new QPlainTextEdit;
  m_figures->setReadOnly(true);
  m_figures->setLineWrapMode(QPlainTextEdit::NoWrap);
  m_figures->setFont(QFontDatabase::systemFont(QFontDatabase::FixedFont));
  m_figures->setPlaceholderText(tr("Take 10 to 20 pictures with the board tilted by 20° to 45° to all sides, at the edges and in the "
                                   "corners of the picture, too"));
  m_tabs->addTab(m_figures, tr("Figures"));
  const QString names[] = {tr("Residuals"), tr("Along the radius"), tr("Coverage")};
  for (std::size_t i = 0; i < m_plots.size(); ++i) {
    m_plots[i] = new QLabel;
    m_plots[i]->setAlignment(Qt::AlignCenter);
    m_plots[i]->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Ignored);
    m_plots[i]->installEventFilter(this);
    m_tabs->addTab(m_plots[i], names[i]);
  }
  layout->addWidget(m_tabs, 1);
  m_state = new QLabel;
  m_state->setObjectName(QStringLiteral("calibrationState"));
  m_state->setWordWrap(true);
  layout->addWidget(m_state);
  auto* row = new QHBoxLayout;
  row->addWidget(new QLabel(tr("Camera")));
  m_camera = new QComboBox;
  m_camera->setEditable(true);
  m_camera->setMinimumWidth(160);
  row->addWidget(m_camera);
  m_accept = new QPushButton(tr("Accept into project"));
  m_accept->setObjectName(QStringLiteral("calibrationAccept"));
  m_saveFile = new QPushButton(tr("Save calibration…"));
  m_saveReport = new QPushButton(tr("Save report…"));
  auto* close = new QPushButton(tr("Close"));
  row->addWidget(m_accept);
  row->addStretch(1);
  for (QPushButton* button : {m_saveFile, m_saveReport, close}) row->addWidget(button);
  layout->addLayout(row);
  connect(m_accept, &QPushButton::clicked, this, &CalibrationDialog::accept);
  connect(m_saveFile, &QPushButton::clicked, this, &CalibrationDialog::saveCalibration);
  connect(m_saveReport, &QPushButton::clicked, this, &CalibrationDialog::saveReport);
  connect(close, &QPushButton::clicked, this, &QDialog::reject);
  return side;
}

void CalibrationDialog::addPictures(const QStringList& paths) {
  for (const QString& path : paths) {
    auto* item = new QListWidgetItem(QFileInfo(path).fileName(), m_pictures);
    item->setData(Qt::UserRole, path);
    item->setToolTip(path);
  }
  if (!paths.isEmpty()) QSettings().setValue(QStringLiteral("openFolder"), QFileInfo(paths.front()).absolutePath());
  refresh();
}

void CalibrationDialog::setBoard(const Board& board) {
  m_kind->setCurrentIndex(board.kind == BoardKind::Charuco ? 1 : 0);
  m_columns->setValue(board.columns);
  m_rows->setValue(board.rows);
  m_square->setValue(1000 * board.squareM);
  if (board.kind == BoardKind::Chessboard) return;
  m_marker->setValue(1000 * board.markerM);
  m_dictionary->setCurrentText(text(board.dictionary));
}

Board CalibrationDialog::board() const {
  Board board;
  board.kind = m_kind->currentIndex() == 1 ? BoardKind::Charuco : BoardKind::Chessboard;
  board.columns = m_columns->value(), board.rows = m_rows->value();
  board.squareM = m_square->value() / 1000;
  if (board.kind == BoardKind::Charuco) {
    board.markerM = m_marker->value() / 1000;
    board.dictionary = m_dictionary->currentText().toStdString();
  }
  return board;
}

void CalibrationDialog::setModel(CameraModel model) {
  m_model->setCurrentIndex(m_model->findData(static_cast<int>(model)));
}

CalibrationJob CalibrationDialog::job() const {
  CalibrationJob job;
  for (int i = 0; i < m_pictures->count(); ++i) job.pictures.push_back(m_pictures->item(i)->data(Qt::UserRole).toString().toStdString());
  job.board = board();
  job.options.model = static_cast<CameraModel>(m_model->currentData().toInt());
  return job;
}

void CalibrationDialog::start() {
  if (running()) {
    m_session.jobs().cancel(m_job);
    return;
  }
  const CalibrationJob wanted = job();
  // The words on the command line know what a board cannot be.
  if (const auto possible = Board::parse(wanted.board.text()); !possible) {
    m_state->setText(errorText(possible.error()));
    return;
  }
  m_outcome.reset();
  m_figures->clear();
  drawPlots();
  const QPointer<CalibrationDialog> self(this);
  Session* const session = &m_session;
  m_job = m_session.jobs().run(
      tr("Calibrating the camera"), [wanted](const Progress& progress) { return calibrate(wanted, progress); },
      [self, session](Result<CalibrationOutcome> result) {
        if (!result && !isCancelled(result.error())) session->messages().error(result.error(), tr("calibrating the camera"));
        if (self) self->showOutcome(std::move(result));
      });
  m_state->setText(tr("Looking for the board…"));
  refresh();
}

void CalibrationDialog::showOutcome(Result<CalibrationOutcome> result) {
  m_job = 0;
  if (!result) {
    m_state->setText(errorText(result.error()));
  } else {
    m_outcome = std::make_shared<const CalibrationOutcome>(std::move(*result));
    const CalibrationSummary& s = m_outcome->summary;
    std::string figures = s.report();
    for (const std::string& line : m_outcome->leftOut) figures += "  left out: " + line + "\n";
    m_figures->setPlainText(reportText(figures));
    m_state->setText(s.converged ? tr("%1 px rms over %2 pictures, %3 px for pictures left out")
                                       .arg(s.rmsPx, 0, 'f', 3)
                                       .arg(s.pictures.size())
                                       .arg(s.heldOutRmsPx ? QString::number(*s.heldOutRmsPx, 'f', 3) : QStringLiteral("–"))
                                 : tr("Refused: %1").arg(text(s.reason)));
  }
  drawPlots();
  refresh();
  emit finished();
}

void CalibrationDialog::drawPlots() {
  const double ratio = devicePixelRatioF();
  for (std::size_t i = 0; i < m_plots.size(); ++i) {
    if (!m_outcome || !m_outcome->summary.converged) {
      m_plots[i]->clear();
      continue;
    }
    const QSize size = m_plots[i]->size() * ratio;
    if (m_tabs->currentWidget() != m_plots[i] || size.isEmpty()) continue;
    const PlotGround ground = currentTheme() == Theme::Light ? PlotGround::Paper : PlotGround::Dark;
    const ColourImage image = calibrationPicture(kPlots[i], m_outcome->summary, size.width(), size.height(), ground);
    QPixmap pixmap = QPixmap::fromImage(QImage(reinterpret_cast<const uchar*>(image.data()), image.width(), image.height(),
                                               image.width() * 4, QImage::Format_RGBA8888));
    pixmap.setDevicePixelRatio(ratio);
    m_plots[i]->setPixmap(pixmap);
  }
}

void CalibrationDialog::resizeEvent(QResizeEvent* event) {
  QDialog::resizeEvent(event);
  drawPlots();
}

bool CalibrationDialog::eventFilter(QObject* watched, QEvent* event) {
  if (event->type() == QEvent::Show || event->type() == QEvent::Resize) drawPlots();
  return QDialog::eventFilter(watched, event);
}

void CalibrationDialog::refresh() {
  const bool charuco = m_kind->currentIndex() == 1;
  m_marker->setEnabled(charuco);
  m_dictionary->setEnabled(charuco);
  const QString unit = charuco ? tr(" squares") : tr(" inner corners");
  m_columns->setSuffix(unit);
  m_rows->setSuffix(unit);
  m_start->setText(running() ? tr("Cancel") : tr("Calibrate"));
  m_start->setEnabled(running() || m_pictures->count() > 0);
  const bool converged = m_outcome && m_outcome->summary.converged;
  m_accept->setEnabled(converged && m_session.hasProject());
  m_saveFile->setEnabled(converged);
  m_saveReport->setEnabled(m_outcome != nullptr);
}

void CalibrationDialog::refillCameras() {
  const QString chosen = m_camera->currentText();
  QStringList names;
  for (const CameraRecord& record : m_session.project()->cameras)
    if (!names.contains(text(record.name))) names << text(record.name);
  if (names.isEmpty()) names << tr("calibrated");
  m_camera->clear();
  m_camera->addItems(names);
  m_camera->setCurrentText(chosen.isEmpty() ? names.front() : chosen);
  refresh();
}

void CalibrationDialog::accept() {
  if (!m_outcome || !m_outcome->summary.converged) return;
  const std::string camera = m_camera->currentText().trimmed().toStdString();
  const Intrinsics& intrinsics = m_outcome->summary.intrinsics;
  Project trial = *m_session.project();
  if (const auto possible = keepCalibration(trial, intrinsics, camera); !possible) {
    m_state->setText(errorText(possible.error()));
    return;
  }
  m_session.change(tr("Calibrate %1").arg(text(camera)),
                   [&](Project& project) { (void)keepCalibration(project, intrinsics, camera); });
  m_state->setText(tr("The project's camera %1 has this calibration now").arg(text(camera)));
}

void CalibrationDialog::saveCalibration() {
  const QString path = QFileDialog::getSaveFileName(this, tr("Save calibration"), QStringLiteral("calibration.yml"),
                                                    tr("OpenCV (*.yml *.xml *.json);;COLMAP (*.txt)"));
  if (path.isEmpty() || !m_outcome) return;
  const CalibrationSummary& s = m_outcome->summary;
  const auto saved = writeCalibration(s.intrinsics, {s.rmsPx, static_cast<int>(s.pictures.size())}, path.toStdString());
  m_state->setText(saved ? tr("Saved %1").arg(path) : errorText(saved.error()));
}

void CalibrationDialog::saveReport() {
  const QString path = QFileDialog::getSaveFileName(this, tr("Save report"), QStringLiteral("calibration.pdf"),
                                                    tr("Reports (*.pdf *.html *.png)"));
  if (path.isEmpty() || !m_outcome) return;
  const CalibrationReport report{tr("Calibration of %1").arg(m_camera->currentText()).toStdString(), std::string(softwareName()),
                                 m_outcome->board.text(), m_outcome->leftOut, m_outcome->summary};
  const auto saved = writeCalibrationReport(report, path.toStdString());
  m_state->setText(saved ? tr("Saved %1").arg(path) : errorText(saved.error()));
}

}  // namespace alidade

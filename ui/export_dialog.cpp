// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/export_dialog.h"

#include <algorithm>
#include <cmath>

#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QPointer>
#include <QSettings>
#include <QStandardPaths>

#include "report/picture_export.h"
#include "ui/format.h"
#include "ui_export_dialog.h"

namespace alidade {

namespace {

QImage copyOf(const ColourImage& image) {
  return QImage(reinterpret_cast<const uchar*>(image.data()), image.width(), image.height(),
                image.width() * 4, QImage::Format_RGBX8888)
      .copy();
}

QString proposedPath(const Session& session) {
  const QString folder = QSettings()
                             .value(QStringLiteral("exportFolder"),
                                    QStandardPaths::writableLocation(QStandardPaths::PicturesLocation))
                             .toString();
  const Frame* frame = session.currentFrame();
  const QString name = QStringLiteral("%1 %2.png")
                           .arg(text(session.project()->name),
                                frame ? QFileInfo(text(frame->name)).completeBaseName() : QString());
  return QDir(folder).filePath(name.simplified().replace('/', '-'));
}

}  // namespace

ExportDialog::ExportDialog(Session& session, QWidget* parent)
    : QDialog(parent), m_session(session), m_form(std::make_unique<Ui::ExportDialogForm>()) {
  setObjectName(QStringLiteral("exportDialog"));
  setAttribute(Qt::WA_DeleteOnClose);
  m_form->setupUi(this);
  setWindowTitle(tr("Export picture"));
  resize(900, 760);
  m_form->size->addItem(tr("As the camera's"), 0);
  for (const int width : {1280, 1920, 3840}) m_form->size->addItem(tr("%1 px wide").arg(width), width);
  m_form->path->setText(proposedPath(session));
  connect(m_form->size, &QComboBox::currentIndexChanged, this, &ExportDialog::requestPreview);
  connect(m_form->bare, &QCheckBox::toggled, this, &ExportDialog::requestPreview);
  connect(m_form->browse, &QPushButton::clicked, this, &ExportDialog::browse);
  connect(m_form->close, &QPushButton::clicked, this, &QDialog::reject);
  connect(m_form->save, &QPushButton::clicked, this, &ExportDialog::save);
  connect(&session, &Session::projectChanged, this, &ExportDialog::requestPreview);
  connect(&session, &Session::displayChanged, this, &ExportDialog::requestPreview);
  connect(&session, &Session::frameChanged, this, &ExportDialog::requestPreview);
  requestPreview();
}

ExportDialog::~ExportDialog() = default;

QSize ExportDialog::wantedSize() const {
  const CameraRecord* camera = m_session.currentCamera();
  if (!camera || camera->camera.width() <= 0) return {};
  const int width = m_form->size->currentData().toInt();
  if (width == 0) return {camera->camera.width(), camera->camera.height()};
  return {width, std::max(1, static_cast<int>(std::lround(1.0 * width * camera->camera.height() /
                                                          camera->camera.width())))};
}

void ExportDialog::requestPreview() {
  const QSize size = wantedSize();
  const int serial = ++m_serial;
  m_form->save->setEnabled(false);
  if (size.isEmpty()) {
    m_form->state->setText(tr("This frame has no camera, so there is nothing to export"));
    return;
  }
  m_form->state->setText(tr("Rendering…"));
  auto project = std::make_shared<const Project>(m_session.projectToSave());
  const auto data = m_session.data();
  const FrameId frame = m_session.frame();
  const bool bare = m_form->bare->isChecked();
  const QPointer<ExportDialog> self(this);
  Session* const session = &m_session;
  m_session.renderLoop().runOnThread([=](OverlayRenderer& renderer, PictureCache& pictures) {
    auto rendered = renderFrame(*project, *data, frame, {size.width(), size.height()}, renderer, pictures);
    std::shared_ptr<const RenderedFrame> shared;
    QImage preview;
    if (rendered) {
      shared = std::make_shared<const RenderedFrame>(std::move(*rendered));
      preview = copyOf(bare ? shared->picture.colour : withTitleBlock(shared->picture.colour, shared->title));
    }
    const QString problem = shared ? QString() : errorText(rendered.error());
    // The session outlives every dialog and delivers; whether this one still stands is asked there.
    QMetaObject::invokeMethod(
        session,
        [self, serial, shared, preview, problem] {
          if (!self || self->m_serial != serial) return;
          self->m_frame = shared;
          self->m_preview = preview;
          self->m_shownSerial = serial;
          self->m_form->state->setText(problem);
          self->m_form->save->setEnabled(shared != nullptr);
          self->showPreview();
        },
        Qt::QueuedConnection);
  });
}

void ExportDialog::showPreview() {
  if (m_preview.isNull()) {
    m_form->preview->clear();
    return;
  }
  const double ratio = devicePixelRatioF();
  QImage scaled =
      m_preview.scaled(m_form->preview->size() * ratio, Qt::KeepAspectRatio, Qt::SmoothTransformation);
  scaled.setDevicePixelRatio(ratio);
  m_form->preview->setPixmap(QPixmap::fromImage(scaled));
  m_form->dimensions->setText(QStringLiteral("%1 × %2 px").arg(m_preview.width()).arg(m_preview.height()));
}

void ExportDialog::resizeEvent(QResizeEvent* event) {
  QDialog::resizeEvent(event);
  showPreview();
}

void ExportDialog::browse() {
  const QString path = QFileDialog::getSaveFileName(this, tr("Export picture"), m_form->path->text(),
                                                    tr("PNG pictures (*.png)"));
  if (!path.isEmpty()) m_form->path->setText(path);
}

void ExportDialog::save() {
  QString path = m_form->path->text().trimmed();
  if (path.isEmpty() || !m_frame) return;
  if (!path.endsWith(QStringLiteral(".png"), Qt::CaseInsensitive)) path += QStringLiteral(".png");
  const auto frame = m_frame;
  const bool bare = m_form->bare->isChecked();
  m_form->state->setText(tr("Saving…"));
  const QPointer<ExportDialog> self(this);
  Session* const session = &m_session;
  m_session.jobs().run(
      tr("Saving %1").arg(QFileInfo(path).fileName()),
      [frame, path, bare](const Progress&) { return exportPicture(*frame, path.toStdString(), bare); },
      [self, session, path](Result<void> result) {
        if (!result) {
          session->messages().error(result.error(), tr("exporting the picture"));
          if (self) self->m_form->state->setText(errorText(result.error()));
          return;
        }
        QSettings().setValue(QStringLiteral("exportFolder"), QFileInfo(path).absolutePath());
        session->messages().info(tr("Saved the picture %1").arg(path));
        if (!self) return;
        self->m_form->state->setText(tr("Saved %1").arg(QFileInfo(path).fileName()));
        emit self->saved(path);
      });
}

}  // namespace alidade

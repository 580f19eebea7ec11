// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>

#include <QDialog>
#include <QImage>

#include "ui/session.h"

namespace Ui {
class ExportDialogForm;
}

namespace alidade {

/// The picture as it will be saved, title block included, before it is saved. Follows the session
/// while it stands open; rendering and writing happen on workers.
class ExportDialog : public QDialog {
  Q_OBJECT

 public:
  explicit ExportDialog(Session& session, QWidget* parent = nullptr);
  ~ExportDialog() override;
  bool previewReady() const { return m_shownSerial == m_serial && m_frame != nullptr; }

 signals:
  void saved(const QString& path);

 protected:
  void resizeEvent(QResizeEvent* event) override;

 private:
  void requestPreview();
  void showPreview();
  void save();
  void browse();
  QSize wantedSize() const;

  Session& m_session;
  std::unique_ptr<Ui::ExportDialogForm> m_form;
  std::shared_ptr<const RenderedFrame> m_frame;
  QImage m_preview;
  int m_serial = 0, m_shownSerial = 0;
};

}  // namespace alidade

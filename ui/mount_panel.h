// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>

#include <QWidget>

#include "app/camera_mount.h"
#include "ui/session.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;

namespace alidade {

/// Where the current frame's camera sits on the body that carries it, and how well that is known. Part of the work: a
/// change can be undone, and the poses on the camera's trajectory follow.
class MountPanel : public QWidget {
  Q_OBJECT

 public:
  explicit MountPanel(Session& session, QWidget* parent = nullptr);

 private:
  /// A figure with its standard deviation beside it.
  struct Pair {
    QDoubleSpinBox *value = nullptr, *std = nullptr;
  };

  void refresh();
  void fillBodies(const QString& body);
  void take();  ///< what the fields say, into the project
  MountFigures figures() const;

  Session& m_session;
  QLabel *m_camera, *m_note, *m_problem;
  CameraId m_shown;  ///< whose figures the fields have
  QCheckBox* m_on;
  QComboBox* m_body;
  QWidget* m_fields;
  std::array<Pair, 3> m_position, m_angles;
};

}  // namespace alidade

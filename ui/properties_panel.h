// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QScrollArea>

#include "ui/session.h"

class QFormLayout;
class QLabel;
class QVBoxLayout;

namespace alidade {

/// What is known of the selection, and of the current frame's pose.
class PropertiesPanel : public QScrollArea {
  Q_OBJECT

 public:
  explicit PropertiesPanel(Session& session, QWidget* parent = nullptr);

 private:
  void rebuild();
  void refreshShares();
  void showElement(const DesignModel& model, int element);
  void showStakePoint(const StakePoint& point);
  void showAnnotation(const Annotation& annotation);
  void showFrame();
  void heading(const QString& title, const QString& under = {});
  void row(const QString& name, const QString& value, const QString& objectName = {});
  void startRows();

  Session& m_session;
  QVBoxLayout* m_layout = nullptr;
  QFormLayout* m_form = nullptr;
  QWidget* m_shares = nullptr;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <vector>

#include <QScrollArea>

#include "ui/session.h"

class QFormLayout;
class QVBoxLayout;

namespace alidade {

/// A scrolling page of display settings under headings. Each setting is one row: its name, its range,
/// how it is read and written; the control follows from that and stays in step with the session.
class SettingsForm : public QScrollArea {
  Q_OBJECT

 public:
  explicit SettingsForm(Session& session, QWidget* parent = nullptr);

 protected:
  using Get = std::function<double(const DisplaySettings&)>;
  using Set = std::function<void(DisplaySettings&, double)>;
  using GetFlag = std::function<bool(const DisplaySettings&)>;
  using SetFlag = std::function<void(DisplaySettings&, bool)>;

  QFormLayout* section(const QString& title);
  void check(QFormLayout* form, const QString& name, const QString& tip, bool DisplaySettings::*member);
  void check(QFormLayout* form, const QString& name, const QString& tip, const GetFlag& get, const SetFlag& set);
  void number(QFormLayout* form, const QString& name, const QString& tip, const QString& unit, double low,
              double high, double step, int decimals, const Get& get, const Set& set);
  /// A figure without a slider, for what has no natural range: a coordinate.
  void figure(QFormLayout* form, const QString& name, const QString& tip, const QString& unit, double low,
              double high, double step, int decimals, const Get& get, const Set& set);
  void choice(QFormLayout* form, const QString& name, const QString& tip, const QStringList& names,
              const Get& get, const Set& set);
  /// Runs now and whenever the settings change.
  void follow(std::function<void(const DisplaySettings&)> refresher);
  void apply(const std::function<void(DisplaySettings&)>& edit, bool dragging = false);
  /// Ends the page; to be called once all rows are there.
  void finish();
  /// Shows the settings as they are now; for what else a control depends on.
  void refresh();

  Session& m_session;

 private:
  QVBoxLayout* m_layout = nullptr;
  std::vector<std::function<void(const DisplaySettings&)>> m_refreshers;
  bool m_refreshing = false;
};

}  // namespace alidade

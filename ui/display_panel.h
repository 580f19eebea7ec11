// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <vector>

#include <QScrollArea>

#include "ui/session.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QSlider;

namespace alidade {

/// How the frame is drawn. Each setting stands once in a table of this class with its name and range;
/// its control is made from that row.
class DisplayPanel : public QScrollArea {
  Q_OBJECT

 public:
  explicit DisplayPanel(Session& session, QWidget* parent = nullptr);

 private:
  using Get = std::function<double(const DisplaySettings&)>;
  using Set = std::function<void(DisplaySettings&, double)>;
  void check(QFormLayout* form, const QString& name, const QString& tip, bool DisplaySettings::*member);
  void number(QFormLayout* form, const QString& name, const QString& tip, const QString& unit, double low,
              double high, double step, int decimals, const Get& get, const Set& set);
  void choice(QFormLayout* form, const QString& name, const QString& tip, const QStringList& names,
              const Get& get, const Set& set);
  QFormLayout* section(const QString& title);
  void refresh();
  void apply(const std::function<void(DisplaySettings&)>& edit, bool dragging);

  Session& m_session;
  QWidget* m_page = nullptr;
  std::vector<std::function<void(const DisplaySettings&)>> m_refreshers;
  bool m_refreshing = false;
};

/// Direction the light comes from, degrees: azimuth clockwise from north, elevation above the horizon.
struct LightAngles {
  double azimuth = 0, elevation = 0;
};
LightAngles lightAngles(const glm::dvec3& travel);
glm::dvec3 lightTravel(const LightAngles& angles);

}  // namespace alidade

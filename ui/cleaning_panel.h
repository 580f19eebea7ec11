// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "ui/scan_work.h"
#include "ui/settings_form.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QSpinBox;

namespace alidade {

/// What is done to a scan as a whole: outliers, thinning, ground, fitting it to another one.
class CleaningPanel : public SettingsForm {
  Q_OBJECT

 public:
  CleaningPanel(Session& session, ScanWork& work, QWidget* parent = nullptr);

  void clean();       ///< the chosen scan, as ticked
  void registerScan();  ///< the chosen scan to the other chosen one

 private:
  void buildScan();
  void buildSteps();
  void buildRegistration();
  QDoubleSpinBox* length(QFormLayout* form, const QString& name, const QString& tip, double value, double low, double high);
  void refillScans();
  void refresh();
  ScanCleaning wanted() const;

  ScanWork& m_work;
  QComboBox *m_scan = nullptr, *m_fixed = nullptr;
  QCheckBox *m_outliers = nullptr, *m_radius = nullptr, *m_thin = nullptr, *m_ground = nullptr;
  QSpinBox *m_outlierNeighbours = nullptr, *m_radiusNeighbours = nullptr;
  QDoubleSpinBox *m_deviations = nullptr, *m_radiusMeters = nullptr, *m_voxel = nullptr, *m_window = nullptr, *m_reach = nullptr;
  QPushButton *m_clean = nullptr, *m_register = nullptr;
  QLabel* m_report = nullptr;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>

#include "cloud/point_summary.h"
#include "ui/settings_form.h"

class QDoubleSpinBox;
class QLabel;
class QListWidget;

namespace alidade {

class HistogramView;

/// How the scan's points look and which are used: colour by attribute with its range, classes, clip
/// box, section, clip planes, density and size.
class PointsPanel : public SettingsForm {
  Q_OBJECT

 public:
  explicit PointsPanel(Session& session, QWidget* parent = nullptr);

 private:
  void buildColour();
  void buildClasses();
  void buildBox();
  void buildSection();
  void buildCuts();
  void buildLook();
  void buildPace();

  void onData();
  void refreshRange(const DisplaySettings& display);
  void refreshClasses(const DisplaySettings& display);
  std::optional<ValueHistogram> histogramOf(ColourBy by) const;
  /// What the window is about just now: the selected element's bounds, else the scans'.
  Bounds boundsOfInterest() const;
  void boxAroundInterest();
  void sectionThroughInterest();
  CutPlane cutOf(const DisplaySettings& display) const;  ///< that the list stands on
  void editCut(DisplaySettings& display, const std::function<void(CutPlane&)>& edit) const;
  void refreshCuts(const DisplaySettings& display);
  void addCut();
  void turnCut();
  void removeCut();

  std::optional<PointSummary> m_summary;  ///< of all scans together
  HistogramView* m_histogram = nullptr;
  QDoubleSpinBox* m_low = nullptr;
  QDoubleSpinBox* m_high = nullptr;
  QLabel* m_rangeNote = nullptr;
  QListWidget* m_classes = nullptr;
  QLabel* m_noClasses = nullptr;
  QListWidget* m_cuts = nullptr;
  bool m_filling = false;
};

}  // namespace alidade

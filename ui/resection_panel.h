// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>

#include <QWidget>

#include "ui/overlay_view.h"
#include "ui/pose_refinement.h"

class QSortFilterProxyModel;

namespace Ui {
class ResectionPanelForm;
}

namespace alidade {

class ObservationModel;
class ValueSlider;

/// What was observed and where, the solve's options, its result and what it is worth.
class ResectionPanel : public QWidget {
  Q_OBJECT

 public:
  ResectionPanel(Session& session, PoseRefinement& refinement, OverlayView& view, QWidget* parent = nullptr);
  ~ResectionPanel() override;
  /// A scan point to observe next, from the 3D view.
  void useWorldPoint(const glm::dvec3& world);

 signals:
  void toolBorrowed();  ///< the picture's tool is the panel's for now
  void toolReturned();

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  /// What can be observed: a known point, or something to be picked first in the scan or in the design.
  enum class Source { Known, Scan, DesignCorner, DesignEdge };
  struct Choice {
    Source source;
    Observation observation;
  };
  void connectOptions();
  void refillPoints();
  void refresh();
  void refreshSummary();
  QString alignmentWords() const;
  QString chosenPointWords(const ExpectedError& expected) const;
  QStringList sequenceWords() const;
  void startPick();
  void pickScanPoint(const QString& hint, const std::function<void(const glm::dvec3&)>& picked);
  void pickDesign(Source source);
  void pickPixel(const Observation& what);
  /// The click, or the mark next to it where that is wanted and there is one.
  void snap(Observation& observation) const;
  void borrow(const QString& hint, bool wantsScan,
              const std::function<void(const glm::dvec2&, const std::optional<glm::dvec3>&)>& picked);
  void endPick();
  void applyOptions();
  ObservationId selected() const;

  Session& m_session;
  PoseRefinement& m_refinement;
  OverlayView& m_view;
  std::unique_ptr<Ui::ResectionPanelForm> m_form;
  std::vector<Choice> m_choices;
  ObservationModel* m_model;
  QSortFilterProxyModel* m_sorted;
  ValueSlider* m_scale;
};

}  // namespace alidade

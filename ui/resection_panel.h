// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>

#include <QWidget>

#include "ui/overlay_view.h"
#include "ui/pose_refinement.h"

namespace Ui {
class ResectionPanelForm;
}

namespace alidade {

/// Pairs of known points and their places in the picture; the solve's result and what it is worth.
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
  struct KnownPoint {
    QString name;
    std::optional<glm::dvec3> world;  ///< none: to be picked from the scan first
  };
  void refillPoints();
  void refresh();
  void refreshSummary();
  void startPick();
  void pickScanPoint();
  void pickPixel(const KnownPoint& point);
  void endPick();
  void applyLocks();

  Session& m_session;
  PoseRefinement& m_refinement;
  OverlayView& m_view;
  std::unique_ptr<Ui::ResectionPanelForm> m_form;
  std::vector<KnownPoint> m_points;
  std::vector<ObservationId> m_rows;
  bool m_refreshing = false;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>

#include <QObject>

#include "app/jobs.h"
#include "ui/session.h"

namespace alidade {

/// The refinement of the current frame's pose: its observations (kept in the project), the options,
/// and the candidate pose until it is accepted or dropped. The solve runs on a worker.
class PoseRefinement : public QObject {
  Q_OBJECT

 public:
  explicit PoseRefinement(Session& session, QObject* parent = nullptr);

  /// Observations of the current frame, in order.
  std::vector<Observation> observations() const;
  void add(const glm::dvec2& pixel, const glm::dvec3& world, const QString& name);
  void remove(ObservationId id);
  void setEnabled(ObservationId id, bool enabled);

  ResectionOptions& options() { return m_options; }
  void refine();
  bool running() const { return m_running; }
  bool hasCandidate() const { return m_candidate.has_value(); }
  void accept();
  void drop();

  const std::optional<ResectionSummary>& summary() const { return m_summary; }
  /// Projected - observed at the pose now shown; nothing where the point is not seen.
  std::optional<glm::dvec2> residual(const Observation& observation) const;

 signals:
  void changed();

 private:
  void forget();

  Session& m_session;
  ResectionOptions m_options;
  std::optional<Frame> m_candidate;
  std::optional<ResectionSummary> m_summary;
  bool m_running = false;
};

}  // namespace alidade

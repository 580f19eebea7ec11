// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <set>

#include <QObject>

#include "app/auto_align.h"
#include "app/jobs.h"
#include "app/refine_network.h"
#include "app/refine_sequence.h"
#include "ui/session.h"

namespace alidade {

/// What of the project is refined together.
enum class RefinementScope { Frame, AllFrames };

/// The refinement of poses from what was observed: its observations (kept in the project), the options, and the
/// candidate poses until they are accepted or dropped. The solve runs on a worker.
class PoseRefinement : public QObject {
  Q_OBJECT

 public:
  explicit PoseRefinement(Session& session, QObject* parent = nullptr);

  /// Those of the current frame, or of all frames; in order.
  std::vector<Observation> observations(RefinementScope scope) const;
  /// Takes frame, id and, where it has none, a name from the session.
  void add(Observation observation);
  void remove(ObservationId id);
  void setEnabled(ObservationId id, bool enabled);
  void setHeldOut(ObservationId id, bool heldOut);
  /// Looks for an observed point in all other frames; what is found is one change.
  void matchInOtherFrames(ObservationId id);

  RefinementScope scope() const { return m_scope; }
  void setScope(RefinementScope scope);
  NetworkFreedom& freedom() { return m_freedom; }
  /// The object point for which the expected error is wanted; without one, the middle of the observed points.
  void setJudgedAt(std::optional<glm::dvec3> world);
  const std::optional<glm::dvec3>& judgedAt() const { return m_judgedAt; }

  void refine();
  /// Fits the current frame to the scan without any observation. A pose that is not believed is not proposed.
  void alignAutomatically();
  /// Fits all frames with a pose to the scan and adjusts them together: tie points, smooth motion, alarm where a camera
  /// that stood still moved.
  void alignSequence();
  bool running() const { return m_running; }
  bool hasCandidate() const { return m_candidate != nullptr; }
  void accept();
  void drop();

  /// What the last refinement came to: a summary, of a sequence too, or an alignment, or none.
  const std::optional<NetworkSummary>& summary() const { return m_summary; }
  const std::optional<AlignmentSummary>& alignment() const { return m_alignment; }
  const std::optional<SequenceSummary>& sequence() const { return m_sequence; }
  const std::vector<std::string>& frameNames() const { return m_frameNames; }  ///< of the summary's poses
  /// Of the overlay in the current frame, at the chosen point or amid the observed ones; nothing where it was not refined.
  std::optional<ExpectedError> expectedHere() const;
  bool isOutlier(ObservationId id) const { return m_outliers.contains(id); }
  /// Fitted - observed at the pose now shown; nothing where it is not seen.
  std::optional<glm::dvec2> residual(const Observation& observation) const;
  /// The same of a depth, metres: farther than observed.
  std::optional<double> residualM(const Observation& observation) const;

 signals:
  void changed();

 private:
  template <class Work, class Take>
  void start(const QString& name, Work work, Take take);
  void forget();
  void forgetSummaries();
  void propose(std::shared_ptr<const Project> base, std::shared_ptr<const Project> candidate, const QString& name);
  void showCandidate();

  Session& m_session;
  RefinementScope m_scope = RefinementScope::Frame;
  NetworkFreedom m_freedom;
  std::optional<glm::dvec3> m_judgedAt;
  std::shared_ptr<const Project> m_base, m_candidate;  ///< what was refined, and what came of it
  QString m_candidateName;
  std::optional<NetworkSummary> m_summary;
  std::optional<AlignmentSummary> m_alignment;
  std::optional<SequenceSummary> m_sequence;
  std::vector<std::string> m_frameNames;
  std::set<ObservationId> m_outliers;
  bool m_running = false;
};

}  // namespace alidade

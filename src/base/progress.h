// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <memory>
#include <string_view>

namespace alidade {

/// Progress and cancel of one job. Cheap to copy; copies share the job's state. Thread-safe.
///
/// A job calls `report` often (the listener is called at most every 30 ms) and returns
/// `cancelledError()` soon after `cancelled()` turns true.
class Progress {
 public:
  /// fraction in [0,1]; what: "Reading hall.las". Called on the job's thread.
  using Listener = std::function<void(double fraction, std::string_view what)>;

  /// Reports to nobody; can still be cancelled.
  Progress();
  explicit Progress(Listener listener);

  void report(double fraction, std::string_view what) const;
  bool cancelled() const;
  void cancel() const;

  /// A part of this job: its 0..1 maps onto from..to here. Cancelling either cancels both.
  Progress part(double from, double to) const;

 private:
  struct State;
  std::shared_ptr<State> m_state;
  double m_from = 0.0;
  double m_to = 1.0;
};

}  // namespace alidade

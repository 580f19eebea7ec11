// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <deque>
#include <optional>
#include <vector>

namespace alidade {

/// When which frame of a played video is drawn and shown. Frames have their own times; a few are drawn ahead and wait
/// until they are due, so that one that takes long does not show. A frame whose time is over before it could be begun is left
/// out and counted: time is never stretched. All `now` are seconds on one clock that rises.
class PlaySchedule {
 public:
  static constexpr int kDrawnAhead = 2;    ///< frames ordered and not yet shown
  static constexpr int kDecodedAhead = 4;  ///< pictures beyond them

  /// Plays the frames after `after` (-1: all). `frameSecs`: the times of all frames, in order; steps are held to
  /// [0.001, 1] s, so that photos taken minutes apart are leafed through. The first is due a little later than now.
  void begin(std::vector<double> frameSecs, int after, double speed, double now);

  struct Order {
    int frame = 0;
    std::vector<int> next;  ///< whose pictures are wanted after it
  };
  /// The frame to be drawn next; nothing where enough are under way, or at the end.
  std::optional<Order> order(double now);
  /// An ordered frame is drawn. They come in the order in which they were ordered.
  void drawn();
  /// True, once a frame, where the one drawn first is due: it is to be shown now.
  bool takeDue(double now);
  /// When the next drawn frame is due; nothing where none is drawn.
  std::optional<double> nextDue() const;
  bool finished() const;

  int dropped() const { return m_dropped; }
  int shown() const { return m_shown; }
  /// Over the time since the first was due.
  double shownPerSecond(double now) const;

 private:
  double stepSecs(int to) const;

  std::vector<double> m_secs;
  double m_speed = 1, m_start = 0;
  int m_ordered = -1;           // the last one
  double m_orderedDue = 0;
  std::deque<double> m_underWay, m_drawn;  // when they are due
  int m_dropped = 0, m_shown = 0;
};

}  // namespace alidade

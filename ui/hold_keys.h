// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <map>

#include <QObject>
#include <QPointF>
#include <optional>

class QWidget;

namespace alidade {

/// Keys that act while they are held: B before, V residuals, R raw, D and P scrub by moving the
/// mouse, Space pans. Watches the window's keys except where text is being written.
class HoldKeys : public QObject {
  Q_OBJECT

 public:
  explicit HoldKeys(QWidget& window);

  void onHold(int key, std::function<void(bool held)> change);
  /// While the key is held, moving the mouse calls `move` with the way to the right in pixels; Shift
  /// slows it tenfold. `settled` when the key is let go.
  void onScrub(int key, std::function<void(double pixels)> move, std::function<void()> settled);
  bool held(int key) const { return m_held == key; }

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  struct Handler {
    std::function<void(bool)> change;
    std::function<void(double)> move;
    std::function<void()> settled;
  };
  void release();

  QWidget& m_window;
  std::map<int, Handler> m_handlers;
  int m_held = 0;
  std::optional<double> m_lastX;
};

}  // namespace alidade

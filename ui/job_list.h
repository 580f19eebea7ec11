// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <memory>
#include <type_traits>
#include <vector>

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <QThreadPool>

#include "base/progress.h"

namespace alidade {

/// A long piece of work as the strip at the bottom shows it.
struct Job {
  int id = 0;
  QString title;
  QString what;         ///< the step it is at
  double fraction = 0;  ///< 0..1
  bool cancelling = false;
  Progress progress;
  QElapsedTimer clock;
};

/// Runs work on threads of its own and hands each finished result over on the GUI thread. Lives on
/// the GUI thread. The destructor cancels everything and waits.
class JobList : public QObject {
  Q_OBJECT

 public:
  explicit JobList(QObject* parent = nullptr);
  ~JobList() override;

  /// `work(progress)` runs on a worker and returns anything copyable; `done(result)` then runs here.
  template <class Work, class Done>
  int run(const QString& title, Work work, Done done) {
    using T = std::invoke_result_t<Work, const Progress&>;
    return start(title, [work = std::move(work), done = std::move(done)](const Progress& progress) mutable {
      auto result = std::make_shared<T>(work(progress));
      return std::function<void()>([result, done = std::move(done)]() mutable { done(std::move(*result)); });
    });
  }

  const std::vector<Job>& jobs() const { return m_jobs; }
  bool idle() const { return m_jobs.empty(); }
  void cancel(int id);
  void cancelAll();

 signals:
  void changed();  ///< a job came, went or moved on
  void finished(int id);

 private:
  using Deliver = std::function<void()>;
  int start(const QString& title, std::function<Deliver(const Progress&)> work);
  void report(int id, double fraction, const QString& what);
  void finish(int id, const Deliver& deliver);

  std::vector<Job> m_jobs;
  int m_lastId = 0;
  QThreadPool m_threads;
};

}  // namespace alidade

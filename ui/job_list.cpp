// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/job_list.h"

#include <algorithm>

#include <QCoreApplication>
#include <QMetaObject>

namespace alidade {

JobList::JobList(QObject* parent) : QObject(parent) {
  // Jobs mostly wait for disk or spread over base/parallel's own pool.
  m_threads.setMaxThreadCount(4);
}

JobList::~JobList() {
  cancelAll();
  m_threads.waitForDone();
}

int JobList::start(const QString& title, std::function<Deliver(const Progress&)> work) {
  const int id = ++m_lastId;
  Job job;
  job.id = id;
  job.title = title;
  job.progress = Progress([this, id](double fraction, std::string_view what) {
    const QString step = QString::fromUtf8(what.data(), static_cast<qsizetype>(what.size()));
    QMetaObject::invokeMethod(
        this, [this, id, fraction, step] { report(id, fraction, step); }, Qt::QueuedConnection);
  });
  job.clock.start();
  m_jobs.push_back(job);
  emit changed();
  m_threads.start([this, id, progress = job.progress, work = std::move(work)] {
    Deliver deliver = work(progress);
    QMetaObject::invokeMethod(
        this, [this, id, deliver] { finish(id, deliver); }, Qt::QueuedConnection);
  });
  return id;
}

void JobList::report(int id, double fraction, const QString& what) {
  for (Job& job : m_jobs) {
    if (job.id != id) continue;
    job.fraction = std::clamp(fraction, 0.0, 1.0);
    if (!job.cancelling) job.what = what;
    emit changed();
  }
}

void JobList::finish(int id, const Deliver& deliver) {
  std::erase_if(m_jobs, [id](const Job& job) { return job.id == id; });
  emit changed();
  deliver();
  emit finished(id);
}

void JobList::cancel(int id) {
  for (Job& job : m_jobs) {
    if (job.id != id) continue;
    job.progress.cancel();
    job.cancelling = true;
    job.what = tr("Cancelling…");
  }
  emit changed();
}

void JobList::cancelAll() {
  for (Job& job : m_jobs) job.progress.cancel();
}

}  // namespace alidade

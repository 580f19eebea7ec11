// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/job_strip.h"

#include <algorithm>

#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/theme.h"

namespace alidade {

JobStrip::JobStrip(JobList& jobs, QWidget* parent) : QWidget(parent), m_jobs(jobs) {
  setObjectName(QStringLiteral("jobStrip"));
  m_layout = new QVBoxLayout(this);
  m_layout->setContentsMargins(10, 2, 8, 2);
  m_layout->setSpacing(1);
  m_timer.setInterval(500);
  connect(&m_timer, &QTimer::timeout, this, &JobStrip::refresh);
  connect(&jobs, &JobList::changed, this, &JobStrip::refresh);
  setVisible(false);
}

JobStrip::Line JobStrip::makeLine(int id) {
  Line line;
  line.widget = new QWidget;
  auto* layout = new QHBoxLayout(line.widget);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(10);
  line.words = new QLabel;
  line.words->setTextFormat(Qt::PlainText);
  line.words->setMinimumWidth(120);
  line.words->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  line.bar = new QProgressBar;
  line.bar->setRange(0, 1000);
  line.bar->setTextVisible(false);
  line.bar->setFixedWidth(260);
  line.time = new QLabel;
  line.time->setMinimumWidth(90);
  line.time->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  auto* cancel = new QToolButton;
  cancel->setObjectName(QStringLiteral("cancelJob"));
  cancel->setIcon(icon(QStringLiteral("cancel")));
  cancel->setToolTip(tr("Cancel this job"));
  cancel->setFocusPolicy(Qt::TabFocus);
  connect(cancel, &QToolButton::clicked, this, [this, id] { m_jobs.cancel(id); });
  line.cancel = cancel;
  layout->addWidget(line.words, 1);
  layout->addWidget(line.bar);
  layout->addWidget(line.time);
  layout->addWidget(cancel);
  m_layout->addWidget(line.widget);
  return line;
}

void JobStrip::refresh() {
  std::erase_if(m_lines, [this](auto& entry) {
    const bool gone = std::none_of(m_jobs.jobs().begin(), m_jobs.jobs().end(),
                                   [&](const Job& job) { return job.id == entry.first; });
    if (gone) entry.second.widget->deleteLater();
    return gone;
  });
  for (const Job& job : m_jobs.jobs()) {
    if (!m_lines.contains(job.id)) m_lines[job.id] = makeLine(job.id);
    const Line& line = m_lines[job.id];
    const double secs = static_cast<double>(job.clock.elapsed()) / 1000.0;
    line.words->setText(job.what.isEmpty() ? job.title : QStringLiteral("%1: %2").arg(job.title, job.what));
    line.bar->setValue(static_cast<int>(job.fraction * 1000));
    QString time = QStringLiteral("%1 %").arg(job.fraction * 100, 0, 'f', 0);
    // An estimate from a start is worth nothing; from a tenth on it is.
    if (job.fraction > 0.1 && secs > 2)
      time += tr(", %1 s left").arg(secs * (1 - job.fraction) / job.fraction, 0, 'f', 0);
    line.time->setText(time);
    line.cancel->setEnabled(!job.cancelling);
  }
  setVisible(!m_jobs.idle());
  m_jobs.idle() ? m_timer.stop() : m_timer.start();
}

}  // namespace alidade

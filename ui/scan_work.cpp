// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/scan_work.h"

#include <algorithm>

#include "ui/format.h"

namespace alidade {

namespace {

const Scan* findScan(const Project& project, ScanId id) {
  const auto found = std::ranges::find(project.scans, id, &Scan::id);
  return found == project.scans.end() ? nullptr : &*found;
}

}  // namespace

ScanWork::ScanWork(Session& session, QObject* parent) : QObject(parent), m_session(session) {}

void ScanWork::clean(ScanId id, const ScanCleaning& cleaning) {
  const Scan* scan = findScan(*m_session.project(), id);
  if (!scan) return;
  run(tr("Cleaning %1").arg(text(scan->name)), tr("Clean %1").arg(text(scan->name)), id,
      [id, cleaning](const Project& project, const Progress& progress) { return deriveCleaned(project, id, cleaning, progress); });
}

void ScanWork::registerTo(ScanId moving, ScanId fixed, const RegistrationOptions& options) {
  const Scan* scan = findScan(*m_session.project(), moving);
  const Scan* to = findScan(*m_session.project(), fixed);
  if (!scan || !to) return;
  run(tr("Fitting %1 to %2").arg(text(scan->name), text(to->name)), tr("Register %1").arg(text(scan->name)), moving,
      [moving, fixed, options](const Project& project, const Progress& progress) {
        return deriveRegistered(project, moving, fixed, options, progress);
      });
}

void ScanWork::run(const QString& title, const QString& change, ScanId scan, Work work) {
  if (m_running) return;
  m_running = true;
  m_report.clear();
  emit changed();
  const auto project = m_session.project();
  m_session.jobs().run(
      title, [project, work = std::move(work)](const Progress& progress) { return work(*project, progress); },
      [this, change, scan, path = project->path](Result<DerivedScan> derived) {
        m_running = false;
        if (!derived) {
          m_report = text(derived.error().what);
          m_session.messages().error(derived.error(), change);
        } else if (m_session.project()->path == path && findScan(*m_session.project(), scan)) {
          m_report = reportText(derived->report);
          take(change, scan, std::move(*derived));
        }
        emit changed();
      });
}

void ScanWork::take(const QString& change, ScanId from, DerivedScan derived) {
  for (const ImportWarning& warning : derived.warnings) m_session.messages().warn(text(warning.what), text(warning.where));
  Scan scan = std::move(derived.scan);
  for (const Scan& other : m_session.project()->scans) scan.id.value = std::max(scan.id.value, other.id.value);
  ++scan.id.value;
  // The points are there before the scan that shows them.
  LoadedData data = *m_session.data();
  data.scans[scan.id] = std::move(derived.layers);
  m_session.setData(std::move(data));
  m_session.change(change, [&](Project& project) {
    for (Scan& old : project.scans)
      if (old.id == from) old.visible = false;
    project.scans.push_back(scan);
  });
}

}  // namespace alidade

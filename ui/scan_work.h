// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QObject>

#include "app/derived_scan.h"
#include "ui/session.h"

namespace alidade {

/// Cleaning and registering the project's scans as jobs. What comes of them is a new scan in the old one's place, in one
/// change that undo takes back.
class ScanWork : public QObject {
  Q_OBJECT

 public:
  explicit ScanWork(Session& session, QObject* parent = nullptr);

  void clean(ScanId scan, const ScanCleaning& cleaning);
  void registerTo(ScanId moving, ScanId fixed, const RegistrationOptions& options);
  bool running() const { return m_running; }
  const QString& report() const { return m_report; }  ///< of the last job

 signals:
  void changed();

 private:
  using Work = std::function<Result<DerivedScan>(const Project&, const Progress&)>;
  void run(const QString& title, const QString& change, ScanId scan, Work work);
  void take(const QString& change, ScanId from, DerivedScan derived);

  Session& m_session;
  QString m_report;
  bool m_running = false;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QObject>
#include <QStringList>

#include "ui/session.h"

namespace alidade {

/// Opens, makes, fills and saves projects, always on a worker. The window calls it for every way
/// that files come in: the menu, the command line, a drop, the welcome page.
class ProjectFiles : public QObject {
  Q_OBJECT

 public:
  explicit ProjectFiles(Session& session, QObject* parent = nullptr);

  void open(const QString& projectPath);
  /// A project among the paths is opened; anything else is added to the open project, or makes a new one.
  void openAny(const QStringList& paths);
  void add(const QStringList& paths);
  void newEmpty();
  void save();
  void saveAs(const QString& path);
  /// Makes the sample inspection once and opens it.
  void openSample();
  void openSampleIn(const QString& folder, const DemoOptions& options);

  QStringList recent() const;
  void forgetRecent(const QString& path);
  static QString sampleFolder();

 signals:
  void opened(const QString& path);
  void recentChanged();
  void needsPath();   ///< save() without a path yet
  void saveFinished(bool saved);
  void wantsFiles();  ///< the next step that a note offers: choose more files

 private:
  void remember(const QString& path);
  void load(std::shared_ptr<const Project> project, bool onlyNew);
  void showPart(const std::string& projectPath, const LoadedData& part);
  /// A sample of a scan whose whole could not be read would pass for it.
  void dropUnfinished(const Project& wanted);
  void noteOutcome(const std::vector<std::string>& notes);

  Session& m_session;
};

}  // namespace alidade

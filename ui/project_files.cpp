// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/project_files.h"

#include <QDir>
#include <QFileInfo>
#include <QSettings>
#include <QStandardPaths>

#include "app/jobs.h"
#include "io/project_store.h"
#include "ui/format.h"

namespace alidade {

namespace {

constexpr int kMostRecent = 10;

struct OpenOutcome {
  Project project;
  std::vector<SourceProblem> problems;
};

/// Only the sources that are not loaded yet.
Project withoutLoaded(const Project& project, const LoadedData& data) {
  Project rest = project;
  std::erase_if(rest.scans, [&](const Scan& scan) { return data.scans.contains(scan.id); });
  std::erase_if(rest.designs, [&](const Design& design) { return data.designs.contains(design.id); });
  return rest;
}

}  // namespace

ProjectFiles::ProjectFiles(Session& session, QObject* parent) : QObject(parent), m_session(session) {}

void ProjectFiles::open(const QString& projectPath) {
  const QString path = QFileInfo(projectPath).absoluteFilePath();
  m_session.jobs().run(
      tr("Opening %1").arg(QFileInfo(path).fileName()),
      [path](const Progress& progress) -> Result<OpenOutcome> {
        progress.report(0.1, "Reading the project");
        auto project = loadProject(path.toStdString());
        if (!project) return fail(project.error());
        progress.report(0.5, "Checking the source files");
        OpenOutcome outcome;
        outcome.problems = checkSources(*project);
        outcome.project = std::move(*project);
        if (progress.cancelled()) return fail(cancelledError());
        return outcome;
      },
      [this, path](Result<OpenOutcome> outcome) {
        if (!outcome) {
          m_session.messages().error(outcome.error(), tr("opening %1").arg(QFileInfo(path).fileName()));
          return;
        }
        outcome->project.path = path.toStdString();
        m_session.setProject(std::move(outcome->project), false);
        for (const SourceProblem& problem : outcome->problems) {
          Message message;
          message.severity = Severity::Warning;
          message.what = tr("A source file %1").arg(text(problem.what));
          message.where = text(problem.path);
          message.advice = tr("Put the file back in its place, or add it again");
          message.actionText = tr("Add files…");
          message.action = [this] { emit wantsFiles(); };
          m_session.messages().add(std::move(message));
        }
        remember(path);
        emit opened(path);
        load(m_session.project(), false);
      });
}

void ProjectFiles::openAny(const QStringList& paths) {
  for (const QString& path : paths) {
    if (QFileInfo(path).suffix().compare(QStringLiteral("alidade"), Qt::CaseInsensitive) != 0) continue;
    open(path);
    if (paths.size() > 1)
      m_session.messages().info(tr("Opened the project; the other files were left aside"));
    return;
  }
  if (!paths.isEmpty()) add(paths);
}

void ProjectFiles::add(const QStringList& paths) {
  std::vector<std::string> files;
  for (const QString& path : paths) files.push_back(QFileInfo(path).absoluteFilePath().toStdString());
  const std::shared_ptr<const Project> base =
      m_session.hasProject() ? m_session.project() : std::make_shared<const Project>();
  const bool isNew = !m_session.hasProject();
  const QString title = paths.size() == 1 ? tr("Adding %1").arg(QFileInfo(paths.front()).fileName())
                                          : tr("Adding %n files", nullptr, static_cast<int>(paths.size()));
  m_session.jobs().run(
      title, [base, files](const Progress& progress) { return addToProject(*base, files, progress); },
      [this, isNew, base, paths](Result<NewProjectOutcome> outcome) {
        if (!outcome) {
          m_session.messages().error(outcome.error(), tr("adding files"));
          return;
        }
        Project& project = outcome->project;
        if (project.name.empty()) project.name = QFileInfo(paths.front()).completeBaseName().toStdString();
        if (!isNew && base != m_session.project()) {
          // What was changed meanwhile stays: only what is about the sources is taken over.
          Project merged = *m_session.project();
          merged.scans = project.scans, merged.designs = project.designs, merged.cameras = project.cameras;
          merged.videos = project.videos, merged.frames = project.frames, merged.crs = project.crs;
          merged.stakePoints = project.stakePoints, merged.controlPoints = project.controlPoints;
          project = std::move(merged);
        }
        if (isNew) {
          m_session.setProject(std::move(project), true);
          emit opened({});
        } else {
          m_session.replaceProject(std::move(project));
        }
        noteOutcome(outcome->notes);
        load(m_session.project(), true);
      });
}

void ProjectFiles::noteOutcome(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    Message message;
    message.severity = Severity::Note;
    message.what = text(note);
    message.actionText = tr("Add files…");
    message.action = [this] { emit wantsFiles(); };
    m_session.messages().add(std::move(message));
  }
}

void ProjectFiles::load(std::shared_ptr<const Project> project, bool onlyNew) {
  auto wanted =
      std::make_shared<const Project>(onlyNew ? withoutLoaded(*project, *m_session.data()) : *project);
  if (wanted->scans.empty() && wanted->designs.empty()) return;
  m_session.jobs().run(
      tr("Loading scans and designs"),
      [this, wanted, name = project->path](const Progress& progress) {
        return loadData(*wanted, progress, [&](LoadedData part) {
          QMetaObject::invokeMethod(this, [this, name, part = std::move(part)] { showPart(name, part); }, Qt::QueuedConnection);
        });
      },
      [this, wanted, name = project->path](Result<LoadOutcome> outcome) {
        const bool same = m_session.project()->path == name;
        if (!outcome) {
          if (same) dropUnfinished(*wanted);
          m_session.messages().error(outcome.error(), tr("loading scans and designs"));
          return;
        }
        if (!same) return;  // another project was opened meanwhile
        for (const ImportWarning& warning : outcome->warnings)
          m_session.messages().warn(text(warning.what), text(warning.where));
        for (const Error& problem : outcome->problems) m_session.messages().error(problem);
        dropUnfinished(*wanted);
      });
}

void ProjectFiles::showPart(const std::string& projectPath, const LoadedData& part) {
  if (m_session.project()->path != projectPath) return;
  LoadedData all = *m_session.data();
  mergeInto(all, part);
  m_session.setData(std::move(all));
}

void ProjectFiles::dropUnfinished(const Project& wanted) {
  LoadedData rest = *m_session.data();
  const std::size_t before = rest.scans.size();
  dropSamples(rest, wanted);
  if (rest.scans.size() != before) m_session.setData(std::move(rest));
}

void ProjectFiles::newEmpty() {
  Project project;
  project.name = tr("Untitled").toStdString();
  m_session.setProject(std::move(project), true);
  emit opened({});
}

void ProjectFiles::save() {
  if (m_session.project()->path.empty()) {
    emit needsPath();
    return;
  }
  saveAs(text(m_session.project()->path));
}

void ProjectFiles::saveAs(const QString& wanted) {
  QString path = QFileInfo(wanted).absoluteFilePath();
  if (!path.endsWith(QStringLiteral(".alidade"), Qt::CaseInsensitive)) path += QStringLiteral(".alidade");
  auto project = std::make_shared<Project>(m_session.projectToSave());
  project->path = path.toStdString();
  const Project* const state = m_session.project().get();
  m_session.jobs().run(
      tr("Saving %1").arg(QFileInfo(path).fileName()),
      [project, path](const Progress&) { return saveProject(*project, path.toStdString()); },
      [this, path, state](Result<void> saved) {
        if (!saved) {
          m_session.messages().error(saved.error(), tr("saving"));
          emit saveFinished(false);
          return;
        }
        if (m_session.project().get() == state) m_session.markSaved(path.toStdString());
        remember(path);
        m_session.messages().info(tr("Saved %1").arg(path));
        emit saveFinished(true);
      });
}

QString ProjectFiles::sampleFolder() {
  return QStandardPaths::writableLocation(QStandardPaths::AppDataLocation) + QStringLiteral("/sample");
}

void ProjectFiles::openSample() {
  openSampleIn(sampleFolder(), DemoOptions{});
}

void ProjectFiles::openSampleIn(const QString& folder, const DemoOptions& options) {
  const QString made = folder + QStringLiteral("/demo.alidade");
  if (QFileInfo::exists(made)) {
    open(made);
    return;
  }
  m_session.jobs().run(
      tr("Making the sample inspection"),
      [folder, options](const Progress& progress) {
        QDir().mkpath(folder);
        return makeDemo(folder.toStdString(), options, progress);
      },
      [this](Result<std::string> path) {
        if (!path) {
          m_session.messages().error(path.error(), tr("making the sample inspection"));
          return;
        }
        open(text(*path));
      });
}

QStringList ProjectFiles::recent() const {
  return QSettings().value(QStringLiteral("recentProjects")).toStringList();
}

void ProjectFiles::remember(const QString& path) {
  QStringList list = recent();
  list.removeAll(path);
  list.prepend(path);
  while (list.size() > kMostRecent) list.removeLast();
  QSettings().setValue(QStringLiteral("recentProjects"), list);
  emit recentChanged();
}

void ProjectFiles::forgetRecent(const QString& path) {
  QStringList list = recent();
  list.removeAll(path);
  QSettings().setValue(QStringLiteral("recentProjects"), list);
  emit recentChanged();
}

}  // namespace alidade

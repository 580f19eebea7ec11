// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/project_database.h"

#include <atomic>
#include <utility>

#include <QCoreApplication>

#include <fcntl.h>
#include <unistd.h>

namespace alidade {

namespace {

/// SQLite's result codes (sqlite.org/rescode.html), as Qt hands them over.
std::string adviceFor(const QString& code) {
  const int primary = code.toInt() & 0xff;
  if (primary == 13) return "Free some space or choose another disk";
  if (primary == 10) return "The disk is full or failing: choose another place";
  if (primary == 11 || primary == 26) return "The project file is damaged: open a backup";
  if (primary == 5 || primary == 6) return "Another program holds the file: close it there";
  return "Check that the folder can be read and written";
}

/// A name for Qt. Its strings cannot hold a path that is not UTF-8 and would name another file;
/// SQLite itself follows the descriptor's link to the very bytes.
class DatabaseName {
 public:
  explicit DatabaseName(const std::string& path) : m_name(QString::fromUtf8(path.data(), qsizetype(path.size()))) {
    if (m_name.toStdString() == path) return;
    m_descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    m_name = QString("/proc/self/fd/%1").arg(m_descriptor);
  }
  ~DatabaseName() {
    if (m_descriptor >= 0) ::close(m_descriptor);
  }
  DatabaseName(const DatabaseName&) = delete;
  DatabaseName& operator=(const DatabaseName&) = delete;
  const QString& name() const { return m_name; }

 private:
  QString m_name;
  int m_descriptor = -1;
};

}  // namespace

Result<ProjectDatabase> ProjectDatabase::open(const std::string& path, Mode mode) {
  if (!QCoreApplication::instance())
    return fail("Project files need a running Qt application", path,
                "Create a QCoreApplication before a project is opened or saved");
  if (!QSqlDatabase::isDriverAvailable("QSQLITE"))
    return fail("Qt's SQLite driver is not installed", path, "Install the package libqt6sql6-sqlite");

  static std::atomic<int> count{0};
  ProjectDatabase database;
  database.m_connection = QString("alidade-project-%1").arg(++count);
  database.m_path = path;
  QSqlDatabase connection = QSqlDatabase::addDatabase("QSQLITE", database.m_connection);
  const DatabaseName name(path);
  connection.setDatabaseName(name.name());
  connection.setConnectOptions(mode == Mode::Read ? "QSQLITE_OPEN_READONLY;QSQLITE_BUSY_TIMEOUT=2000"
                                                  : "QSQLITE_BUSY_TIMEOUT=2000");
  if (!connection.open())
    return fail("The database cannot be opened: " + connection.lastError().databaseText().toStdString(), path,
                adviceFor(connection.lastError().nativeErrorCode()));
  return database;
}

ProjectDatabase::ProjectDatabase(ProjectDatabase&& other) noexcept
    : m_connection(std::exchange(other.m_connection, QString())), m_path(std::move(other.m_path)) {}

void ProjectDatabase::close() {
  if (m_connection.isEmpty()) return;
  QSqlDatabase::database(m_connection, false).close();
  QSqlDatabase::removeDatabase(m_connection);
  m_connection.clear();
}

QSqlQuery ProjectDatabase::query() const {
  QSqlQuery query(QSqlDatabase::database(m_connection, false));
  query.setForwardOnly(true);
  return query;
}

Result<void> ProjectDatabase::execute(const std::string& statement) const {
  QSqlQuery run = query();
  if (!run.exec(QString::fromStdString(statement))) return fail(error(run, "The project cannot be stored"));
  return {};
}

Error ProjectDatabase::error(const QSqlQuery& query, const std::string& doing) const {
  const QSqlError native = query.lastError();
  return {doing + ": " + native.databaseText().toStdString(), m_path, adviceFor(native.nativeErrorCode())};
}

}  // namespace alidade

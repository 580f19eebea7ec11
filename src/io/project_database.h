// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include <QSqlDatabase>
#include <QSqlError>
#include <QSqlQuery>

#include "base/error.h"

namespace alidade {

/// One connection to a SQLite file with a name of its own, closed and forgotten when it goes. To be
/// used in the thread that opened it.
class ProjectDatabase {
 public:
  enum class Mode { Read, Write };

  /// Error where no QCoreApplication exists (Qt finds its database driver through it) or the driver
  /// is not installed.
  static Result<ProjectDatabase> open(const std::string& path, Mode mode);

  ProjectDatabase(ProjectDatabase&& other) noexcept;
  ProjectDatabase& operator=(ProjectDatabase&&) = delete;
  ~ProjectDatabase() { close(); }

  void close();
  QSqlQuery query() const;

  /// A statement without a result.
  Result<void> execute(const std::string& statement) const;
  Error error(const QSqlQuery& query, const std::string& doing) const;

 private:
  ProjectDatabase() = default;

  QString m_connection;
  std::string m_path;
};

}  // namespace alidade

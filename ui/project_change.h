// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>

#include <QUndoCommand>

#include "survey/project.h"

namespace alidade {

class Session;

/// A step of the undo stack: the project before and after, as snapshots that share nothing mutable.
class ProjectChange : public QUndoCommand {
 public:
  ProjectChange(Session& session, const QString& name, std::shared_ptr<const Project> before,
                std::shared_ptr<const Project> after);
  void undo() override;
  void redo() override;

 private:
  Session& m_session;
  std::shared_ptr<const Project> m_before, m_after;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/project_change.h"

#include "ui/session.h"

namespace alidade {

ProjectChange::ProjectChange(Session& session, const QString& name, std::shared_ptr<const Project> before,
                             std::shared_ptr<const Project> after)
    : QUndoCommand(name), m_session(session), m_before(std::move(before)), m_after(std::move(after)) {}

void ProjectChange::undo() {
  m_session.restore(m_before);
}

void ProjectChange::redo() {
  m_session.restore(m_after);
}

}  // namespace alidade

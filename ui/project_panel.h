// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QSet>
#include <QWidget>

#include "ui/project_tree_model.h"

class QLineEdit;
class QSortFilterProxyModel;
class QTreeView;

namespace alidade {

/// The project tree with a filter above it. Choosing a row selects everywhere; what is selected
/// elsewhere is shown here.
class ProjectPanel : public QWidget {
  Q_OBJECT

 public:
  ProjectPanel(Session& session, ProjectTreeModel& model, QWidget* parent = nullptr);
  QTreeView* tree() const { return m_tree; }
  bool eventFilter(QObject* watched, QEvent* event) override;

 signals:
  void contextMenuWanted(const QPoint& globalPosition);

 private:
  void chosen(const QModelIndex& index);
  void followSelection();
  void rememberExpanded();
  void restoreExpanded();

  Session& m_session;
  ProjectTreeModel& m_model;
  QSortFilterProxyModel* m_filter;
  QTreeView* m_tree;
  QSet<QString> m_expanded;
  bool m_first = true, m_following = false;
};

}  // namespace alidade

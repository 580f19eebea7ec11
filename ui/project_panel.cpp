// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/project_panel.h"

#include <functional>

#include <QKeyEvent>
#include <QLineEdit>
#include <QSortFilterProxyModel>
#include <QTreeView>
#include <QVBoxLayout>

namespace alidade {

ProjectPanel::ProjectPanel(Session& session, ProjectTreeModel& model, QWidget* parent)
    : QWidget(parent), m_session(session), m_model(model) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  auto* search = new QLineEdit(this);
  search->setPlaceholderText(tr("Filter by name"));
  search->setClearButtonEnabled(true);
  search->setAccessibleName(tr("Filter the project by name"));
  auto* frame = new QWidget(this);
  auto* inner = new QVBoxLayout(frame);
  inner->setContentsMargins(8, 6, 8, 6);
  inner->addWidget(search);
  layout->addWidget(frame);

  m_filter = new QSortFilterProxyModel(this);
  m_filter->setRecursiveFilteringEnabled(true);
  m_filter->setFilterCaseSensitivity(Qt::CaseInsensitive);
  m_tree = new QTreeView(this);
  m_tree->setObjectName(QStringLiteral("projectTree"));
  m_tree->setHeaderHidden(true);
  m_tree->setUniformRowHeights(true);
  m_tree->setIndentation(14);
  m_tree->setIconSize({16, 16});
  m_tree->setContextMenuPolicy(Qt::CustomContextMenu);
  m_tree->setTextElideMode(Qt::ElideRight);
  // Restoring must also see the reset that the source announces, so the connections stand in order.
  connect(&m_model, &QAbstractItemModel::modelAboutToBeReset, this, &ProjectPanel::rememberExpanded);
  m_filter->setSourceModel(&m_model);
  m_tree->setModel(m_filter);
  m_tree->installEventFilter(this);
  layout->addWidget(m_tree, 1);

  connect(&m_model, &QAbstractItemModel::modelReset, this, &ProjectPanel::restoreExpanded);
  connect(search, &QLineEdit::textChanged, this, [this](const QString& words) {
    m_filter->setFilterFixedString(words);
    if (!words.isEmpty()) m_tree->expandAll();
  });
  connect(m_tree->selectionModel(), &QItemSelectionModel::currentChanged, this,
          [this](const QModelIndex& now) { chosen(now); });
  connect(m_tree, &QTreeView::clicked, this, &ProjectPanel::chosen);
  connect(m_tree, &QTreeView::customContextMenuRequested, this,
          [this](const QPoint& p) { emit contextMenuWanted(m_tree->viewport()->mapToGlobal(p)); });
  connect(&session, &Session::selectionChanged, this, &ProjectPanel::followSelection);
  connect(&session, &Session::projectOpened, this, [this] { m_first = true; });
}

void ProjectPanel::chosen(const QModelIndex& index) {
  if (m_following || !index.isValid()) return;
  const QModelIndex source = m_filter->mapToSource(index);
  if (const FrameId frame = m_model.frame(source)) m_session.setFrame(frame);
  const SelectionState selection = m_model.selection(source);
  if (!(selection == SelectionState{})) m_session.select(selection);
}

void ProjectPanel::followSelection() {
  m_following = true;
  if (m_session.selection() == SelectionState{}) {
    m_tree->clearSelection();
    m_tree->setCurrentIndex({});
  } else {
    const QModelIndex index = m_filter->mapFromSource(m_model.indexOf(m_session.selection()));
    if (index.isValid()) {
      m_tree->setCurrentIndex(index);
      m_tree->scrollTo(index);
    }
  }
  m_following = false;
}

void ProjectPanel::rememberExpanded() {
  const std::function<void(const QModelIndex&)> visit = [&](const QModelIndex& parent) {
    for (int row = 0; row < m_filter->rowCount(parent); ++row) {
      const QModelIndex child = m_filter->index(row, 0, parent);
      const QString key = m_model.key(m_filter->mapToSource(child));
      if (!m_tree->isExpanded(child)) {
        m_expanded.remove(key);
        continue;
      }
      m_expanded.insert(key);
      visit(child);
    }
  };
  visit({});
}

void ProjectPanel::restoreExpanded() {
  const std::function<void(const QModelIndex&)> visit = [&](const QModelIndex& parent) {
    for (int row = 0; row < m_filter->rowCount(parent); ++row) {
      const QModelIndex child = m_filter->index(row, 0, parent);
      const QModelIndex source = m_filter->mapToSource(child);
      const auto kind = m_model.kind(source);
      // Groups open at first, down to the storeys; frames and elements are many and stay folded.
      const bool atFirst =
          m_first && (kind == ProjectTreeModel::Kind::Scans || kind == ProjectTreeModel::Kind::Cameras ||
                      kind == ProjectTreeModel::Kind::Designs || kind == ProjectTreeModel::Kind::Design ||
                      kind == ProjectTreeModel::Kind::Annotations);
      if (atFirst || m_expanded.contains(m_model.key(source))) {
        m_tree->expand(child);
        visit(child);
      }
    }
  };
  visit({});
  if (!m_session.data()->designs.empty()) m_first = false;
  followSelection();
}

bool ProjectPanel::eventFilter(QObject* watched, QEvent* event) {
  if (watched == m_tree && event->type() == QEvent::ShortcutOverride) {
    // Here these keys fold rows and toggle check boxes.
    const int key = static_cast<QKeyEvent*>(event)->key();
    if (key == Qt::Key_Left || key == Qt::Key_Right || key == Qt::Key_Home || key == Qt::Key_End)
      event->accept();
  }
  return QWidget::eventFilter(watched, event);
}

}  // namespace alidade

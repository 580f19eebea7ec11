// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/keys_page.h"

#include <QHeaderView>
#include <QKeySequence>
#include <QTableWidget>
#include <QVBoxLayout>

#include "ui/actions.h"

namespace alidade {

KeysPage::KeysPage(QWidget* parent) : QDialog(parent) {
  setAttribute(Qt::WA_DeleteOnClose);
  setWindowTitle(tr("Keys and mouse"));
  resize(640, 640);
  auto* layout = new QVBoxLayout(this);
  auto* table = new QTableWidget;
  table->setColumnCount(2);
  table->setHorizontalHeaderLabels({tr("Key"), tr("What it does")});
  table->verticalHeader()->setVisible(false);
  table->verticalHeader()->setDefaultSectionSize(24);
  table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table->setSelectionMode(QAbstractItemView::NoSelection);
  table->setShowGrid(false);
  table->setFocusPolicy(Qt::NoFocus);
  const auto row = [table](const QString& key, const QString& what) {
    const int at = table->rowCount();
    table->insertRow(at);
    table->setItem(at, 0, new QTableWidgetItem(key));
    table->setItem(at, 1, new QTableWidgetItem(what));
  };
  row(tr("Wheel"), tr("Zooms at the cursor; Shift is slow"));
  row(tr("Middle drag, Space and drag"), tr("Pans"));
  row(tr("Left"), tr("Selects, or does what the tool says; orbits in 3D"));
  row(tr("Right"), tr("What can be done with the thing under the cursor"));
  row(tr("Space"), tr("Plays or stops"));
  row(tr("Hold B"), tr("Shows the pose before the refinement"));
  row(tr("Hold R"), tr("Shows the raw picture"));
  row(tr("Hold V"), tr("Leaves the residuals out"));
  row(tr("Hold D, hold P"), tr("Move the mouse to change density or point size; Shift is slow"));
  for (const ActionSpec& spec : actionTable())
    if (*spec.shortcut)
      row(QKeySequence(QString::fromLatin1(spec.shortcut)).toString(QKeySequence::NativeText), tr(spec.tip));
  table->resizeColumnToContents(0);
  table->horizontalHeader()->setStretchLastSection(true);
  layout->addWidget(table);
}

}  // namespace alidade

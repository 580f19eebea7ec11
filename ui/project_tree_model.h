// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <vector>

#include <QAbstractItemModel>

#include "ui/session.h"

namespace alidade {

/// The project as a tree that every view of it shares: scans, cameras with their frames, designs by
/// storey and element, stake-out and control points, annotations, findings. Check boxes show and hide.
class ProjectTreeModel : public QAbstractItemModel {
  Q_OBJECT

 public:
  enum class Kind {
    Root,
    Scans,
    Scan,
    Cameras,
    Camera,
    Frame,
    Designs,
    Design,
    Storey,
    Element,
    StakePoints,
    StakePoint,
    ControlPoints,
    ControlPoint,
    Annotations,
    Annotation,
    Findings,
    Finding
  };

  explicit ProjectTreeModel(Session& session, QObject* parent = nullptr);
  ~ProjectTreeModel() override;

  QModelIndex index(int row, int column, const QModelIndex& parent = {}) const override;
  QModelIndex parent(const QModelIndex& child) const override;
  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  bool setData(const QModelIndex& index, const QVariant& value, int role) override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;

  Kind kind(const QModelIndex& index) const;
  QString key(const QModelIndex& index) const;  ///< stable between rebuilds
  /// What choosing this row selects; empty where it selects nothing.
  SelectionState selection(const QModelIndex& index) const;
  FrameId frame(const QModelIndex& index) const;
  QModelIndex indexOf(const SelectionState& selection) const;
  QModelIndex indexOf(FrameId frame) const;

 private:
  struct Node;
  void rebuild();
  void refreshChecks();
  const Node* node(const QModelIndex& index) const;
  QModelIndex indexOf(const Node* node) const;
  Qt::CheckState checkState(const Node& node) const;
  bool checkable(Kind kind) const;
  void buildDesigns(Node& root);
  void buildCameras(Node& root);
  void buildPoints(Node& root);
  QString rowText(const Node& node) const;

  Session& m_session;
  std::unique_ptr<Node> m_root;
};

}  // namespace alidade

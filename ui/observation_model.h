// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QAbstractTableModel>

#include "ui/pose_refinement.h"

namespace alidade {

/// The observations that a refinement may use, with what the poses now shown leave of them. Sorted by the view through
/// kSortRole; use and check are ticks.
class ObservationModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { Name, Residual, Across, Down, Check, Kind, Place, FrameName, ColumnCount };
  static constexpr int kSortRole = Qt::UserRole;

  ObservationModel(Session& session, PoseRefinement& refinement, QObject* parent = nullptr);

  ObservationId idAt(int row) const { return m_rows[static_cast<std::size_t>(row)].seen.id; }
  const Observation& at(int row) const { return m_rows[static_cast<std::size_t>(row)].seen; }

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  bool setData(const QModelIndex& index, const QVariant& value, int role) override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

  void refresh();

 private:
  struct Row {
    Observation seen;
    std::optional<glm::dvec2> residual;
    std::optional<double> residualM;
    QString frame;
    bool outlier = false;
  };
  QString words(const Row& row, int column) const;
  QVariant sortKey(const Row& row, int column) const;

  Session& m_session;
  PoseRefinement& m_refinement;
  std::vector<Row> m_rows;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/observation_model.h"

#include <cmath>

#include "ui/format.h"

namespace alidade {

namespace {

constexpr QChar kFigureSpace(0x2007);

QString kindName(ObservedKind kind) {
  switch (kind) {
    case ObservedKind::Control:
      return ObservationModel::tr("known");
    case ObservedKind::Scan:
      return ObservationModel::tr("scan");
    case ObservedKind::Tie:
      return ObservationModel::tr("tie");
    case ObservedKind::Edge:
      return ObservationModel::tr("edge");
    case ObservedKind::Depth:
      return ObservationModel::tr("depth");
    case ObservedKind::Surface:
      return ObservationModel::tr("surface");
  }
  return {};
}

}  // namespace

ObservationModel::ObservationModel(Session& session, PoseRefinement& refinement, QObject* parent)
    : QAbstractTableModel(parent), m_session(session), m_refinement(refinement) {
  connect(&refinement, &PoseRefinement::changed, this, &ObservationModel::refresh);
  connect(&session, &Session::frameChanged, this, &ObservationModel::refresh);
  refresh();
}

void ObservationModel::refresh() {
  std::vector<Row> rows;
  if (m_session.hasProject())
    for (Observation& seen : m_refinement.observations(m_refinement.scope())) {
      Row row;
      row.residual = m_refinement.residual(seen);
      row.residualM = m_refinement.residualM(seen);
      row.outlier = m_refinement.isOutlier(seen.id);
      if (const Frame* frame = m_session.project()->findFrame(seen.frame)) row.frame = text(frame->name);
      row.seen = std::move(seen);
      rows.push_back(std::move(row));
    }
  // The selection and the sorting of the view outlive figures that change.
  const bool sameRows = rows.size() == m_rows.size() &&
                        std::equal(rows.begin(), rows.end(), m_rows.begin(),
                                   [](const Row& a, const Row& b) { return a.seen.id == b.seen.id; });
  if (!sameRows) beginResetModel();
  m_rows = std::move(rows);
  if (!sameRows) endResetModel();
  else if (!m_rows.empty()) emit dataChanged(index(0, 0), index(rowCount() - 1, ColumnCount - 1));
}

int ObservationModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(m_rows.size());
}

int ObservationModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : ColumnCount;
}

QString ObservationModel::words(const Row& row, int column) const {
  const Observation& seen = row.seen;
  switch (column) {
    case Name:
      return (row.outlier ? QStringLiteral("▲ ") : QString()) + text(seen.name);
    case Residual:
      if (row.residualM) return tr("%1 mm").arg(formatNumber(1000 * std::abs(*row.residualM), 2));
      if (!seen.hasPixel()) return {};
      return row.residual ? tr("%1 px").arg(formatNumber(glm::length(*row.residual), 2)) : tr("not seen");
    case Across:
      return row.residual ? formatNumber(row.residual->x, 2) : QString();
    case Down:
      return row.residual ? formatNumber(row.residual->y, 2) : QString();
    case Kind:
      return kindName(seen.kind);
    case Place:
      if (seen.kind == ObservedKind::Depth) return formatDistance(seen.depthM);
      if (!seen.hasPixel()) return {};
      // The second figure as wide in every row, so that the decimals of both stand in line.
      return QStringLiteral("%1, %2").arg(formatNumber(seen.pixel.x, 2), formatNumber(seen.pixel.y, 2).rightJustified(7, kFigureSpace));
    case FrameName:
      return row.frame;
    default:
      return {};
  }
}

QVariant ObservationModel::sortKey(const Row& row, int column) const {
  const double unseen = 1e9;  // what is not seen at all is worst
  switch (column) {
    case Residual:
      // Metres cannot be compared with pixels: they stand together, before all others.
      if (!row.seen.hasPixel()) return (row.residualM ? std::abs(*row.residualM) : -1) - unseen;
      return row.residual ? glm::length(*row.residual) : unseen;
    case Across:
      return row.residual ? row.residual->x : unseen;
    case Down:
      return row.residual ? row.residual->y : unseen;
    case Check:
      return row.seen.heldOut;
    case Place:
      return row.seen.hasPixel() ? row.seen.pixel.x : row.seen.depthM - unseen;
    default:
      return words(row, column);
  }
}

QVariant ObservationModel::data(const QModelIndex& index, int role) const {
  const Row& row = m_rows[static_cast<std::size_t>(index.row())];
  const int column = index.column();
  if (role == Qt::DisplayRole) return words(row, column);
  if (role == kSortRole) return sortKey(row, column);
  if (role == Qt::CheckStateRole && column == Name) return row.seen.enabled ? Qt::Checked : Qt::Unchecked;
  if (role == Qt::CheckStateRole && column == Check && row.seen.kind != ObservedKind::Surface) return row.seen.heldOut ? Qt::Checked : Qt::Unchecked;
  if (role == Qt::TextAlignmentRole && (column == Residual || column == Across || column == Down || column == Place))
    return QVariant(Qt::AlignRight | Qt::AlignVCenter);
  if (role == Qt::ToolTipRole)
    return (row.seen.hasPixel() ? tr("%1 in %2: %3, %4").arg(text(row.seen.name), row.frame, words(row, Residual), formatWorld(row.seen.world))
                                : tr("%1, %2 ± %3").arg(text(row.seen.name), kindName(row.seen.kind), formatMillimetres(row.seen.sigmaM))) +
           (row.outlier ? tr("\nAn outlier: it took no part. Leave it out or pick it again") : QString());
  return {};
}

bool ObservationModel::setData(const QModelIndex& index, const QVariant& value, int role) {
  if (role != Qt::CheckStateRole) return false;
  const bool on = value.toInt() == Qt::Checked;
  if (index.column() == Name) m_refinement.setEnabled(idAt(index.row()), on);
  else if (index.column() == Check) m_refinement.setHeldOut(idAt(index.row()), on);
  else return false;
  return true;
}

Qt::ItemFlags ObservationModel::flags(const QModelIndex& index) const {
  const bool canBeCheck = m_rows[static_cast<std::size_t>(index.row())].seen.kind != ObservedKind::Surface;
  const bool ticks = index.column() == Name || (index.column() == Check && canBeCheck);
  const Qt::ItemFlags tick = ticks ? Qt::ItemIsUserCheckable : Qt::NoItemFlags;
  return Qt::ItemIsEnabled | Qt::ItemIsSelectable | tick;
}

QVariant ObservationModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || section < 0 || section >= ColumnCount) return {};
  static const char* const names[] = {QT_TR_NOOP("Point"), QT_TR_NOOP("|Δ|"), QT_TR_NOOP("Δu"),   QT_TR_NOOP("Δv"),
                                      QT_TR_NOOP("Check"), QT_TR_NOOP("Kind"), QT_TR_NOOP("u, v"), QT_TR_NOOP("Frame")};
  static const char* const tips[] = {QT_TR_NOOP("Ticked: takes part"),
                                     QT_TR_NOOP("Residual: fitted − observed, pixels; of a depth millimetres"),
                                     QT_TR_NOOP("Residual to the right, pixels"),
                                     QT_TR_NOOP("Residual downwards, pixels"),
                                     QT_TR_NOOP("Ticked: takes no part, only its residual is shown"),
                                     QT_TR_NOOP("A known point, a scan point, a tie point, an edge; the depth of a point, the surface that holds one"),
                                     QT_TR_NOOP("Where it was observed, pixels"),
                                     QT_TR_NOOP("The frame it was observed in")};
  if (role == Qt::DisplayRole) return tr(names[section]);
  if (role == Qt::ToolTipRole) return tr(tips[section]);
  return {};
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/project_tree_model.h"

#include <algorithm>
#include <map>
#include <set>

#include "ui/format.h"
#include "ui/theme.h"

namespace alidade {

struct ProjectTreeModel::Node {
  Kind kind = Kind::Root;
  QString name;
  QString detail;       ///< beside the name, dim
  std::int64_t id = 0;  ///< of the scan, camera, frame, design, annotation, finding
  int element = -1;
  std::string stakePoint;
  Node* parent = nullptr;
  int row = 0;
  std::vector<std::unique_ptr<Node>> children;

  Node& add(Kind childKind, const QString& childName, std::int64_t childId = 0) {
    auto child = std::make_unique<Node>();
    child->kind = childKind;
    child->name = childName;
    child->id = childId;
    child->parent = this;
    child->row = static_cast<int>(children.size());
    children.push_back(std::move(child));
    return *children.back();
  }
};

namespace {

using Kind = ProjectTreeModel::Kind;

QString iconNameOf(Kind kind) {
  switch (kind) {
    case Kind::Scans:
    case Kind::Scan:
      return QStringLiteral("scan");
    case Kind::Cameras:
    case Kind::Camera:
      return QStringLiteral("camera");
    case Kind::Frame:
      return QStringLiteral("frame");
    case Kind::Designs:
    case Kind::Design:
      return QStringLiteral("design");
    case Kind::Storey:
      return QStringLiteral("storey");
    case Kind::Element:
      return QStringLiteral("element");
    case Kind::StakePoints:
    case Kind::StakePoint:
      return QStringLiteral("stake");
    case Kind::ControlPoints:
    case Kind::ControlPoint:
      return QStringLiteral("control");
    case Kind::Annotations:
    case Kind::Annotation:
      return QStringLiteral("annotation");
    case Kind::Findings:
    case Kind::Finding:
      return QStringLiteral("finding");
    case Kind::Root:
      break;
  }
  return {};
}

QString annotationName(const Annotation& annotation) {
  if (!annotation.text.empty()) return text(annotation.text);
  return annotation.kind == AnnotationKind::Arrow ? ProjectTreeModel::tr("Arrow %1").arg(annotation.id.value)
                                                  : ProjectTreeModel::tr("Text %1").arg(annotation.id.value);
}

}  // namespace

ProjectTreeModel::ProjectTreeModel(Session& session, QObject* parent)
    : QAbstractItemModel(parent), m_session(session), m_root(std::make_unique<Node>()) {
  connect(&session, &Session::structureChanged, this, &ProjectTreeModel::rebuild);
  connect(&session, &Session::dataChanged, this, &ProjectTreeModel::rebuild);
  connect(&session, &Session::projectChanged, this, &ProjectTreeModel::refreshChecks);
  connect(&session, &Session::displayChanged, this, &ProjectTreeModel::refreshChecks);
  rebuild();
}

ProjectTreeModel::~ProjectTreeModel() = default;

void ProjectTreeModel::rebuild() {
  beginResetModel();
  m_root = std::make_unique<Node>();
  const Project& project = *m_session.project();
  if (m_session.hasProject()) {
    Node& scans = m_root->add(Kind::Scans, tr("Scans"));
    for (const Scan& scan : project.scans) {
      Node& row = scans.add(Kind::Scan, text(scan.name), scan.id.value);
      if (scan.info.pointCount) row.detail = tr("%1 points").arg(formatCount(scan.info.pointCount));
    }
    buildCameras(*m_root);
    buildDesigns(*m_root);
    buildPoints(*m_root);
  }
  endResetModel();
}

void ProjectTreeModel::buildCameras(Node& root) {
  const Project& project = *m_session.project();
  Node& cameras = root.add(Kind::Cameras, tr("Cameras"));
  std::map<std::int64_t, Node*> byId;
  std::map<std::int64_t, int> counts;
  for (const Frame& frame : project.frames) ++counts[frame.camera.value];
  for (const CameraRecord& camera : project.cameras) {
    Node& row = cameras.add(Kind::Camera, text(camera.name), camera.id.value);
    row.detail = tr("%n frames", nullptr, counts[camera.id.value]);
    if (counts[camera.id.value] == 1) row.detail = tr("1 frame");
    byId[camera.id.value] = &row;
  }
  for (const Frame& frame : project.frames) {
    const auto it = byId.find(frame.camera.value);
    if (it == byId.end())
      byId[frame.camera.value] = &cameras.add(Kind::Camera, tr("No camera"), frame.camera.value);
    Node& row = byId[frame.camera.value]->add(Kind::Frame, text(frame.name), frame.id.value);
    if (frame.poseSource == PoseSource::None) row.detail = tr("no pose");
    if (frame.poseSource == PoseSource::Refined) row.detail = tr("refined");
  }
}

void ProjectTreeModel::buildDesigns(Node& root) {
  Node& designs = root.add(Kind::Designs, tr("Design"));
  for (const Design& design : m_session.project()->designs) {
    Node& row = designs.add(Kind::Design, text(design.name), design.id.value);
    const DesignModel* model = m_session.model(design.id);
    if (!model) continue;
    row.detail = tr("%1 elements").arg(model->elements.size());
    std::map<std::string, Node*> storeys;
    for (std::size_t i = 0; i < model->elements.size(); ++i) {
      const DesignElement& element = model->elements[i];
      Node*& storey = storeys[element.storey];
      if (!storey)
        storey = &row.add(Kind::Storey, element.storey.empty() ? tr("No storey") : text(element.storey),
                          design.id.value);
      Node& leaf = storey->add(
          Kind::Element, element.name.empty() ? text(element.globalId) : text(element.name), design.id.value);
      leaf.element = static_cast<int>(i);
      leaf.detail = text(element.type);
    }
  }
}

void ProjectTreeModel::buildPoints(Node& root) {
  const Project& project = *m_session.project();
  Node& stakes = root.add(Kind::StakePoints, tr("Stake-out"));
  for (const StakePoint& point : project.stakePoints) {
    Node& row = stakes.add(Kind::StakePoint, text(point.name));
    row.stakePoint = point.name;
    row.detail = text(point.code);
  }
  if (!project.controlPoints.empty()) {
    Node& controls = root.add(Kind::ControlPoints, tr("Control points"));
    for (const ControlPoint& point : project.controlPoints)
      controls.add(Kind::ControlPoint, text(point.name));
  }
  Node& annotations = root.add(Kind::Annotations, tr("Annotations"));
  for (const Annotation& annotation : project.annotations)
    annotations.add(Kind::Annotation, annotationName(annotation), annotation.id.value);
  Node& findings = root.add(Kind::Findings, tr("Findings"));
  for (const Finding& finding : project.findings)
    findings.add(Kind::Finding, text(finding.name), finding.id.value);
}

void ProjectTreeModel::refreshChecks() {
  // Annotations come and go by editing; everything else keeps its rows between structure changes.
  const Project& project = *m_session.project();
  for (const auto& group : m_root->children) {
    if (group->kind != Kind::Annotations) continue;
    const QModelIndex parent = indexOf(group.get());
    const int before = static_cast<int>(group->children.size());
    const int now = static_cast<int>(project.annotations.size());
    if (before > now) {
      beginRemoveRows(parent, now, before - 1);
      group->children.resize(static_cast<std::size_t>(now));
      endRemoveRows();
    } else if (before < now) {
      beginInsertRows(parent, before, now - 1);
      for (int i = before; i < now; ++i) group->add(Kind::Annotation, {}, 0);
      endInsertRows();
    }
    for (int i = 0; i < now; ++i) {
      Node& row = *group->children[static_cast<std::size_t>(i)];
      row.name = annotationName(project.annotations[static_cast<std::size_t>(i)]);
      row.id = project.annotations[static_cast<std::size_t>(i)].id.value;
    }
  }
  const std::function<void(Node&)> announce = [&](Node& parent) {
    if (parent.children.empty()) return;
    emit dataChanged(indexOf(parent.children.front().get()), indexOf(parent.children.back().get()));
    for (const auto& child : parent.children) announce(*child);
  };
  announce(*m_root);
}

const ProjectTreeModel::Node* ProjectTreeModel::node(const QModelIndex& index) const {
  return index.isValid() ? static_cast<const Node*>(index.internalPointer()) : m_root.get();
}

QModelIndex ProjectTreeModel::indexOf(const Node* node) const {
  if (!node || node == m_root.get()) return {};
  return createIndex(node->row, 0, const_cast<Node*>(node));
}

QModelIndex ProjectTreeModel::index(int row, int column, const QModelIndex& parent) const {
  const Node* owner = node(parent);
  if (row < 0 || row >= static_cast<int>(owner->children.size()) || column != 0) return {};
  return createIndex(row, column, owner->children[static_cast<std::size_t>(row)].get());
}

QModelIndex ProjectTreeModel::parent(const QModelIndex& child) const {
  return child.isValid() ? indexOf(node(child)->parent) : QModelIndex();
}

int ProjectTreeModel::rowCount(const QModelIndex& parent) const {
  return static_cast<int>(node(parent)->children.size());
}

int ProjectTreeModel::columnCount(const QModelIndex&) const {
  return 1;
}

ProjectTreeModel::Kind ProjectTreeModel::kind(const QModelIndex& index) const {
  return node(index)->kind;
}

QString ProjectTreeModel::rowText(const Node& row) const {
  switch (row.kind) {
    case Kind::Scans:
    case Kind::Cameras:
    case Kind::Designs:
    case Kind::StakePoints:
    case Kind::ControlPoints:
    case Kind::Annotations:
    case Kind::Findings:
      return QStringLiteral("%1 (%2)").arg(row.name).arg(row.children.size());
    default:
      return row.name;
  }
}

QVariant ProjectTreeModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const Node& row = *node(index);
  switch (role) {
    case Qt::DisplayRole:
      return row.detail.isEmpty() ? rowText(row) : rowText(row) + QStringLiteral("   ") + row.detail;
    case Qt::ToolTipRole:
      return row.detail.isEmpty() ? row.name : QStringLiteral("%1, %2").arg(row.name, row.detail);
    case Qt::DecorationRole:
      return icon(iconNameOf(row.kind), true);
    case Qt::CheckStateRole:
      if (checkable(row.kind)) return checkState(row);
      return {};
    case Qt::ForegroundRole:
      if (checkable(row.kind) && checkState(row) == Qt::Unchecked) return colours().dimText;
      return {};
    default:
      return {};
  }
}

bool ProjectTreeModel::checkable(Kind kind) const {
  switch (kind) {
    case Kind::Scan:
    case Kind::Design:
    case Kind::Storey:
    case Kind::Element:
    case Kind::StakePoints:
    case Kind::Annotations:
      return true;
    default:
      return false;
  }
}

Qt::CheckState ProjectTreeModel::checkState(const Node& row) const {
  const Project& project = *m_session.project();
  const auto of = [](bool on) { return on ? Qt::Checked : Qt::Unchecked; };
  switch (row.kind) {
    case Kind::Scan:
      for (const Scan& scan : project.scans)
        if (scan.id.value == row.id) return of(scan.visible);
      return Qt::Unchecked;
    case Kind::StakePoints:
      return of(m_session.display().stakePoints);
    case Kind::Annotations:
      return of(m_session.display().annotations);
    case Kind::Element:
      return of(m_session.elementVisible(DesignId{row.id}, row.element));
    case Kind::Storey: {
      std::size_t shown = 0;
      for (const auto& child : row.children) shown += checkState(*child) == Qt::Checked;
      return shown == 0 ? Qt::Unchecked : shown == row.children.size() ? Qt::Checked : Qt::PartiallyChecked;
    }
    case Kind::Design:
      for (const Design& design : project.designs) {
        if (design.id.value != row.id) continue;
        if (!design.visible) return Qt::Unchecked;
        return design.hiddenElements.empty() ? Qt::Checked : Qt::PartiallyChecked;
      }
      return Qt::Unchecked;
    default:
      return Qt::Checked;
  }
}

bool ProjectTreeModel::setData(const QModelIndex& index, const QVariant& value, int role) {
  if (!index.isValid() || role != Qt::CheckStateRole) return false;
  const Node& row = *node(index);
  const bool on = value.toInt() != Qt::Unchecked;
  const QString change = on ? tr("Show %1").arg(row.name) : tr("Hide %1").arg(row.name);
  const std::int64_t id = row.id;
  switch (row.kind) {
    case Kind::Scan:
      m_session.change(change, [&](Project& project) {
        for (Scan& scan : project.scans)
          if (scan.id.value == id) scan.visible = on;
      });
      return true;
    case Kind::Design:
      m_session.change(change, [&](Project& project) {
        for (Design& design : project.designs)
          if (design.id.value == id) design.visible = on;
      });
      return true;
    case Kind::Element:
      m_session.setElementsVisible(change, DesignId{id}, {row.element}, on);
      return true;
    case Kind::Storey: {
      std::vector<int> elements;
      for (const auto& child : row.children) elements.push_back(child->element);
      m_session.setElementsVisible(change, DesignId{id}, elements, on);
      return true;
    }
    case Kind::StakePoints:
    case Kind::Annotations: {
      DisplaySettings display = m_session.display();
      (row.kind == Kind::StakePoints ? display.stakePoints : display.annotations) = on;
      m_session.setDisplay(display);
      return true;
    }
    default:
      return false;
  }
}

Qt::ItemFlags ProjectTreeModel::flags(const QModelIndex& index) const {
  if (!index.isValid()) return Qt::NoItemFlags;
  Qt::ItemFlags flags = Qt::ItemIsEnabled | Qt::ItemIsSelectable;
  if (checkable(node(index)->kind)) flags |= Qt::ItemIsUserCheckable;
  return flags;
}

QString ProjectTreeModel::key(const QModelIndex& index) const {
  const Node* row = node(index);
  return QStringLiteral("%1/%2/%3/%4")
      .arg(static_cast<int>(row->kind))
      .arg(row->id)
      .arg(row->element)
      .arg(row->kind == Kind::Annotation ? QString() : row->name);
}

SelectionState ProjectTreeModel::selection(const QModelIndex& index) const {
  const Node* row = node(index);
  SelectionState selection;
  if (row->kind == Kind::Element) selection.design = DesignId{row->id}, selection.element = row->element;
  if (row->kind == Kind::StakePoint) selection.stakePoint = row->stakePoint;
  if (row->kind == Kind::Annotation) selection.annotation = AnnotationId{row->id};
  return selection;
}

FrameId ProjectTreeModel::frame(const QModelIndex& index) const {
  const Node* row = node(index);
  return row->kind == Kind::Frame ? FrameId{row->id} : FrameId{};
}

QModelIndex ProjectTreeModel::indexOf(const SelectionState& wanted) const {
  const std::function<const Node*(const Node&)> find = [&](const Node& parent) -> const Node* {
    for (const auto& child : parent.children) {
      const bool leaf =
          child->kind == Kind::Element || child->kind == Kind::StakePoint || child->kind == Kind::Annotation;
      if (leaf && selection(indexOf(child.get())) == wanted) return child.get();
      if (const Node* below = find(*child)) return below;
    }
    return nullptr;
  };
  return indexOf(find(*m_root));
}

QModelIndex ProjectTreeModel::indexOf(FrameId wanted) const {
  for (const auto& group : m_root->children) {
    if (group->kind != Kind::Cameras) continue;
    for (const auto& camera : group->children)
      for (const auto& frame : camera->children)
        if (frame->id == wanted.value) return indexOf(frame.get());
  }
  return {};
}

}  // namespace alidade

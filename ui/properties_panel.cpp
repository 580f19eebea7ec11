// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/properties_panel.h"

#include <QFormLayout>
#include <QFrame>
#include <QLabel>
#include <QVBoxLayout>

#include "camera/camera.h"
#include "geometry/angle.h"
#include "ui/format.h"
#include "ui/share_bar.h"

namespace alidade {

namespace {

/// One coordinate a line: the panel is too narrow for three, and a figure must not break.
QString stackedWorld(const glm::dvec3& world) {
  return QStringLiteral("E %1 m\nN %2 m\nH %3 m")
      .arg(formatCoordinate(world.x), formatCoordinate(world.y), formatCoordinate(world.z));
}

}  // namespace

PropertiesPanel::PropertiesPanel(Session& session, QWidget* parent)
    : QScrollArea(parent), m_session(session) {
  setWidgetResizable(true);
  setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  setObjectName(QStringLiteral("propertiesPanel"));
  connect(&session, &Session::selectionChanged, this, &PropertiesPanel::rebuild);
  connect(&session, &Session::frameChanged, this, &PropertiesPanel::rebuild);
  connect(&session, &Session::projectChanged, this, &PropertiesPanel::rebuild);
  connect(&session, &Session::shownPoseChanged, this, &PropertiesPanel::rebuild);
  connect(&session, &Session::dataChanged, this, &PropertiesPanel::rebuild);
  connect(&session, &Session::pictureReady, this, &PropertiesPanel::refreshShares);
  rebuild();
}

void PropertiesPanel::heading(const QString& title, const QString& under) {
  auto* label = new QLabel(title);
  label->setProperty("role", "heading");
  label->setWordWrap(true);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse);
  m_layout->addWidget(label);
  if (!under.isEmpty()) {
    auto* second = new QLabel(under);
    second->setProperty("role", "dim");
    second->setWordWrap(true);
    m_layout->addWidget(second);
  }
}

void PropertiesPanel::startRows() {
  m_form = new QFormLayout;
  m_form->setContentsMargins(0, 2, 0, 8);
  m_form->setHorizontalSpacing(12);
  m_form->setVerticalSpacing(3);
  m_form->setRowWrapPolicy(QFormLayout::WrapLongRows);
  m_layout->addLayout(m_form);
}

void PropertiesPanel::row(const QString& name, const QString& value, const QString& objectName) {
  if (value.isEmpty()) return;
  auto* label = new QLabel(name);
  label->setProperty("role", "dim");
  auto* figure = new QLabel(value);
  figure->setWordWrap(true);
  figure->setTextInteractionFlags(Qt::TextSelectableByMouse);
  figure->setObjectName(objectName);
  m_form->addRow(label, figure);
}

void PropertiesPanel::rebuild() {
  setEnabled(!m_session.playing());
  if (m_session.playing()) return;  // made anew once it stops
  auto* page = new QWidget;
  m_layout = new QVBoxLayout(page);
  m_layout->setContentsMargins(10, 8, 10, 8);
  m_layout->setSpacing(2);
  m_shares = nullptr;
  const SelectionState& selection = m_session.selection();
  const Project& project = *m_session.project();
  const DesignModel* model = m_session.model(selection.design);
  if (model && selection.element >= 0 && selection.element < static_cast<int>(model->elements.size())) {
    showElement(*model, selection.element);
  } else if (!selection.stakePoint.empty()) {
    for (const StakePoint& point : project.stakePoints)
      if (point.name == selection.stakePoint) showStakePoint(point);
  } else if (selection.annotation) {
    for (const Annotation& annotation : project.annotations)
      if (annotation.id == selection.annotation) showAnnotation(annotation);
  } else {
    auto* empty = new QLabel(tr("Nothing selected. Click an element in the picture or in the tree."));
    empty->setProperty("role", "dim");
    empty->setWordWrap(true);
    m_layout->addWidget(empty);
    m_layout->addSpacing(8);
  }
  showFrame();
  m_layout->addStretch(1);
  setWidget(page);
}

void PropertiesPanel::showElement(const DesignModel& model, int index) {
  const DesignElement& element = model.elements[static_cast<std::size_t>(index)];
  QStringList under;
  if (!element.type.empty()) under << text(element.type);
  if (!element.storey.empty()) under << text(element.storey);
  heading(element.name.empty() ? text(element.globalId) : text(element.name),
          under.join(QStringLiteral(", ")));
  auto* shares = new ShareBar;
  m_layout->addSpacing(4);
  m_layout->addWidget(shares);
  m_shares = shares;
  refreshShares();
  startRows();
  const Bounds box = model.elementBounds(static_cast<std::size_t>(index));
  if (!box.empty()) {
    const glm::dvec3 size = box.size();
    row(tr("Size"), QStringLiteral("%1 × %2 × %3 m")
                        .arg(size.x, 0, 'f', 3)
                        .arg(size.y, 0, 'f', 3)
                        .arg(size.z, 0, 'f', 3));
    row(tr("Middle"), stackedWorld(box.centre()));
  }
  row(tr("Global id"), text(element.globalId));
  std::string set;
  for (const auto& [key, value] : element.properties) {
    const auto dot = key.find('.');
    const std::string owner = dot == std::string::npos ? std::string() : key.substr(0, dot);
    if (owner != set) {
      set = owner;
      heading(text(owner));
      startRows();
    }
    row(text(dot == std::string::npos ? key : key.substr(dot + 1)), text(value));
  }
}

void PropertiesPanel::showStakePoint(const StakePoint& point) {
  heading(text(point.name),
          point.code.empty() ? tr("Stake-out point") : tr("Stake-out point, %1").arg(text(point.code)));
  startRows();
  row(tr("E"), formatCoordinate(point.position.x) + QStringLiteral(" m"));
  row(tr("N"), formatCoordinate(point.position.y) + QStringLiteral(" m"));
  row(tr("H"), formatCoordinate(point.position.z) + QStringLiteral(" m"));
  row(tr("Tolerance"), formatMillimetres(point.toleranceM));
  const Frame* frame = m_session.currentFrame();
  if (frame && frame->cameraFromWorld)
    row(tr("From the camera"),
        formatDistance(glm::length(point.position - frame->cameraFromWorld->centre())));
}

void PropertiesPanel::showAnnotation(const Annotation& annotation) {
  const bool world = annotation.anchor == AnnotationAnchor::World;
  heading(annotation.text.empty() ? tr("Arrow") : text(annotation.text), tr("Annotation"));
  startRows();
  row(tr("Tied to"), world ? tr("the world, seen in every frame") : tr("this picture"));
  if (world)
    row(tr("At"), stackedWorld(annotation.world));
  else
    row(tr("At"), formatPixel(annotation.pixel));
}

void PropertiesPanel::showFrame() {
  const Frame* frame = m_session.shownFrame();
  if (!frame) return;
  const CameraRecord* camera = m_session.currentCamera();
  heading(tr("Pose of %1").arg(text(frame->name)), poseSummary(*frame));
  startRows();
  row(tr("Time"), formatSeconds(frame->timeSecs));
  if (camera) {
    const Intrinsics& in = camera->camera.intrinsics();
    const std::string_view model = cameraModelName(in.model);
    row(tr("Camera"), text(camera->name));
    row(tr("Lens"), QStringLiteral("%1, f %2 px")
                        .arg(QString::fromUtf8(model.data(), static_cast<qsizetype>(model.size())))
                        .arg(in.fx, 0, 'f', 1));
    row(tr("Picture"), QStringLiteral("%1 × %2 px").arg(in.width).arg(in.height));
    if (camera->mount && camera->mount->body != camera->name) {
      const glm::dvec3 at = camera->mount->cameraFromBody.centre();
      row(tr("Mounted"), tr("%1, %2, %3 m on %4")
                             .arg(formatNumber(at.x, 4), formatNumber(at.y, 4), formatNumber(at.z, 4), text(camera->mount->body)));
      if (const glm::dvec3 std = camera->mount->offsetStdM; std != glm::dvec3(0))
        row(tr("σ mounting"), QStringLiteral("%1, %2, %3").arg(formatMillimetres(std.x), formatMillimetres(std.y), formatMillimetres(std.z)));
    }
  }
  if (frame->cameraFromWorld) row(tr("Stands at"), stackedWorld(frame->cameraFromWorld->centre()));
  if (frame->quality) {
    const PoseQuality& q = *frame->quality;
    row(tr("Residual rms"), QStringLiteral("%1 px, %2 points").arg(q.rmsPx, 0, 'f', 2).arg(q.observations));
    row(tr("σ₀"), QString::number(q.sigma0, 'f', 2));
    row(tr("σ E N H"), QStringLiteral("%1, %2, %3")
                           .arg(formatMillimetres(q.positionStdM.x), formatMillimetres(q.positionStdM.y),
                                formatMillimetres(q.positionStdM.z)));
    row(tr("σ attitude"), QStringLiteral("%1, %2, %3 mgon")
                              .arg(gonFromRadians(q.rotationStdRad.x) * 1000, 0, 'f', 1)
                              .arg(gonFromRadians(q.rotationStdRad.y) * 1000, 0, 'f', 1)
                              .arg(gonFromRadians(q.rotationStdRad.z) * 1000, 0, 'f', 1));
  }
}

void PropertiesPanel::refreshShares() {
  auto* bar = qobject_cast<ShareBar*>(m_shares);
  if (!bar) return;
  const auto& result = m_session.rendered();
  const SelectionState& selection = m_session.selection();
  bar->setShares(result ? sharesOf(*result, selection.design, selection.element) : std::nullopt);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QTableView>

#include "app/observing.h"
#include "ui/observation_model.h"
#include "ui/pose_refinement.h"
#include "ui/value_slider.h"
#include "ui/window_fixture.h"

namespace alidade::test {

namespace {

struct Seen {
  QString name;
  glm::dvec2 pixel;
};

/// Control points that fall well inside the picture.
std::vector<Seen> controlPointsInView(const Project& project, const Frame& frame) {
  const Camera& camera = project.findCamera(frame.camera)->camera;
  std::vector<Seen> seen;
  for (const ControlPoint& point : project.controlPoints) {
    const auto pixel = camera.project(*frame.cameraFromWorld * point.position);
    if (pixel && pixel->x > 10 && pixel->y > 10 && pixel->x < camera.width() - 10 && pixel->y < camera.height() - 10)
      seen.push_back({QString::fromStdString(point.name), *pixel});
  }
  return seen;
}

}  // namespace

TEST_F(OpenWindow, APoseIsRefinedFromClickedControlPointsAcceptedAndUndone) {
  window->actions()[Command::Resection]->trigger();
  auto* panel = window->findChild<QWidget*>("ResectionPanelForm");
  if (!panel) panel = window->findChild<QTableView*>("observationTable")->parentWidget();
  auto* points = panel->findChild<QComboBox*>("point");
  auto* pick = panel->findChild<QPushButton*>("pick");
  auto* refine = panel->findChild<QPushButton*>("refine");
  auto* accept = panel->findChild<QPushButton*>("accept");
  ASSERT_TRUE(points && pick && refine && accept);
  ASSERT_TRUE(settle());

  const Frame before = *session().currentFrame();
  const auto seen = controlPointsInView(*session().project(), before);
  ASSERT_GE(seen.size(), 6u) << "the demo shows too few control points";
  const std::size_t earlier = session().project()->observations.size();
  std::size_t clicked = 0;
  for (const Seen& point : seen) {
    points->setCurrentIndex(points->findText(point.name));
    ASSERT_TRUE(pick->isEnabled());
    QTest::mouseClick(pick, Qt::LeftButton);
    // The picture shows the target where the file's pose puts it, but for the click's own half pixel.
    click(point.pixel + glm::dvec2(clicked % 2 ? 0.4 : -0.4, clicked % 3 ? 0.3 : -0.6));
    ++clicked;
    ASSERT_TRUE(waitFor([&] { return session().project()->observations.size() == earlier + clicked; }, 10'000))
        << point.name.toStdString();
    ASSERT_TRUE(settle());
  }
  auto* table = panel->findChild<QTableView*>("observationTable");
  EXPECT_EQ(table->model()->rowCount(), static_cast<int>(clicked));

  QTest::mouseClick(refine, Qt::LeftButton);
  ASSERT_TRUE(waitFor([&] { return accept->isEnabled(); }, 20'000));
  QTest::mouseClick(accept, Qt::LeftButton);
  ASSERT_TRUE(settle());
  const Frame& refined = *session().currentFrame();
  EXPECT_EQ(refined.poseSource, PoseSource::Refined);
  ASSERT_TRUE(refined.quality);
  EXPECT_LT(refined.quality->rmsPx, 2.0);
  EXPECT_LT(glm::length(refined.cameraFromWorld->centre() - before.cameraFromWorld->centre()), 0.3);
  EXPECT_NE(refined.cameraFromWorld->translation, before.cameraFromWorld->translation);

  window->actions()[Command::Undo]->trigger();
  EXPECT_EQ(session().currentFrame()->poseSource, before.poseSource);
  EXPECT_EQ(session().currentFrame()->cameraFromWorld->translation, before.cameraFromWorld->translation);
}

namespace {

class ResectionWindow : public OpenWindow {
 protected:
  void SetUp() override {
    OpenWindow::SetUp();
    if (HasFatalFailure()) return;
    window->actions()[Command::Resection]->trigger();
    ASSERT_TRUE(settle());
    table = window->findChild<QTableView*>("observationTable");
    points = window->findChild<QComboBox*>("point");
    pick = window->findChild<QPushButton*>("pick");
    window->findChild<QCheckBox*>("snap")->setChecked(false);
    ASSERT_TRUE(table && points && pick);
  }
  std::size_t count() { return session().project()->observations.size(); }
  const Observation& last() { return session().project()->observations.back(); }
  /// Clicks each control point in view where the pose shows it, off by `error(i)`.
  std::size_t observeControlPoints(const std::function<glm::dvec2(std::size_t)>& error) {
    const auto seen = controlPointsInView(*session().project(), *session().currentFrame());
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const std::size_t before = count();
      points->setCurrentIndex(points->findText(seen[i].name));
      QTest::mouseClick(pick, Qt::LeftButton);
      click(seen[i].pixel + error(i));
      if (!waitFor([&] { return count() == before + 1; }, 10'000) || !settle()) return 0;
    }
    return seen.size();
  }
  /// A design edge of some length, well inside the picture: its ends and their pixels.
  struct DrawnEdge {
    glm::dvec3 a, b;
    glm::dvec2 pixelA, pixelB;
  };
  std::optional<DrawnEdge> drawnEdge() {
    const FrameDescription* frame = view().probe().description();
    for (const DesignLayer& layer : frame->designs)
      for (const auto& edge : layer.model->edges) {
        const DrawnEdge e{layer.model->world(edge[0]), layer.model->world(edge[1]), {}, {}};
        const auto a = view().probe().project(e.a), b = view().probe().project(e.b);
        const auto inside = [&](const auto& p) {
          return p && p->x > 20 && p->y > 20 && p->x < frame->camera.width() - 20 && p->y < frame->camera.height() - 20;
        };
        if (inside(a) && inside(b) && glm::length(*a - *b) > 40) return DrawnEdge{e.a, e.b, *a, *b};
      }
    return std::nullopt;
  }

  QTableView* table = nullptr;
  QComboBox* points = nullptr;
  QPushButton* pick = nullptr;
};

}  // namespace

TEST_F(ResectionWindow, ACornerOfTheDesignIsObserved) {
  const auto edge = drawnEdge();
  ASSERT_TRUE(edge);
  const std::size_t before = count();
  points->setCurrentIndex(points->findText("Corner of the design"));
  QTest::mouseClick(pick, Qt::LeftButton);
  click(edge->pixelA + glm::dvec2(1, -1));
  ASSERT_TRUE(settle());
  EXPECT_EQ(count(), before) << "the corner alone is no observation";
  click(edge->pixelA + glm::dvec2(4, 2));
  ASSERT_TRUE(waitFor([&] { return count() == before + 1; }, 10'000));
  EXPECT_EQ(last().kind, ObservedKind::Control);
  const FrameDescription& frame = *view().probe().description();
  const auto shown = frame.camera.project(frame.cameraFromWorld * last().world);
  ASSERT_TRUE(shown);
  EXPECT_LT(glm::length(*shown - edge->pixelA), 2.5) << "a corner that is drawn where it was clicked";
  EXPECT_LT(glm::length(last().pixel - edge->pixelA - glm::dvec2(4, 2)), 1.5);
}

TEST_F(ResectionWindow, AnEdgeOfTheDesignIsObservedInSeveralPlaces) {
  const auto edge = drawnEdge();
  ASSERT_TRUE(edge);
  const std::size_t before = count();
  points->setCurrentIndex(points->findText("Edge of the design"));
  QTest::mouseClick(pick, Qt::LeftButton);
  const glm::dvec2 middle = 0.5 * (edge->pixelA + edge->pixelB), along = edge->pixelB - edge->pixelA;
  click(middle);
  ASSERT_TRUE(settle());
  const glm::dvec2 across = 3.0 * glm::normalize(glm::dvec2(-along.y, along.x));
  click(middle + 0.2 * along + across);
  click(middle - 0.2 * along + across);
  ASSERT_TRUE(waitFor([&] { return count() == before + 2; }, 10'000));
  key(Qt::Key_Escape);
  EXPECT_EQ(last().kind, ObservedKind::Edge);
  EXPECT_NE(last().world, last().edgeEnd);
  const auto residual = window->refinement().residual(last());
  ASSERT_TRUE(residual);
  EXPECT_NEAR(glm::length(*residual), 3.0, 1.6) << "the distance across the edge, whatever the place along it";
}

TEST_F(ResectionWindow, ThePanelLeavesTheWindowSmallEnoughForAnyScreen) {
  EXPECT_LE(window->minimumSizeHint().height(), 800);
  EXPECT_LE(window->minimumSizeHint().width(), 1280);
}

TEST_F(ResectionWindow, TheTableSortsByResidualAndHoldsOut) {
  const std::size_t observed = observeControlPoints([](std::size_t i) { return glm::dvec2(i == 2 ? 9 : 0, 0.5 * (i % 2)); });
  ASSERT_GE(observed, 6u);
  QAbstractItemModel* model = table->model();
  table->sortByColumn(ObservationModel::Residual, Qt::DescendingOrder);
  const auto key = [&](int row) { return model->index(row, ObservationModel::Residual).data(ObservationModel::kSortRole).toDouble(); };
  for (int row = 1; row < model->rowCount(); ++row) EXPECT_GE(key(row - 1), key(row));
  EXPECT_GT(key(0), 7.0);

  // The worst is held out: it stays in the table, and the fit is good without it.
  ASSERT_TRUE(model->setData(model->index(0, ObservationModel::Check), Qt::Checked, Qt::CheckStateRole));
  ASSERT_TRUE(settle());
  window->refinement().refine();
  ASSERT_TRUE(waitFor([&] { return window->refinement().hasCandidate(); }, 20'000));
  const auto& summary = *window->refinement().summary();
  bool heldOut = false;
  for (const ResidualGroup& group : summary.groups) {
    if (!std::isfinite(group.rmsPx)) continue;
    heldOut = heldOut || group.heldOut;
    EXPECT_EQ(group.rmsPx > 5.0, group.heldOut) << group.rmsPx;
  }
  EXPECT_TRUE(heldOut);
  window->actions()[Command::DropPose]->trigger();
  EXPECT_FALSE(window->refinement().hasCandidate());
}

TEST_F(ResectionWindow, MillimetresAreGivenAtTheChosenPoint) {
  ASSERT_GE(observeControlPoints([](std::size_t i) { return glm::dvec2(0.3 * (i % 3), 0.2); }), 6u);
  const auto place = pixelOnScan(true);
  ASSERT_TRUE(place);
  QTest::mouseClick(window->findChild<QPushButton*>("judge"), Qt::LeftButton);
  click(*place);
  ASSERT_TRUE(waitFor([&] { return window->refinement().judgedAt().has_value(); }, 10'000));
  window->refinement().refine();
  ASSERT_TRUE(waitFor([&] { return window->refinement().hasCandidate(); }, 20'000));
  ASSERT_EQ(window->refinement().summary()->expected.size(), 1u);
  EXPECT_GT(window->refinement().summary()->expected[0].millimetres, 0);
  EXPECT_TRUE(window->findChild<QLabel*>("summary")->text().contains("at the chosen point"));
}

TEST_F(ResectionWindow, DepthsAndSurfacesStandAmongTheObservations) {
  const Frame& frame = *session().currentFrame();
  const auto seen = controlPointsInView(*session().project(), frame);
  ASSERT_FALSE(seen.empty());
  const std::size_t before = count();
  session().change("Add depth", [&](Project& project) {
    Observation point, depth, surface;
    for (const ControlPoint& known : project.controlPoints)
      if (QString::fromStdString(known.name) == seen[0].name) point.world = known.position;
    point.name = depth.name = seen[0].name.toStdString(), surface.name = "T1";
    point.frame = depth.frame = frame.id;
    point.pixel = seen[0].pixel + glm::dvec2(3, 0);
    depth.kind = ObservedKind::Depth, depth.sigmaM = 0.01;
    depth.depthM = (*frame.cameraFromWorld * point.world).z - 0.012;
    surface.kind = ObservedKind::Surface, surface.world = point.world, surface.edgeEnd = {0, 0, 1};
    ObservationId id = nextObservationId(project);
    for (Observation* made : {&depth, &point, &surface}) {
      made->id = id, ++id.value;
      project.observations.push_back(*made);
    }
  });
  ASSERT_TRUE(settle());
  const auto text = [&](int row, int column) { return table->model()->index(row, column).data().toString(); };
  ASSERT_EQ(table->model()->rowCount(), static_cast<int>(before) + 2) << "a surface belongs to no frame";
  window->refinement().setScope(RefinementScope::AllFrames);
  ASSERT_EQ(table->model()->rowCount(), static_cast<int>(before) + 3);
  table->sortByColumn(ObservationModel::Residual, Qt::DescendingOrder);
  EXPECT_EQ(text(0, ObservationModel::Kind), "known");
  EXPECT_NEAR(text(0, ObservationModel::Residual).section(' ', 0, 0).toDouble(), 3, 0.1);
  EXPECT_EQ(text(1, ObservationModel::Kind), "depth");
  EXPECT_EQ(text(1, ObservationModel::Residual), "12.00 mm");
  EXPECT_TRUE(text(1, ObservationModel::Place).endsWith(" m"));
  EXPECT_EQ(text(2, ObservationModel::Kind), "surface");
  const auto flags = [&](int row) { return table->model()->flags(table->model()->index(row, ObservationModel::Check)); };
  EXPECT_TRUE(flags(1) & Qt::ItemIsUserCheckable);
  EXPECT_FALSE(flags(2) & Qt::ItemIsUserCheckable) << "a surface leaves nothing to look at beside the fit";
  picture("observations");
  ASSERT_EQ(view().probe().description()->residuals.size(), 1u) << "only what was seen in the picture is drawn there";

  window->actions()[Command::Undo]->trigger();
  EXPECT_EQ(count(), before);
  window->actions()[Command::Redo]->trigger();
  ASSERT_EQ(count(), before + 3);
  EXPECT_EQ(session().project()->observations[before].kind, ObservedKind::Depth);
}

TEST_F(ResectionWindow, AcceptingAPoseKeepsWhatChangedMeanwhile) {
  ASSERT_GE(observeControlPoints([](std::size_t i) { return glm::dvec2(0.4 * (i % 3), 0.3); }), 6u);
  window->refinement().refine();
  ASSERT_TRUE(waitFor([&] { return window->refinement().hasCandidate(); }, 20'000));
  const FrameId other = session().project()->frames[1].id;
  session().change("Change another", [&](Project& project) {
    project.cameras[0].readoutSecs = 0.01;
    project.findFrame(other)->cameraFromWorld->translation.x += 1;
  });
  const Project before = *session().project();
  window->refinement().accept();
  const Project& after = *session().project();
  EXPECT_EQ(after.cameras[0].readoutSecs, 0.01);
  EXPECT_EQ(after.findFrame(other)->cameraFromWorld->translation, before.findFrame(other)->cameraFromWorld->translation);
  EXPECT_NE(after.frames[0].cameraFromWorld->translation, before.frames[0].cameraFromWorld->translation);
  EXPECT_EQ(after.frames[0].poseSource, PoseSource::Refined);
}

TEST_F(ResectionWindow, ResidualsAreDrawnAsLongAsWanted) {
  auto* scale = window->findChild<ValueSlider*>("residualScale");
  ASSERT_TRUE(scale);
  emit scale->changed(50, false);
  ASSERT_TRUE(settle());
  EXPECT_EQ(session().display().residualScale, 50);
  EXPECT_EQ(view().probe().description()->display.residualScale, 50);
}

TEST_F(ResectionWindow, APointIsFoundInOtherFrames) {
  const std::size_t before = count();
  ASSERT_GE(observeControlPoints([](std::size_t) { return glm::dvec2(0); }), 6u);
  std::size_t found = 0;
  for (int row = 0; row < table->model()->rowCount(); ++row) {
    const std::size_t now = count();
    table->selectRow(row);
    auto* match = window->findChild<QPushButton*>("match");
    ASSERT_TRUE(match->isEnabled());
    QTest::mouseClick(match, Qt::LeftButton);
    ASSERT_TRUE(settle());
    found += count() - now;
  }
  EXPECT_GE(found, 3u) << "the demo's frames overlap";
  // The demo's poses are the truth: what was found lies where they show the point.
  const Project& project = *session().project();
  for (std::size_t i = before; i < project.observations.size(); ++i) {
    const Observation& o = project.observations[i];
    const Frame& frame = *project.findFrame(o.frame);
    const auto place = fittedPixel(project.findCamera(frame.camera)->camera, {}, *frame.cameraFromWorld, o);
    ASSERT_TRUE(place);
    EXPECT_LT(glm::length(*place - o.pixel), 3.0) << frame.name;
  }
}

}  // namespace alidade::test

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// The 3D view through the very path that the window uses: a context and a framebuffer that Qt made.

#include "scene/site_view.h"

#include <cmath>
#include <cstdlib>

#include <QGuiApplication>
#include <QImage>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLFramebufferObject>

#include <gmock/gmock.h>

using namespace alidade;

namespace {

constexpr int kWidth = 900, kHeight = 600;
constexpr DesignId kDesign{7};
/// From a column's centre to the middle of the face that the first view shows.
constexpr glm::dvec3 kSouthFace{0, -0.2, 0};

/// A box as an element of its own, counter-clockwise from outside, with its twelve edges.
void addBox(DesignModel& model, const std::string& name, const glm::vec3& low, const glm::vec3& high, Rgba8 colour) {
  const auto base = static_cast<std::uint32_t>(model.vertices.size());
  DesignElement element;
  element.name = name;
  element.colour = colour;
  element.firstIndex = static_cast<std::uint32_t>(model.triangles.size());
  element.firstEdge = static_cast<std::uint32_t>(model.edges.size());
  for (int i = 0; i < 8; ++i)
    model.vertices.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  constexpr std::uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : faces)
    for (const std::uint32_t v : {f[0], f[1], f[2], f[0], f[2], f[3]}) model.triangles.push_back(base + v);
  for (std::uint32_t i = 0; i < 8; ++i)
    for (const std::uint32_t bit : {1u, 2u, 4u})
      if (!(i & bit)) model.edges.push_back({base + i, base + (i | bit)});
  element.indexCount = static_cast<std::uint32_t>(model.triangles.size()) - element.firstIndex;
  element.edgeCount = static_cast<std::uint32_t>(model.edges.size()) - element.firstEdge;
  model.elements.push_back(element);
}

/// A slab with a red and a blue column, at any place of the world.
std::shared_ptr<DesignModel> makeDesign(const glm::dvec3& place) {
  auto model = std::make_shared<DesignModel>();
  model->origin = place;
  addBox(*model, "slab", {-10, -6, -0.3f}, {10, 6, 0}, {170, 170, 165, 255});
  addBox(*model, "red column", {-5.2f, -0.2f, 0}, {-4.8f, 0.2f, 3}, {200, 60, 50, 255});
  addBox(*model, "blue column", {4.8f, -0.2f, 0}, {5.2f, 0.2f, 3}, {60, 90, 200, 255});
  return model;
}

/// A green plate of points, one every 2 cm, above the slab's eastern end.
std::shared_ptr<const PointStore> makeCloud(const glm::dvec3& place) {
  PointBatch batch;
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 200; ++j) {
      batch.position.push_back(place + glm::dvec3(7 + 0.02 * i / 2, -2 + 0.02 * j, 1.0));
      batch.rgb.push_back({40, 220, 60});
    }
  PointStoreBuilder builder;
  builder.add(batch);
  auto store = builder.build(Progress());
  EXPECT_TRUE(store.has_value());
  return store ? *store : nullptr;
}

Camera makeCamera() {
  Intrinsics k;
  k.width = 640;
  k.height = 480;
  k.fx = k.fy = 600;
  k.cx = 319.5;
  k.cy = 239.5;
  return Camera(k);
}

std::vector<SceneFrustum> makeFrames(const glm::dvec3& place) {
  std::vector<SceneFrustum> frames;
  for (int i = 0; i < 10; ++i) {
    const glm::dvec3 eye = place + glm::dvec3(-9 + 2 * i, -9, 2.5);
    frames.push_back({FrameId{i + 1}, RigidTransform::cameraLookingAt(eye, place + glm::dvec3(0, 0, 1)), makeCamera()});
  }
  return frames;
}

class SiteViewTest : public ::testing::TestWithParam<double> {
 protected:
  void SetUp() override {
    QSurfaceFormat format;
    format.setVersion(3, 2);
    format.setProfile(QSurfaceFormat::CoreProfile);
    format.setDepthBufferSize(24);
    format.setStencilBufferSize(8);
    context.setFormat(format);
    ASSERT_TRUE(context.create());
    surface.setFormat(context.format());
    surface.create();
    ASSERT_TRUE(context.makeCurrent(&surface));
    framebuffer = std::make_unique<QOpenGLFramebufferObject>(kWidth, kHeight,
                                                             QOpenGLFramebufferObject::CombinedDepthStencil);
    view = std::make_unique<SiteView>();
    view->attach({[this] { context.makeCurrent(&surface); },
                  [this] { return QOpenGLContext::currentContext() == &context; }});
    view->resize(kWidth, kHeight, 1.0);
  }

  void TearDown() override {
    view.reset();
    framebuffer.reset();
    context.doneCurrent();
  }

  QImage picture(const char* name) {
    view->paint(framebuffer->handle());
    QImage image = framebuffer->toImage();
    if (const char* folder = std::getenv("ALIDADE_KEEP_PICTURES"))
      image.save(QString("%1/scene_%2_%3.png").arg(folder, name).arg(GetParam()));
    return image;
  }

  QColor colourAt(const QImage& image, const glm::dvec3& world) const {
    const glm::dvec2 px = pixelOf(world);
    return image.pixelColor(static_cast<int>(px.x), static_cast<int>(px.y));
  }

  glm::dvec2 pixelOf(const glm::dvec3& world) const { return glm::dvec2(*view->project(world)); }

  void showAll() {
    place = glm::dvec3(GetParam(), GetParam() * 0.5, 412);
    view->setDesigns({{kDesign, makeDesign(place), {}}});
    view->setClouds({{makeCloud(place), nullptr, 0}});
    view->setStakePoints({{"S1", place + glm::dvec3(0, -2, 0), "peg", 0.5}, {"S2", place + glm::dvec3(0, 5, 0), "", 0.02}});
    view->setFrames(makeFrames(place));
  }

  QOpenGLContext context;
  QOffscreenSurface surface;
  std::unique_ptr<QOpenGLFramebufferObject> framebuffer;
  std::unique_ptr<SiteView> view;
  glm::dvec3 place{0};
};

}  // namespace

TEST_P(SiteViewTest, TheCentreOfAnElementPicksItAndShowsItsColour) {
  showAll();
  const QImage image = picture("all");
  const glm::dvec3 red = place + glm::dvec3(-5, 0, 1.5), blue = place + glm::dvec3(5, 0, 1.5);
  const auto pick = view->pick(pixelOf(red));
  ASSERT_TRUE(pick.has_value());
  EXPECT_EQ(pick->design, kDesign);
  EXPECT_EQ(pick->element, 1);
  EXPECT_LT(glm::length(pick->world - red), 0.4);
  EXPECT_EQ(view->pick(pixelOf(blue))->element, 2);
  const QColor seenRed = colourAt(image, red + kSouthFace);
  EXPECT_GT(seenRed.red(), 2 * seenRed.blue());
  const QColor seenBlue = colourAt(image, blue + kSouthFace);
  EXPECT_GT(seenBlue.blue(), 2 * seenBlue.red());
}

TEST_P(SiteViewTest, APickedScanPointHasItsSourcesCoordinatesAndItsColourIsThere) {
  showAll();
  const QImage image = picture("cloud");
  const glm::dvec3 point = place + glm::dvec3(7 + 0.01 * 100, -2 + 0.02 * 100, 1.0);
  const glm::dvec2 px = pixelOf(point);
  const auto pick = view->pick(px);
  ASSERT_TRUE(pick.has_value());
  EXPECT_EQ(pick->element, -1);
  EXPECT_TRUE(pick->stakePoint.empty());
  EXPECT_EQ(pick->world.z, point.z);
  EXPECT_LT(glm::length(pick->world - point), 0.2);
  const QColor seen = colourAt(image, point);
  EXPECT_GT(seen.green(), 150);
  EXPECT_LT(seen.red(), 100);
}

TEST_P(SiteViewTest, AHiddenElementIsNeitherDrawnNorPicked) {
  showAll();
  const glm::dvec3 face = place + glm::dvec3(-5, 0, 1.5) + kSouthFace;
  const glm::dvec2 px = pixelOf(face);
  view->setDesigns({{kDesign, makeDesign(place), {1, 0, 1}}});
  const QImage image = picture("hidden");
  const auto pick = view->pick(px);
  EXPECT_TRUE(!pick || pick->element != 1);
  const QColor seen = colourAt(image, face);
  EXPECT_LT(std::abs(seen.red() - seen.blue()), 25);
}

TEST_P(SiteViewTest, TheSelectedElementIsHighlighted) {
  showAll();
  const glm::dvec3 face = place + glm::dvec3(5, 0, 1.5) + kSouthFace;
  const QColor before = colourAt(picture("unselected"), face);
  view->setSelectedElement(kDesign, 2);
  const QColor after = colourAt(picture("selected"), face);
  EXPECT_GT(before.blue(), before.red());
  EXPECT_GT(after.red(), after.blue() + 60);
  view->setSelectedElement({}, -1);
  EXPECT_EQ(colourAt(picture("unselected"), face), before);
}

TEST_P(SiteViewTest, AStakePointIsPickedByNameAndAFrameByItsFrustum) {
  showAll();
  picture("marks");
  const auto stake = view->pick(pixelOf(place + glm::dvec3(0, -2, 0)) + glm::dvec2(2, 1));
  ASSERT_TRUE(stake.has_value());
  EXPECT_EQ(stake->stakePoint, "S1");
  EXPECT_EQ(stake->world, place + glm::dvec3(0, -2, 0));
  const auto frame = view->pick(pixelOf(place + glm::dvec3(-9 + 2 * 2, -9, 2.5)));
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(frame->frame, FrameId{3});
}

TEST_P(SiteViewTest, AMarkBehindTheDesignIsNotPickedThroughIt) {
  showAll();
  view->setStakePoints({{"below", place + glm::dvec3(0, 0, -2), "", 0.02}});
  const auto pick = view->pick(pixelOf(place + glm::dvec3(0, 0, -2)));
  ASSERT_TRUE(pick.has_value());
  EXPECT_EQ(pick->stakePoint, "");
  EXPECT_EQ(pick->element, 0);
}

TEST_P(SiteViewTest, OrbitPanAndZoomKeepWhatIsUnderTheCursor) {
  showAll();
  const glm::dvec3 top = place + glm::dvec3(-5, 0, 3);
  const glm::dvec2 px = pixelOf(top) + glm::dvec2(0, 2);
  view->beginDrag(px);
  view->orbit({40, 10});
  EXPECT_LT(glm::length(pixelOf(top) + glm::dvec2(0, 2) - px), 8.0);
  view->beginDrag(px);
  view->pan({25, 30});
  EXPECT_LT(glm::length(pixelOf(top) + glm::dvec2(0, 2) - px - glm::dvec2(25, 30)), 8.0);
  const glm::dvec2 at = pixelOf(top) + glm::dvec2(0, 2);
  const double before = view->project(top)->z;
  view->zoomAt(at, 3.0);
  EXPECT_LT(glm::length(pixelOf(top) + glm::dvec2(0, 2) - at), 12.0);
  EXPECT_NEAR(view->project(top)->z, before / 3.0, 0.05 * before);
  picture("zoomed");
}

TEST_P(SiteViewTest, LookingFromAFrameShowsWhatItsCameraSees) {
  showAll();
  view->lookFromFrame(FrameId{5});
  picture("from_frame");
  const auto frames = makeFrames(place);
  const glm::dvec3 target = place + glm::dvec3(-5, 0, 1.5);
  const auto inPicture = frames[4].camera.project(frames[4].cameraFromWorld * target);
  ASSERT_TRUE(inPicture.has_value());
  // The view is as high as the picture, 600 to 480 pixels, about the same axis.
  const double scale = 600.0 / 480.0;
  EXPECT_NEAR(pixelOf(target).x, 450 + (inPicture->x - 319.5) * scale, 1e-3);
  EXPECT_NEAR(pixelOf(target).y, 300 + (inPicture->y - 239.5) * scale, 1e-3);
}

TEST_P(SiteViewTest, DesignAndScanHideEachOtherByDepth) {
  showAll();
  // The plate hangs a metre above the slab's eastern end: moved below it, the slab hides it.
  const glm::dvec3 above = place + glm::dvec3(8, 0, 1), below = place + glm::dvec3(8, 0, -1);
  const QColor onTop = colourAt(picture("plate_above"), above);
  EXPECT_GT(onTop.green(), 150);
  EXPECT_LT(onTop.red(), 100);
  const glm::dvec2 px = pixelOf(below);
  view->setClouds({{makeCloud(place - glm::dvec3(0, 0, 2)), nullptr, 0}});
  const QImage image = picture("plate_below");
  const QColor slab = image.pixelColor(static_cast<int>(px.x), static_cast<int>(px.y));
  EXPECT_LT(std::abs(slab.red() - slab.green()), 25);
  EXPECT_EQ(view->pick(px)->element, 0);
}

TEST_P(SiteViewTest, ADensityDrawsItsShareOfWhatTheViewCanShow) {
  showAll();
  DisplaySettings display;
  const auto whole = view->stillPointCount();
  EXPECT_GT(whole, 1000u);
  EXPECT_LE(whole, 40000u);
  display.density = 0.25;
  view->setDisplay(display);
  EXPECT_NEAR(static_cast<double>(view->stillPointCount()), 0.25 * static_cast<double>(whole), 0.02 * static_cast<double>(whole));
  display.density = 0;
  view->setDisplay(display);
  EXPECT_EQ(view->stillPointCount(), 0u);
  // Near to it every point is there.
  display.density = 1;
  view->setDisplay(display);
  Bounds plate;
  plate.add(place + glm::dvec3(7.5, -0.2, 1));
  plate.add(place + glm::dvec3(7.6, -0.1, 1));
  view->fitTo(plate);
  picture("near");
  const glm::dvec3 one = place + glm::dvec3(7 + 0.01 * 55, -2 + 0.02 * 92, 1);
  const auto pick = view->pick(pixelOf(one));
  ASSERT_TRUE(pick.has_value());
  EXPECT_LT(glm::length(pick->world - one), 1e-3);
}

TEST_P(SiteViewTest, AMovingViewThatIsSlowDrawsFewerPointsAndAStillOneAll) {
  showAll();
  PointStoreBuilder builder;
  PointBatch batch;
  for (int i = 0; i < 600'000; ++i)
    batch.position.push_back(place + glm::dvec3(-10 + 0.025 * (i % 800), -6 + 0.016 * (i / 800), 4.0));
  builder.add(batch);
  view->setClouds({{*builder.build(Progress()), nullptr, 0}});
  picture("still");
  const auto still = view->drawnPointCount();
  ASSERT_GT(still, 2 * FramePacer::kFewest);
  view->setPace({0.001, 0});  // no machine is so quick: the budget falls to its least
  view->setMoving(true);
  for (int i = 0; i < 12; ++i) {
    view->beginDrag({kWidth / 2, kHeight / 2});
    view->orbit({3, 1});
    picture("moving");
  }
  EXPECT_LT(view->drawnPointCount(), 1.05 * FramePacer::kFewest);
  EXPECT_GT(view->drawnPointCount(), 0.5 * FramePacer::kFewest);
  view->setMoving(false);
  picture("rested");
  EXPECT_GT(view->drawnPointCount(), still / 2);
}

TEST_P(SiteViewTest, TheContextMayGoAndAnotherOneComes) {
  showAll();
  const QImage before = picture("first");
  view->release();
  framebuffer.reset();
  QOpenGLContext second;
  second.setFormat(context.format());
  ASSERT_TRUE(second.create());
  ASSERT_TRUE(second.makeCurrent(&surface));
  {
    QOpenGLFramebufferObject other(kWidth, kHeight, QOpenGLFramebufferObject::CombinedDepthStencil);
    view->attach({[&] { second.makeCurrent(&surface); },
                  [&] { return QOpenGLContext::currentContext() == &second; }});
    view->paint(other.handle());
    EXPECT_TRUE(other.toImage() == before);
    view->release();
  }
  second.doneCurrent();
  context.makeCurrent(&surface);
}

TEST_P(SiteViewTest, AnEmptyViewIsAPlainBackgroundAndTakesEveryCall) {
  view->fitAll();
  view->beginDrag({10, 10});
  view->orbit({5, 5});
  view->zoomAt({10, 10}, 2);
  view->lookFromFrame(FrameId{3});
  view->setCurrentFrame(FrameId{3});
  view->setSelectedElement(kDesign, 4);
  EXPECT_FALSE(view->pick({100, 100}).has_value());
  const QImage image = picture("empty");
  EXPECT_EQ(image.pixelColor(5, 5), image.pixelColor(kWidth - 5, kHeight - 5));
  EXPECT_EQ(image.pixelColor(5, 5).alpha(), 255);
  EXPECT_LT(image.pixelColor(5, 5).lightness(), 80);
}

INSTANTIATE_TEST_SUITE_P(NearAndFar, SiteViewTest, ::testing::Values(0.0, 1e7));

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  QGuiApplication application(argc, argv);
  return RUN_ALL_TESTS();
}

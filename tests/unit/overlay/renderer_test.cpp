// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/renderer.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <QImage>

#include <gtest/gtest.h>

#include "base/log.h"
#include "overlay/annotation_painter.h"
#include "raster/occlusion.h"
#include "unit/overlay/scenes.h"

namespace alidade {

namespace {

constexpr int kWidth = 480, kHeight = 320;

/// ALIDADE_TEST_PICTURES=folder keeps the pictures for looking at.
void keep(const ColourImage& picture, const std::string& name) {
  const char* folder = std::getenv("ALIDADE_TEST_PICTURES");
  if (!folder || picture.empty()) return;
  std::filesystem::create_directories(folder);
  QImage(reinterpret_cast<const uchar*>(picture.data()), picture.width(), picture.height(),
         4 * picture.width(), QImage::Format_RGBA8888)
      .save(QString::fromStdString(std::string(folder) + "/" + name + ".png"));
}

/// A scan known in closed form: a wall at 8 m on the left third, nothing known in the middle third, sky on
/// the right.
DepthImage analyticScan(int width, int height) {
  DepthImage depth(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      depth.at(x, y) = x < width / 3       ? 8.0f
                       : x < 2 * width / 3 ? std::numeric_limits<float>::quiet_NaN()
                                           : std::numeric_limits<float>::infinity();
  return depth;
}

FrameDescription boxesFrame(const glm::dvec3& origin = glm::dvec3(0), int width = kWidth,
                            int height = kHeight) {
  FrameDescription frame;
  frame.camera = wideAngleCamera(width, height);
  frame.cameraFromWorld = poseBefore(origin);
  frame.image = stripedPicture(width, height);
  BoxModel model(origin);
  model.box({-5, 0, 0.3f}, {2.2f, 2, 4}, {210, 90, 60, 255});
  model.box({-1.2f, 0, 0}, {2, 2, 3}, {90, 160, 220, 255});
  model.box({2.5f, 1, 0.5f}, {3, 2, 4}, {120, 200, 120, 255});
  model.box({-5.5f, -4.5f, -0.6f}, {1, 1, 1.5f}, {230, 210, 90, 255});
  frame.designs.push_back({model.made(), {}, {}, {}});
  return frame;
}

/// Every test below holds for both devices.
class DeviceTest : public testing::TestWithParam<const char*> {
 protected:
  static void SetUpTestSuite() {
    s_sink = addLogSink([](LogLevel level, const std::string& message) {
      if (level >= LogLevel::Warning && message.find("Validation") != std::string::npos)
        ++s_validationMessages;
    });
    auto made = createVulkanDevice();
    ASSERT_TRUE(made) << made.error().text();
    s_vulkan = made->release();
    s_cpu = createCpuDevice().release();
  }
  static void TearDownTestSuite() {
    delete s_vulkan;
    delete s_cpu;
    s_vulkan = s_cpu = nullptr;
    removeLogSink(s_sink);
    EXPECT_EQ(s_validationMessages, 0) << "the validation layer objects; see the log above";
  }
  /// The frame's design before the analytic scan, without renderer and points.
  OverlayDevice::Output draw(const FrameDescription& frame, const DepthImage* scan,
                             const ColourImage* points = nullptr) {
    DrawList list = buildDrawList(frame, frame.camera);
    list.image = frame.image.get();
    list.scanDepth = scan;
    list.pointColour = points;
    auto output = (std::string(GetParam()) == "cpu" ? s_cpu : s_vulkan)->draw(list);
    EXPECT_TRUE(output) << output.error().text();
    return output ? std::move(*output) : OverlayDevice::Output{};
  }
  static OverlayDevice *s_vulkan, *s_cpu;
  static int s_sink, s_validationMessages;
};
int DeviceTest::s_sink = 0, DeviceTest::s_validationMessages = 0;
OverlayDevice *DeviceTest::s_vulkan = nullptr, *DeviceTest::s_cpu = nullptr;

INSTANTIATE_TEST_SUITE_P(Both, DeviceTest, testing::Values("cpu", "vulkan"),
                         [](const auto& which) { return std::string(which.param); });

std::size_t differingPixels(const ColourImage& a, const ColourImage& b, int least = 3) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Rgba8 p = a.data()[i], q = b.data()[i];
    if (std::abs(p.r - q.r) >= least || std::abs(p.g - q.g) >= least || std::abs(p.b - q.b) >= least) ++count;
  }
  return count;
}

}  // namespace

TEST_P(DeviceTest, EveryPixelIsVisibleHiddenOrUnknownAsTheScanSays) {
  const FrameDescription frame = boxesFrame();
  const DepthImage scan = analyticScan(kWidth, kHeight);
  const auto out = draw(frame, &scan);
  int counts[4] = {};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const auto state = static_cast<Visibility>(out.state.at(x, y));
      ++counts[static_cast<int>(state)];
      if (out.element.at(x, y) == 0) {
        ASSERT_EQ(state, Visibility::Outside);
        ASSERT_TRUE(std::isinf(out.designDepth.at(x, y)));
        continue;
      }
      const double z = out.designDepth.at(x, y);
      ASSERT_EQ(state, visibilityAt(scan, {x, y}, z, frame.display.depthToleranceM))
          << x << " " << y << " " << z;
      ASSERT_TRUE(x < 2 * kWidth / 3 || state == Visibility::Visible);
    }
  for (const int count : counts) EXPECT_GT(count, 1000);
}

TEST_P(DeviceTest, DepthAndElementAreThoseOfTheNearestFaceAlongTheExactRay) {
  const FrameDescription frame = boxesFrame();
  const auto out = draw(frame, nullptr);
  const DesignModel& model = *frame.designs[0].model;
  int checked = 0, otherElement = 0;
  double worst = 0;
  for (int y = 1; y < kHeight; y += 5)
    for (int x = 1; x < kWidth; x += 5) {
      const auto ray = frame.camera.unproject({x, y});
      ASSERT_TRUE(ray);
      // A tenth of a pixel aside: how fast the depth changes there.
      const auto aside = frame.camera.unproject({x + 0.1, y + 0.1}),
                 other = frame.camera.unproject({x + 0.1, y - 0.1});
      ASSERT_TRUE(aside && other);
      double nearest = std::numeric_limits<double>::infinity(), allowed = 0;
      std::uint32_t owner = 0;
      for (std::uint32_t e = 0; e < model.elements.size(); ++e)
        for (std::uint32_t i = 0; i < 36; i += 3) {
          glm::dvec3 p[3];
          for (int k = 0; k < 3; ++k)
            p[k] = frame.cameraFromWorld * model.world(model.triangles[model.elements[e].firstIndex + i + k]);
          const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
          const double t = glm::dot(n, p[0]) / glm::dot(n, *ray);
          const glm::dvec3 hit = t * *ray;
          bool inside = t > 0;
          for (int k = 0; k < 3; ++k)
            inside = inside && glm::dot(n, glm::cross(p[(k + 1) % 3] - p[k], hit - p[k])) >= 0;
          if (!inside || t >= nearest) continue;
          nearest = t;
          owner = e + 1;
          allowed = 1e-4 * t;
          for (const glm::dvec3& shifted : {*aside, *other})
            allowed += std::abs(glm::dot(n, p[0]) / glm::dot(n, shifted) - t);
        }
      if (owner != out.element.at(x, y)) {
        ++otherElement;  // a pixel on a silhouette may fall to either side
        continue;
      }
      if (owner == 0) continue;
      ++checked;
      worst = std::max(worst, std::abs(out.designDepth.at(x, y) - nearest) / allowed);
    }
  EXPECT_GT(checked, 800);
  EXPECT_LE(otherElement, checked / 100);
  EXPECT_LT(worst, 1) << "depth is off by more than a tenth of a pixel and 0.1 mm a metre";
}

TEST_P(DeviceTest, APictureTenThousandKilometresFromTheOriginIsTheSame) {
  const auto near = draw(boxesFrame(), nullptr);
  const auto far = draw(boxesFrame({1.0e7, 9.0e6, 500}), nullptr);
  EXPECT_LE(differingPixels(near.colour, far.colour), near.colour.size() / 5000);
}

TEST_P(DeviceTest, TheThreeHiddenStylesDifferAndHidingShowsTheImage) {
  const DepthImage scan = analyticScan(kWidth, kHeight);
  FrameDescription frame = boxesFrame();
  ColourImage pictures[3];
  OverlayDevice::Output last;
  for (const HiddenStyle style : {HiddenStyle::Hide, HiddenStyle::Ghost, HiddenStyle::Dash}) {
    frame.display.hidden = style;
    last = draw(frame, &scan);
    pictures[static_cast<int>(style)] = last.colour;
    keep(last.colour, "hidden-" + std::to_string(static_cast<int>(style)));
  }
  EXPECT_GT(differingPixels(pictures[0], pictures[1], 8), 2000u);
  EXPECT_GT(differingPixels(pictures[1], pictures[2], 8), 2000u);
  EXPECT_GT(differingPixels(pictures[0], pictures[2], 8), 1000u);
  // Hide: the raw picture wherever a face is hidden, but for edges that the neighbouring element shows.
  std::size_t hidden = 0, raw = 0;
  for (std::size_t i = 0; i < last.state.size(); ++i) {
    if (last.state.data()[i] != static_cast<std::uint8_t>(Visibility::Hidden)) continue;
    ++hidden;
    const Rgba8 a = pictures[0].data()[i], b = frame.image->data()[i];
    if (std::abs(a.r - b.r) <= 1 && std::abs(a.g - b.g) <= 1 && std::abs(a.b - b.b) <= 1) ++raw;
  }
  EXPECT_GT(hidden, 1000u);
  EXPECT_GE(raw, hidden * 97 / 100);
}

/// A slab flush with a scanned wall, and behind it a large bed with a small box inside, all of one camera.
FrameDescription buriedFrame() {
  FrameDescription frame;
  frame.camera = wideAngleCamera(kWidth, kHeight);
  frame.cameraFromWorld = RigidTransform::cameraLookingAt({0, -10, 0}, {0, 0, 0});
  frame.image = stripedPicture(kWidth, kHeight);
  BoxModel model(glm::dvec3(0));
  model.box({0, 0.1f, 0}, {6, 0.2f, 4}, {180, 180, 180, 255});       // front at 10 m, back 0.2 m behind it
  model.box({0, 2, 0}, {5, 3, 3}, {200, 160, 90, 255});              // the bed
  model.box({0.5f, 2, 0}, {1.5f, 0.5f, 0.5f}, {40, 220, 220, 255});  // buried in it
  frame.designs.push_back({model.made(), {}, {}, {}});
  return frame;
}

TEST_P(DeviceTest, WhatLiesBuriedShowsThroughTheVisibleFaceAndTheSmallestShowsFirst) {
  FrameDescription frame = buriedFrame();
  const DepthImage scan(kWidth, kHeight, 10.0f);
  ColourImage pictures[3];
  OverlayDevice::Output out;
  for (const HiddenStyle style : {HiddenStyle::Hide, HiddenStyle::Ghost, HiddenStyle::Dash}) {
    frame.display.hidden = style;
    out = draw(frame, &scan);
    pictures[static_cast<int>(style)] = out.colour;
    keep(out.colour, "buried-" + std::to_string(static_cast<int>(style)));
    ASSERT_EQ(out.hiddenElement.size(), out.element.size()) << "counted whatever the style";
  }
  // What a ray through the pixel meets in closed form: a box is met where its front rectangle is, or a side.
  const auto hits = [&](const glm::dvec3& ray, const glm::dvec3& centre, const glm::dvec3& size) {
    double enter = 0, leave = 1e9;
    for (int k = 0; k < 3; ++k) {
      const double a = (centre[k] - size[k] / 2) / ray[k], b = (centre[k] + size[k] / 2) / ray[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter < leave;
  };
  int buried = 0, bed = 0, bare = 0, wrong = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (out.element.at(x, y) != 1) continue;
      ASSERT_EQ(out.state.at(x, y), static_cast<std::uint8_t>(Visibility::Visible));
      ASSERT_NEAR(out.designDepth.at(x, y), 10, 1e-4) << "the images speak of the front layer";
      const glm::dvec3 ray = *frame.camera.unproject({x, y});
      const bool meetsBox = hits(ray, {0.5, 0, 12}, {1.5, 0.5, 0.5}),
                 meetsBed = hits(ray, {0, 0, 12}, {5, 3, 3});
      const std::uint32_t expected = meetsBox ? 3 : meetsBed ? 2 : 0;
      wrong += out.hiddenElement.at(x, y) != expected;
      ++(meetsBox ? buried : meetsBed ? bed : bare);
    }
  EXPECT_GT(buried, 300);
  EXPECT_GT(bed, 3000);
  EXPECT_GT(bare, 3000);
  EXPECT_LE(wrong, 40) << "a silhouette pixel may fall to either side";
  EXPECT_GT(differingPixels(pictures[0], pictures[1], 4), 8000u) << "a ghost over the whole bed";
  EXPECT_GT(differingPixels(pictures[1], pictures[2], 4), 3000u);
  const Rgba8 hide = pictures[0].at(kWidth / 2 + 20, kHeight / 2),
              ghost = pictures[1].at(kWidth / 2 + 20, kHeight / 2);
  EXPECT_LT(ghost.r, hide.r) << "tinted by the cyan box";
  EXPECT_LT(std::abs(ghost.r - hide.r), 60) << "and still readable";
}

TEST_P(DeviceTest, ASolidAloneShowsNothingOfItsOwnInside) {
  FrameDescription frame = buriedFrame();
  frame.designs[0].elementVisible = {1, 0, 0};
  const DepthImage scan(kWidth, kHeight, 10.0f);
  frame.display.hidden = HiddenStyle::Hide;
  const auto hide = draw(frame, &scan);
  frame.display.hidden = HiddenStyle::Ghost;
  const auto ghost = draw(frame, &scan);
  for (std::size_t i = 0; i < ghost.hiddenElement.size(); ++i) ASSERT_EQ(ghost.hiddenElement.data()[i], 0u);
  EXPECT_EQ(differingPixels(hide.colour, ghost.colour, 2), 0u);
}

TEST_P(DeviceTest, SpecksOfTheScanAreStyledAsWhatIsAroundThemAndReportedAsTheyAre) {
  FrameDescription frame = buriedFrame();
  frame.designs[0].elementVisible = {1, 0, 0};
  DepthImage scan(kWidth, kHeight, 10.0f);
  const auto clean = draw(frame, &scan);
  scan.at(240, 160) = std::numeric_limits<float>::quiet_NaN();
  scan.at(200, 150) = 3.0f;
  const auto specked = draw(frame, &scan);
  EXPECT_EQ(specked.state.at(240, 160), static_cast<std::uint8_t>(Visibility::Unknown));
  EXPECT_EQ(specked.state.at(200, 150), static_cast<std::uint8_t>(Visibility::Hidden));
  EXPECT_EQ(differingPixels(clean.colour, specked.colour, 2), 0u);
  for (int y = 140; y < 180; ++y)
    for (int x = 220; x < 260; ++x) scan.at(x, y) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_GT(differingPixels(clean.colour, draw(frame, &scan).colour, 8), 1000u) << "an area is no speck";
}

TEST_P(DeviceTest, UnknownIsDrawnInAShapeOfItsOwn) {
  FrameDescription frame = boxesFrame();
  frame.display.hidden = HiddenStyle::Dash;
  const DepthImage unknown(kWidth, kHeight, std::numeric_limits<float>::quiet_NaN());
  const DepthImage wall(kWidth, kHeight, 0.5f);
  const auto a = draw(frame, &unknown), b = draw(frame, &wall), c = draw(frame, nullptr);
  keep(a.colour, "all-unknown");
  keep(b.colour, "all-hidden-dash");
  EXPECT_GT(differingPixels(a.colour, b.colour, 8), 3000u);
  EXPECT_GT(differingPixels(a.colour, c.colour, 8), 3000u);
}

TEST_P(DeviceTest, PassesCanBeSwitchedOff) {
  FrameDescription frame = boxesFrame();
  frame.display.designPass = false;
  const auto imageAlone = draw(frame, nullptr);
  EXPECT_EQ(differingPixels(imageAlone.colour, *frame.image, 1), 0u)
      << "the image alone is the image, bit for bit";
  for (std::size_t i = 0; i < imageAlone.element.size(); ++i) ASSERT_EQ(imageAlone.element.data()[i], 0u);

  frame = boxesFrame();
  frame.display.imagePass = false;
  const auto noImage = draw(frame, nullptr);
  EXPECT_LT(noImage.colour.at(3, 3).r, 60);

  frame = boxesFrame();
  const auto all = draw(frame, nullptr);
  frame.display.designEdges = false;
  const auto noEdges = draw(frame, nullptr);
  EXPECT_GT(differingPixels(all.colour, noEdges.colour, 8), 500u);
  frame = boxesFrame();
  frame.display.designFaces = false;
  const auto noFaces = draw(frame, nullptr);
  EXPECT_GT(differingPixels(all.colour, noFaces.colour, 8), 5000u);
  EXPECT_EQ(noFaces.element.at(240, 160), all.element.at(240, 160)) << "picking goes on without faces";
}

TEST_P(DeviceTest, GrayscaleSwitchesTakeTheColourOutOfImageAndDesign) {
  FrameDescription frame = boxesFrame();
  frame.display.grayscaleImage = frame.display.grayscaleDesign = true;
  const auto out = draw(frame, nullptr);
  for (std::size_t i = 0; i < out.colour.size(); ++i) {
    const Rgba8 c = out.colour.data()[i];
    ASSERT_LE(std::abs(c.r - c.g), 1);
    ASSERT_LE(std::abs(c.g - c.b), 1);
  }
}

TEST_P(DeviceTest, PointsLieHalfTransparentOverTheRest) {
  const FrameDescription frame = boxesFrame();
  ColourImage points(kWidth, kHeight, {0, 0, 0, 0});
  points.at(100, 50) = {255, 0, 0, 255};
  const auto without = draw(frame, nullptr), with = draw(frame, nullptr, &points);
  EXPECT_EQ(differingPixels(without.colour, with.colour, 1), 1u);
  EXPECT_NEAR(with.colour.at(100, 50).r, (255 + without.colour.at(100, 50).r) / 2.0, 1.5);
}

TEST_P(DeviceTest, SelectionChangesTheLook) {
  FrameDescription frame = boxesFrame();
  const auto plain = draw(frame, nullptr);
  frame.designs[0].selected = {1};
  const auto selected = draw(frame, nullptr);
  keep(selected.colour, "selected");
  std::size_t ofElement = 0, changed = 0;
  for (std::size_t i = 0; i < plain.element.size(); ++i) {
    if (plain.element.data()[i] != 2) continue;
    ++ofElement;
    if (!(plain.colour.data()[i] == selected.colour.data()[i])) ++changed;
  }
  EXPECT_GT(changed, ofElement * 9 / 10);
}

TEST_P(DeviceTest, AnotherImageSizeIsStretchedOverTheResult) {
  FrameDescription frame = boxesFrame();
  frame.display.designPass = false;
  frame.image = stripedPicture(kWidth / 4, kHeight / 4);
  const auto out = draw(frame, nullptr);
  EXPECT_EQ(out.colour.at(2, 2), frame.image->at(0, 0));
  EXPECT_EQ(out.colour.at(kWidth - 3, kHeight - 3), frame.image->at(kWidth / 4 - 1, kHeight / 4 - 1));
}

TEST_P(DeviceTest, FramesOfChangingSizeFollowEachOther) {
  for (const auto& [w, h] : {std::pair{64, 48}, {480, 320}, {31, 17}, {480, 320}}) {
    const FrameDescription frame = boxesFrame(glm::dvec3(0), w, h);
    EXPECT_EQ(draw(frame, nullptr).colour.width(), w);
  }
}

TEST(OverlayRenderer, GivesAPictureWithCountsMarksAndNames) {
  auto renderer = OverlayRenderer::create();
  ASSERT_TRUE(renderer) << renderer.error().text();
  EXPECT_FALSE((*renderer)->deviceName().empty());
  FrameDescription frame = boxesFrame(glm::dvec3(2.0e6, 5.0e5, 300), 1280, 800);
  const glm::dvec3 origin = frame.designs[0].model->origin;
  for (int i = 0; i < 6; ++i)
    frame.stakePoints.push_back(
        {"S" + std::to_string(100 + i), origin + glm::dvec3(i * 1.2 - 3, -2 - 0.4 * i, -1.4), "AXIS", 0.25});
  frame.selectedStakePoints = {"S102"};
  Annotation note;
  note.id = {7};
  note.kind = AnnotationKind::Callout;
  note.anchor = AnnotationAnchor::World;
  note.world = origin + glm::dvec3(-1.2, -1, 1.5);
  note.text = "Formwork stands 12 mm proud here, check again before the pour";
  note.offsetPx = {140, -120};
  frame.annotations.push_back(note);
  Annotation arrow;
  arrow.id = {8};
  arrow.kind = AnnotationKind::Arrow;
  arrow.pixel = {300, 500};
  arrow.offsetPx = {-120, 60};
  arrow.text = "crack";
  frame.annotations.push_back(arrow);
  frame.selectedAnnotation = {8};
  frame.residuals.push_back({{700, 300}, {703, 298}, "P1"});
  frame.display.residualScale = 20;
  frame.width = 960;
  frame.height = 600;
  const auto picture = (*renderer)->render(frame);
  ASSERT_TRUE(picture) << picture.error().text();
  keep(picture->colour, "marks");
  EXPECT_EQ(picture->colour.width(), 960);
  ASSERT_EQ(picture->elements.size(), 4u);
  std::uint64_t total = 0, covered = 0;
  for (const ElementPixels& e : picture->elements) {
    total += e.visible;
    EXPECT_EQ(e.hidden + e.unknown, 0u) << "no scan hides anything";
  }
  for (std::size_t i = 0; i < picture->element.size(); ++i) covered += picture->element.data()[i] != 0;
  EXPECT_EQ(total, covered);
  EXPECT_EQ(picture->firstElementOfLayer, std::vector<std::uint32_t>{0});

  const Camera scaled = frame.camera.scaledTo(960, 600);
  EXPECT_EQ(annotationAt(frame, scaled, {(300 + 0.5) * 0.75 - 0.5, 500 * 0.75}), AnnotationId{8});
  EXPECT_EQ(annotationAt(frame, scaled, {950, 590}), AnnotationId{});
  const auto tip = scaled.project(frame.cameraFromWorld * note.world);
  ASSERT_TRUE(tip);
  EXPECT_EQ(annotationAt(frame, scaled, *tip + glm::dvec2(140, -120) * 0.75 + glm::dvec2(20, 0)),
            AnnotationId{7});

  frame.stakePoints.clear();
  frame.annotations.clear();
  frame.residuals.clear();
  const auto bare = (*renderer)->render(frame);
  ASSERT_TRUE(bare);
  EXPECT_GT(differingPixels(bare->colour, picture->colour, 8), 3000u);
}

TEST(OverlayRenderer, MarksOfADraftAreAsLargeOnceItIsEnlarged) {
  auto renderer = OverlayRenderer::create();
  ASSERT_TRUE(renderer);
  const auto marked = [&](int width, double enlargement) {
    FrameDescription frame = boxesFrame(glm::dvec3(0), 1280, 800);
    frame.designs.clear();
    frame.width = width, frame.height = width * 5 / 8;
    frame.enlargement = enlargement;
    const auto bare = (*renderer)->render(frame);
    frame.stakePoints.push_back({"S100", {0, 0, 0}, "AXIS", 0.01});
    const auto picture = (*renderer)->render(frame);
    return static_cast<double>(differingPixels(bare->colour, picture->colour, 8));
  };
  const double whole = marked(1280, 1), draft = marked(640, 2);
  EXPECT_GT(whole, 400);
  EXPECT_GT(draft, 0.18 * whole);
  EXPECT_LT(draft, 0.36 * whole);
}

TEST(OverlayRenderer, RefusesAFrameWithoutCameraOrOfAnImpossibleSize) {
  auto renderer = OverlayRenderer::create();
  ASSERT_TRUE(renderer);
  EXPECT_FALSE((*renderer)->render({}));
  FrameDescription frame = boxesFrame();
  frame.width = 1'000'000;
  EXPECT_FALSE((*renderer)->render(frame));
  frame = boxesFrame();
  frame.cameraFromWorld.translation.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE((*renderer)->render(frame));
}

}  // namespace alidade

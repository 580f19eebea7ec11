// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Holds the two devices together pixel by pixel: each is the other's oracle.

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "overlay/device.h"
#include "unit/gpu/test_cameras.h"
#include "unit/overlay/scenes.h"

namespace alidade {

namespace {

constexpr int kWidth = 480, kHeight = 320;

/// Houses, slabs, thin posts, one box around the camera and one buried, at survey coordinates.
std::shared_ptr<const DesignModel> yard(const glm::dvec3& origin) {
  BoxModel model(origin);
  model.box({-5, 0, 0.3f}, {2.2f, 2, 4}, {210, 90, 60, 255});
  model.box({-1.2f, 0, 0}, {2, 2, 3}, {90, 160, 220, 255});
  model.box({2.5f, 1, 0.5f}, {3, 2, 4}, {120, 200, 120, 255});
  model.box({2.5f, 1, 0.5f}, {1, 1, 1}, {220, 60, 200, 255});
  model.box({0, -3, -1.6f}, {24, 24, 0.2f}, {180, 180, 180, 255});
  model.box({0, -9, 5}, {30, 6, 0.3f}, {220, 200, 140, 255});
  for (int i = 0; i < 12; ++i)
    model.box({-6 + 1.1f * static_cast<float>(i), 4, 0}, {0.08f, 0.08f, 5}, {230, 210, 90, 255});
  return model.made();
}

/// A wall at 9 m on the left, nothing known in the middle with specks, free sight on the right.
DepthImage scanOf(int width, int height) {
  DepthImage depth(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      depth.at(x, y) = x < width / 3       ? 9.0f + 0.05f * std::sin(0.9f * static_cast<float>(x + 3 * y))
                       : x < 2 * width / 3 ? std::numeric_limits<float>::quiet_NaN()
                                           : std::numeric_limits<float>::infinity();
      if ((x * 7 + y * 13) % 97 == 0) depth.at(x, y) = x % 2 ? 3.0f : 40.0f;
    }
  return depth;
}

FrameDescription frameOf(const Camera& camera, const glm::dvec3& origin = {4.0e5, 5.6e6, 100}) {
  FrameDescription frame;
  frame.camera = camera;
  frame.cameraFromWorld = poseBefore(origin);
  frame.image = stripedPicture(camera.width(), camera.height());
  frame.designs.push_back({yard(origin), {}, {}, {}});
  frame.designs[0].selected = {2};
  return frame;
}

/// Shares of the pixels, and of those whose names and states agree.
struct Difference {
  double element = 0, state = 0, hidden = 0, colour = 0, depth = 0;
  int worstColour = 0;
  std::uint64_t design = 0;
};

Difference compare(const OverlayDevice::Output& a, const OverlayDevice::Output& b) {
  Difference d;
  const std::size_t n = a.element.size();
  for (std::size_t i = 0; i < n; ++i) {
    d.design += a.element.data()[i] != 0;
    const bool sameElement = a.element.data()[i] == b.element.data()[i];
    const bool sameState = a.state.data()[i] == b.state.data()[i];
    const bool sameHidden = a.hiddenElement.empty() || a.hiddenElement.data()[i] == b.hiddenElement.data()[i];
    d.element += !sameElement;
    d.state += sameElement && !sameState;
    d.hidden += !sameHidden;
    if (!sameElement || !sameState || !sameHidden) continue;
    const float p = a.designDepth.data()[i], q = b.designDepth.data()[i];
    d.depth += std::isinf(p) != std::isinf(q) || (std::isfinite(p) && std::abs(p - q) > 1e-3f * p);
    const Rgba8 u = a.colour.data()[i], v = b.colour.data()[i];
    const int largest = std::max({std::abs(u.r - v.r), std::abs(u.g - v.g), std::abs(u.b - v.b)});
    d.worstColour = std::max(d.worstColour, largest);
    d.colour += largest > 3;
  }
  for (double* share : {&d.element, &d.state, &d.hidden, &d.colour, &d.depth})
    *share /= static_cast<double>(n);
  return d;
}

class DeviceTwins : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto made = createVulkanDevice();
    ASSERT_TRUE(made) << made.error().text();
    s_vulkan = made->release();
    s_cpu = createCpuDevice().release();
  }
  static void TearDownTestSuite() {
    delete s_vulkan;
    delete s_cpu;
    s_vulkan = s_cpu = nullptr;
  }
  static OverlayDevice::Output draw(OverlayDevice& device, const FrameDescription& frame,
                                    const DepthImage* scan, const ColourImage* points = nullptr) {
    DrawList list = buildDrawList(frame, frame.camera);
    list.image = frame.image.get();
    list.scanDepth = scan;
    list.pointColour = points;
    auto output = device.draw(list);
    EXPECT_TRUE(output) << output.error().text();
    return output ? std::move(*output) : OverlayDevice::Output{};
  }
  static void expectTwins(const FrameDescription& frame, const DepthImage* scan, const std::string& what,
                          const ColourImage* points = nullptr) {
    const auto vulkan = draw(*s_vulkan, frame, scan, points), cpu = draw(*s_cpu, frame, scan, points);
    ASSERT_EQ(vulkan.hiddenElement.size(), cpu.hiddenElement.size()) << what;
    const Difference d = compare(vulkan, cpu);
    if (std::getenv("ALIDADE_TEST_FIGURES"))
      printf("%-30s element %.5f state %.5f hidden %.5f depth %.5f colour %.5f worst %d\n", what.c_str(),
             d.element, d.state, d.hidden, d.depth, d.colour, d.worstColour);
    EXPECT_LE(d.element, 0.001) << what;
    EXPECT_LE(d.state, 0.001) << what;
    EXPECT_LE(d.hidden, 0.001) << what;
    EXPECT_LE(d.depth, 0.0005) << what;
    EXPECT_LE(d.colour, 0.002) << what << ": worst " << d.worstColour;
  }
  static OverlayDevice *s_vulkan, *s_cpu;
};
OverlayDevice *DeviceTwins::s_vulkan = nullptr, *DeviceTwins::s_cpu = nullptr;

}  // namespace

TEST_F(DeviceTwins, FacesAloneAreTheSame) {
  FrameDescription frame = frameOf(wideAngleCamera(kWidth, kHeight));
  frame.display.designEdges = false;
  expectTwins(frame, nullptr, "faces");
  const auto out = draw(*s_cpu, frame, nullptr);
  EXPECT_GT(compare(out, out).design, 60000u) << "the scene must fill the picture";
}

TEST_F(DeviceTwins, FacesWithEdgesAreTheSame) {
  expectTwins(frameOf(wideAngleCamera(kWidth, kHeight)), nullptr, "faces and edges");
}

TEST_F(DeviceTwins, EveryHiddenStyleIsTheSame) {
  FrameDescription frame = frameOf(wideAngleCamera(kWidth, kHeight));
  const DepthImage scan = scanOf(kWidth, kHeight);
  for (const HiddenStyle style : {HiddenStyle::Hide, HiddenStyle::Ghost, HiddenStyle::Dash}) {
    frame.display.hidden = style;
    frame.display.designEdges = false;
    expectTwins(frame, &scan, "style without edges " + std::to_string(static_cast<int>(style)));
    frame.display.designEdges = true;
    expectTwins(frame, &scan, "style " + std::to_string(static_cast<int>(style)));
  }
}

TEST_F(DeviceTwins, AnImageOfAnotherSizeGrayscaleAndPointsAreTheSame) {
  FrameDescription frame = frameOf(wideAngleCamera(kWidth, kHeight));
  frame.image = stripedPicture(kWidth / 3, kHeight / 3);
  ColourImage points(kWidth, kHeight, {0, 0, 0, 0});
  for (int i = 0; i < kHeight; ++i) points.at(i, i) = {255, 0, 0, 255};
  expectTwins(frame, nullptr, "stretched image, points", &points);
  frame.display.grayscaleImage = frame.display.grayscaleDesign = true;
  expectTwins(frame, nullptr, "grayscale");
  frame.display.imagePass = frame.display.designFaces = false;
  frame.image.reset();
  expectTwins(frame, nullptr, "edges alone on the ground colour");
}

TEST_F(DeviceTwins, AnElementOfEdgesAloneTakesItsPixels) {
  FrameDescription frame = frameOf(wideAngleCamera(kWidth, kHeight));
  auto model = std::make_shared<DesignModel>(*frame.designs[0].model);
  for (const std::size_t post : {1, 9, 12}) model->elements[post].indexCount = 0;
  frame.designs[0].model = model;
  expectTwins(frame, nullptr, "edges alone");
  const DepthImage scan = scanOf(kWidth, kHeight);
  expectTwins(frame, &scan, "edges alone before the scan");
  const auto out = draw(*s_cpu, frame, &scan);
  int taken = 0;
  for (std::size_t i = 0; i < out.element.size(); ++i) taken += out.element.data()[i] == 2;
  EXPECT_GT(taken, 300);
}

TEST_F(DeviceTwins, TheMeasureSeesADesignATenthOfAPixelAside) {
  FrameDescription frame = frameOf(wideAngleCamera(kWidth, kHeight));
  const auto here = draw(*s_cpu, frame, nullptr);
  frame.cameraFromWorld.translation.x += 10.0 * 0.1 / frame.camera.intrinsics().fx;
  const Difference d = compare(here, draw(*s_vulkan, frame, nullptr));
  EXPECT_TRUE(d.element > 0.001 || d.colour > 0.002) << d.element << " " << d.colour;
}

TEST_F(DeviceTwins, EveryInstructionSetGivesTheSameBitForBit) {
  const DepthImage scan = scanOf(kWidth + 5, kHeight - 3);
  FrameDescription frame = frameOf(wideAngleCamera(kWidth + 5, kHeight - 3));
  for (const HiddenStyle style : {HiddenStyle::Ghost, HiddenStyle::Dash}) {
    frame.display.hidden = style;
    setenv("ALIDADE_SIMD", "scalar", 1);
    const auto expected = draw(*s_cpu, frame, &scan);
    for (const char* other : {"avx2", "avx512"}) {
      setenv("ALIDADE_SIMD", other, 1);
      const auto out = draw(*s_cpu, frame, &scan);
      std::size_t differing = 0;
      for (std::size_t i = 0; i < out.element.size(); ++i)
        differing += out.element.data()[i] != expected.element.data()[i] ||
                     out.designDepth.data()[i] != expected.designDepth.data()[i] ||
                     out.state.data()[i] != expected.state.data()[i] ||
                     out.hiddenElement.data()[i] != expected.hiddenElement.data()[i] ||
                     !(out.colour.data()[i] == expected.colour.data()[i]);
      EXPECT_EQ(differing, 0u) << other;
    }
    unsetenv("ALIDADE_SIMD");
  }
}

TEST(DeviceChoice, FollowsTheEnvironmentAndRefusesWhatIsNotThere) {
  setenv("ALIDADE_DEVICE", "cpu", 1);
  const auto cpu = createOverlayDevice();
  setenv("ALIDADE_DEVICE", "vulkan", 1);
  const auto vulkan = createOverlayDevice();
  setenv("ALIDADE_DEVICE", "abacus", 1);
  const auto abacus = createOverlayDevice();
  unsetenv("ALIDADE_DEVICE");
  ASSERT_TRUE(cpu);
  EXPECT_EQ((*cpu)->name().rfind("CPU (", 0), 0u);
  ASSERT_TRUE(vulkan);
  EXPECT_EQ((*vulkan)->name().rfind("Vulkan: ", 0), 0u);
  ASSERT_FALSE(abacus);
  EXPECT_NE(abacus.error().text().find("abacus"), std::string::npos);
  // The tests' Vulkan runs on the processor; left alone, the choice is the CPU device.
  const auto chosen = createOverlayDevice();
  ASSERT_TRUE(chosen);
  EXPECT_EQ((*chosen)->name(), (*cpu)->name());
}

TEST_F(DeviceTwins, EveryLensGivesTheSame) {
  for (const Camera& camera : camerasOfEveryModel()) {
    const Camera small = camera.scaledTo(kWidth, kWidth * camera.height() / camera.width());
    const DepthImage scan = scanOf(small.width(), small.height());
    expectTwins(frameOf(small), &scan, nameOf(camera));
  }
}

}  // namespace alidade

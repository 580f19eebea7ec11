// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

#include "image/image_compare.h"
#include "overlay/device.h"
#include "unit/overlay/scenes.h"

namespace alidade {

namespace {

constexpr int kWidth = 240, kHeight = 160;

FrameDescription smallScene() {
  FrameDescription frame;
  frame.camera = wideAngleCamera(kWidth, kHeight);
  frame.cameraFromWorld = poseBefore(glm::dvec3(4.0e5, 5.6e6, 100));
  frame.image = stripedPicture(kWidth, kHeight);
  BoxModel model({4.0e5, 5.6e6, 100});
  model.box({-5, 0, 0.3f}, {2.2f, 2, 4}, {210, 90, 60, 255})
      .box({-0.5f, 0, 0}, {3, 2, 3}, {90, 160, 220, 255});
  model.box({4.5f, 1, 0.5f}, {3, 2, 4}, {120, 200, 120, 255});
  frame.designs.push_back({model.made(), {}, {}, {}});
  return frame;
}

/// A wall before the left third, nothing known in the middle, free sight on the right.
ColourImage drawn(const FrameDescription& frame, bool isCpu) {
  DepthImage scan(kWidth, kHeight, std::numeric_limits<float>::infinity());
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < 2 * kWidth / 3; ++x)
      scan.at(x, y) = x < kWidth / 3 ? 6.0f : std::numeric_limits<float>::quiet_NaN();
  auto device = isCpu ? Result<std::unique_ptr<OverlayDevice>>(createCpuDevice()) : createVulkanDevice();
  EXPECT_TRUE(device) << device.error().text();
  if (!device) return {};
  DrawList list = buildDrawList(frame, frame.camera);
  list.image = frame.image.get();
  list.scanDepth = &scan;
  auto output = (*device)->draw(list);
  EXPECT_TRUE(output) << output.error().text();
  return output ? std::move(output->colour) : ColourImage();
}

/// One baseline for both devices.
class OverlayImage : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Both, OverlayImage, testing::Bool(),
                         [](const auto& which) { return std::string(which.param ? "cpu" : "vulkan"); });

}  // namespace

TEST_P(OverlayImage, DashedHiddenPartsMatchTheirBaseline) {
  FrameDescription frame = smallScene();
  frame.display.hidden = HiddenStyle::Dash;
  const auto comparison = compareToBaseline(drawn(frame, GetParam()), "overlay-dash");
  EXPECT_TRUE(comparison.same) << comparison.report;
}

TEST_P(OverlayImage, GhostedHiddenPartsMatchTheirBaseline) {
  FrameDescription frame = smallScene();
  frame.designs[0].selected = {2};
  const auto comparison = compareToBaseline(drawn(frame, GetParam()), "overlay-ghost");
  EXPECT_TRUE(comparison.same) << comparison.report;
}

TEST_P(OverlayImage, AColumnShiftedByTwentyCentimetresDoesNotPassForTheBaseline) {
  if (const char* update = std::getenv("ALIDADE_UPDATE_BASELINES"); update && *update == '1')
    GTEST_SKIP() << "baselines are being written";
  FrameDescription frame = smallScene();
  frame.display.hidden = HiddenStyle::Dash;
  auto shifted = std::make_shared<DesignModel>(*frame.designs[0].model);
  shifted->origin.x += 0.2;
  frame.designs[0].model = shifted;
  const auto comparison = compareToBaseline(drawn(frame, GetParam()), "overlay-dash");
  EXPECT_FALSE(comparison.same);
  EXPECT_NE(comparison.report.find("overlay-dash-difference.png"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(std::string(ALIDADE_IMAGE_DIFF_DIR) + "/overlay-dash-difference.png"));
}

}  // namespace alidade

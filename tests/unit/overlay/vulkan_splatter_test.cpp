// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/vulkan_splatter.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "raster/splatter.h"
#include "unit/cloud/test_clouds.h"
#include "unit/gpu/test_device.h"

namespace alidade {
namespace {

using test::storeFrom;
using test::unevenRoom;

const RigidTransform kView = RigidTransform::cameraLookingAt({3, 2, 1.6}, {17, 10, 1.2});

/// Brown, tilted and fisheye: every way through the shader's lens.
std::vector<Camera> lenses() {
  const double f = 420, cx = 318.2, cy = 241.7;
  std::vector<Camera> cameras;
  for (const auto& [model, parameters] : std::initializer_list<std::pair<CameraModel, std::vector<double>>>{
           {CameraModel::Pinhole, {f, f + 3, cx, cy}},
           {CameraModel::OpenCv5, {f, f, cx, cy, -0.31, 0.12, 0.001, -0.002, -0.03}},
           {CameraModel::OpenCv14,
            {f, f, cx, cy, 0.1, -0.05, 0.001, -0.001, 0.01, 0.12, -0.02, 0.004, 0.001, -0.0005, 0.0008,
             0.0002, 0.01, -0.02}},
           {CameraModel::OpenCvFisheye, {f * 0.6, f * 0.6, cx, cy, -0.02, 0.004, -0.001, 0.0002}}})
    cameras.emplace_back(*Intrinsics::fromParameters(model, 640, 480, parameters));
  return cameras;
}

class VulkanSplatterTest : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    useTestDevice();
    auto made = GpuDevice::create();
    ASSERT_TRUE(made) << made.error().text();
    device = *made;
    if (GetParam() && !device->hasAtomics64()) GTEST_SKIP() << device->name() << " has no 64-bit atomics";
    auto splatting = createVulkanSplatter(device, GetParam());
    ASSERT_TRUE(splatting) << splatting.error().text();
    splatter = std::move(*splatting);
  }
  void TearDown() override {
    if (!device) return;
    EXPECT_TRUE(device->isValidated()) << "the validation layer is not installed";
    EXPECT_EQ(device->validationMessageCount(), 0);
  }
  std::shared_ptr<GpuDevice> device;
  std::unique_ptr<SplatDevice> splatter;
};

/// Both compute in floats with one order of sums, but a shader's division and square root may round otherwise
/// and its products may fuse: a point within some 1e-4 px of a pixel's border may fall to either side. So a
/// few pixels may have another winner; all others have the same one, at the same depth but for its last
/// digits.
///
/// Planar footprints meet in the plane they share, at depths that differ in the last digits alone: there the
/// depth is the same, and which of the neighbours won may not be. Their slope is a difference of pixels over
/// a small step, good to some 1e-5, which the depth feels by its part that changes over the footprint.
void expectTwins(const SplatImages& cpu, const SplatImages& gpu, const SplatOptions& options,
                 const std::string& what) {
  const bool isWide = options.maximumSizePx > 1.0;
  const float tolerance = isWide ? 2e-5f : 1e-6f;
  std::size_t covered = 0, border = 0, otherWinner = 0, wrong = 0;
  for (std::size_t i = 0; i < cpu.depth.size(); ++i) {
    const float a = cpu.depth.data()[i], b = gpu.depth.data()[i];
    covered += std::isfinite(a);
    if (!(a == b || std::abs(a - b) <= tolerance * a)) {
      ++border;
      continue;
    }
    const bool sameColour = !options.colour || cpu.colour.data()[i] == gpu.colour.data()[i];
    const bool sameWinner = options.ids ? cpu.point.data()[i] == gpu.point.data()[i] : sameColour;
    otherWinner += !sameWinner;
    wrong += sameWinner && !sameColour;
  }
  ASSERT_GT(covered, 20'000u) << what;
  // In levels a point carries its place in its cell in steps of 1/256: one that lies on a step may get either.
  const bool hasPlaces = isWide && !options.ids;
  EXPECT_LE(border, (hasPlaces ? 2e-3 : 5e-4) * static_cast<double>(covered)) << what;
  EXPECT_LE(otherWinner, (isWide ? 0.06 : 5e-4) * static_cast<double>(covered)) << what;
  EXPECT_EQ(wrong, 0u) << what;
  const auto percent = [&](std::size_t n) {
    return std::to_string(100.0 * static_cast<double>(n) / static_cast<double>(covered));
  };
  testing::Test::RecordProperty("border_" + what, percent(border));
  testing::Test::RecordProperty("winner_" + what, percent(otherWinner));
}

TEST_P(VulkanSplatterTest, DrawsThePictureOfTheProcessor) {
  const auto store = storeFrom(unevenRoom(300'000), 5000);
  int lens = 0;
  for (const Camera& camera : lenses()) {
    const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, kView)}};
    for (const auto& [colour, ids] :
         {std::pair(false, false), std::pair(true, false), std::pair(true, true)}) {
      for (const bool wide : {false, true}) {
        SplatOptions options{.colour = colour, .ids = ids, .pointSize = 1.5, .round = ids};
        options.maximumSizePx = wide ? 16.0 : 1.0;
        const SplatImages cpu = splat(layers, camera, kView, options);
        options.device = splatter.get();
        const SplatImages gpu = splat(layers, camera, kView, options);
        expectTwins(
            cpu, gpu, options,
            std::to_string(lens) + (colour ? "_colour" : "") + (ids ? "_ids" : "") + (wide ? "_wide" : ""));
      }
    }
    ++lens;
  }
}

TEST_P(VulkanSplatterTest, TakesPicturesOfOtherSizesAndNoPointsAtAll) {
  const auto store = storeFrom(unevenRoom(20'000));
  for (const int width : {320, 64, 511}) {
    const Camera camera = test::pinhole(width, 200, 150);
    SplatOptions options{.colour = true, .ids = true, .device = splatter.get()};
    const SplatImages none = splat({}, camera, kView, options);
    const SplatImages some = splat({{store, selectAll(*store, camera, kView)}}, camera, kView, options);
    std::size_t covered = 0;
    for (std::size_t i = 0; i < none.depth.size(); ++i) {
      ASSERT_TRUE(std::isinf(none.depth.data()[i]));
      ASSERT_EQ(some.point.data()[i] == 0, std::isinf(some.depth.data()[i]));
      covered += std::isfinite(some.depth.data()[i]);
    }
    EXPECT_GT(covered, some.depth.size() / 20);
  }
}

TEST_P(VulkanSplatterTest, DrawsMorePointsThanOneBatchHolds) {
  const auto store = storeFrom(unevenRoom(150'000), 5000);
  const Camera camera = lenses()[1];
  SplatLayer layer{store, selectAll(*store, camera, kView)};
  SplatOptions options{.colour = true, .maximumSizePx = 1.0};
  const SplatImages once = splat({layer}, camera, kView, options);
  // The same ranges over and over change nothing.
  const std::vector<SelectedRange> ranges = layer.selection.ranges;
  while (layer.selection.pointCount * 1.0 < 4.5e6) {
    layer.selection.ranges.insert(layer.selection.ranges.end(), ranges.begin(), ranges.end());
    for (const SelectedRange& range : ranges) layer.selection.pointCount += range.count;
  }
  options.device = splatter.get();
  expectTwins(once, splat({layer}, camera, kView, options), options, "batches");
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutWideAtomics, VulkanSplatterTest, testing::Bool(),
                         [](const auto& wide) { return wide.param ? "Wide" : "TwoPasses"; });

}  // namespace
}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "gpu/gpu_device.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include <unistd.h>

#include "camera/lens_uniform.h"
#include "gpu/shader_library.h"
#include "unit/gpu/test_cameras.h"
#include "unit/gpu/test_device.h"

namespace alidade {

namespace {

class GpuDeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    useTestDevice();
    auto made = GpuDevice::create();
    ASSERT_TRUE(made) << made.error().text();
    device = *made;
  }
  void TearDown() override {
    if (!device) return;
    EXPECT_TRUE(device->isValidated()) << "the validation layer is not installed";
    EXPECT_EQ(device->validationMessageCount(), 0);
  }
  std::shared_ptr<GpuDevice> device;
};

template <class T>
T* as(GpuBuffer& buffer) {
  return reinterpret_cast<T*>(buffer.data());
}

/// Directions over the whole of what the picture sees, near and far.
std::vector<glm::vec4> pointsSeenBy(const Camera& camera) {
  std::vector<glm::vec4> points;
  for (int row = 0; row <= 36; ++row) {
    for (int column = 0; column <= 54; ++column) {
      const auto ray =
          camera.unproject({column * (camera.width() - 1) / 54.0, row * (camera.height() - 1) / 36.0});
      if (!ray) continue;
      const double z = 0.5 + (row * 7 + column * 13) % 100;
      points.emplace_back(glm::vec3(*ray * z), 1.0f);
    }
  }
  return points;
}

Result<std::vector<glm::vec2>> projectOnDevice(GpuDevice& device, const Camera& camera,
                                               const std::vector<glm::vec4>& points) {
  using Kind = GpuBindingKind;
  auto pipeline = device.makePipeline(
      GpuComputeDescription{"lens_points.comp", {Kind::Uniform, Kind::Storage, Kind::Storage}, {}});
  if (!pipeline) return fail(pipeline.error());
  auto lens = device.makeBuffer(GpuBufferUse::Uniform, sizeof(LensUniform));
  auto in = device.makeBuffer(GpuBufferUse::Storage, points.size() * sizeof(glm::vec4));
  auto out = device.makeBuffer(GpuBufferUse::Storage, points.size() * sizeof(glm::vec2));
  if (!lens || !in || !out) return fail("no buffers");
  *as<LensUniform>(*lens) = lensUniform(camera);
  std::memcpy(in->data(), points.data(), points.size() * sizeof(glm::vec4));
  auto bindings = device.makeBindings(*pipeline, {*lens, *in, *out});
  if (!bindings) return fail(bindings.error());
  const auto groups = static_cast<std::uint32_t>((points.size() + 63) / 64);
  auto ran = device.run([&](GpuCommands& commands) {
    commands.bind(*pipeline, *bindings);
    commands.dispatch(groups);
  });
  if (!ran) return fail(ran.error());
  return std::vector<glm::vec2>(as<glm::vec2>(*out), as<glm::vec2>(*out) + points.size());
}

}  // namespace

TEST_F(GpuDeviceTest, NamesItsDevice) {
  EXPECT_FALSE(device->name().empty());
}

TEST_F(GpuDeviceTest, ShadersBendPointsAsTheCameraDoesForEveryModel) {
  for (const Camera& camera : camerasOfEveryModel()) {
    const auto points = pointsSeenBy(camera);
    ASSERT_GT(points.size(), 1000u) << nameOf(camera);
    const auto pixels = projectOnDevice(*device, camera, points);
    ASSERT_TRUE(pixels) << pixels.error().text();
    double worst = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const glm::dvec2 exact = camera.projectUnchecked(glm::dvec3(points[i]));
      worst = std::max(worst, glm::length(glm::dvec2((*pixels)[i]) - exact));
    }
    // Half a unit in the last place at pixel 5472 is 2.4e-4; a few of them gather.
    EXPECT_LT(worst, 1e-3) << nameOf(camera);
    RecordProperty(nameOf(camera), std::to_string(worst));
  }
}

TEST_F(GpuDeviceTest, ImagesComeBackAsTheyWentUp) {
  constexpr int w = 37, h = 11;
  auto image = device->makeImage(GpuFormat::R32Uint, w, h);
  ASSERT_TRUE(image);
  auto up = device->makeBuffer(GpuBufferUse::Upload, image->byteCount());
  auto down = device->makeBuffer(GpuBufferUse::Readback, image->byteCount());
  ASSERT_TRUE(up && down);
  for (int i = 0; i < w * h; ++i) as<std::uint32_t>(*up)[i] = 1000003u * i;
  const auto ran = device->run([&](GpuCommands& commands) {
    commands.upload(*up, *image);
    commands.readBack(*image, *down);
  });
  ASSERT_TRUE(ran) << ran.error().text();
  EXPECT_EQ(std::memcmp(up->data(), down->data(), image->byteCount()), 0);
}

TEST_F(GpuDeviceTest, RefusesPicturesThatAreTooLargeOrEmpty) {
  EXPECT_FALSE(device->makeImage(GpuFormat::Rgba8, 0, 10));
  EXPECT_FALSE(device->makeImage(GpuFormat::Rgba8, device->maximumImageSize() + 1, 1));
}

TEST_F(GpuDeviceTest, CountsWhatTheValidationLayerSays) {
  if (!device->isValidated()) GTEST_SKIP() << "the validation layer is not installed";
  auto other = GpuDevice::create();
  ASSERT_TRUE(other);
  // A buffer in a role that it was not made for: the layer must object, or a count of zero means nothing.
  auto buffer = (*other)->makeBuffer(GpuBufferUse::Upload, 64);
  ASSERT_TRUE(buffer);
  ASSERT_TRUE((*other)->run([&](GpuCommands& commands) { commands.bindVertices(*buffer); }));
  EXPECT_GT((*other)->validationMessageCount(), 0);
}

TEST(GpuDevice, AnUnknownDeviceIsRefusedWithTheNamesOfThoseThere) {
  const char* before = std::getenv("ALIDADE_VULKAN_DEVICE");
  const std::string kept = before ? before : "llvmpipe";
  setenv("ALIDADE_VULKAN_DEVICE", "no such card", 1);
  const auto made = GpuDevice::create();
  setenv("ALIDADE_VULKAN_DEVICE", kept.c_str(), 1);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().text().find("no such card"), std::string::npos);
  EXPECT_NE(made.error().text().find("llvmpipe"), std::string::npos);
}

TEST(ShaderLibrary, SaysWhereAMissingOrDamagedShaderWasLookedFor) {
  const auto missing = loadShader("no_such_pass.frag");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().text().find("share/alidade/shaders"), std::string::npos);

  const auto folder =
      std::filesystem::temp_directory_path() / ("alidade-shaders-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "broken.frag.spv") << "this is no SPIR-V, only words";
  setenv("ALIDADE_SHADER_DIR", folder.c_str(), 1);
  const auto broken = loadShader("broken.frag");
  unsetenv("ALIDADE_SHADER_DIR");
  std::filesystem::remove_all(folder);
  ASSERT_FALSE(broken);
  EXPECT_NE(broken.error().what.find("damaged"), std::string::npos);
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <cstdint>
#include <memory>

#include <benchmark/benchmark.h>

#include "overlay/device.h"
#include "overlay/draw_list.h"

namespace alidade {
namespace {

/// Boxes in a regular hall, twelve triangles and twelve edges each, at survey coordinates.
std::shared_ptr<const DesignModel> hallOf(int boxes) {
  auto model = std::make_shared<DesignModel>();
  model->origin = {402100, 5655050, 112};
  const int side = static_cast<int>(std::ceil(std::cbrt(boxes)));
  for (int n = 0; n < boxes; ++n) {
    const glm::vec3 centre(n % side * 2.0f, n / side % side * 2.0f,
                           static_cast<float>(n / (side * side)) * 1.5f);
    DesignElement element;
    element.colour = {static_cast<std::uint8_t>(80 + n % 150), static_cast<std::uint8_t>(90 + n * 7 % 140),
                      150, 255};
    element.firstIndex = static_cast<std::uint32_t>(model->triangles.size());
    element.firstEdge = static_cast<std::uint32_t>(model->edges.size());
    element.indexCount = 36;
    element.edgeCount = 12;
    const auto base = static_cast<std::uint32_t>(model->vertices.size());
    for (int i = 0; i < 8; ++i)
      model->vertices.push_back(centre +
                                glm::vec3(i & 1 ? 0.4f : -0.4f, i & 2 ? 0.4f : -0.4f, i & 4 ? 0.5f : -0.5f));
    for (const std::uint32_t i : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
      model->triangles.push_back(base + i);
    for (std::uint32_t i = 0; i < 8; ++i)
      for (const std::uint32_t bit : {1u, 2u, 4u})
        if (!(i & bit)) model->edges.push_back({base + i, base + (i | bit)});
    model->elements.push_back(element);
  }
  return model;
}

FrameDescription hallFrame() {
  FrameDescription frame;
  frame.camera = Camera(*Intrinsics::fromParameters(
      CameraModel::OpenCv5, 1920, 1080, {1150, 1150, 959.5, 539.5, -0.12, 0.03, 0.0005, -0.0004, -0.002}));
  frame.designs.push_back({hallOf(8334), {}, {}, {}});
  const glm::dvec3 origin = frame.designs[0].model->origin;
  frame.cameraFromWorld =
      RigidTransform::cameraLookingAt(origin + glm::dvec3(19, -26, 24), origin + glm::dvec3(19, 19, 12));
  frame.image = std::make_shared<ColourImage>(1920, 1080, Rgba8{120, 130, 110, 255});
  return frame;
}

void overlayDrawList(benchmark::State& state) {
  const FrameDescription frame = hallFrame();
  for (auto _ : state) benchmark::DoNotOptimize(buildDrawList(frame, frame.camera).triangles.size());
}

Result<std::unique_ptr<OverlayDevice>> deviceOf(bool isCpu) {
  if (isCpu) return createCpuDevice();
  return createVulkanDevice();
}

/// A frame from its description to the result images, the first one aside, which compiles shaders.
void overlayFrame(benchmark::State& state, bool isCpu, const DisplaySettings& display, bool hides,
                  bool listOnce) {
  auto device = deviceOf(isCpu);
  if (!device) return state.SkipWithError(device.error().text().c_str());
  FrameDescription frame = hallFrame();
  frame.display = display;
  const DepthImage scan(1920, 1080, 45.0f);
  DrawList list = buildDrawList(frame, frame.camera);
  const auto drawOnce = [&]() -> Result<OverlayDevice::Output> {
    if (!listOnce) list = buildDrawList(frame, frame.camera);
    list.image = frame.image.get();
    list.scanDepth = hides ? &scan : nullptr;
    return (*device)->draw(list);
  };
  if (auto first = drawOnce(); !first) return state.SkipWithError(first.error().text().c_str());
  for (auto _ : state) {
    auto output = drawOnce();
    if (!output) return state.SkipWithError(output.error().text().c_str());
    benchmark::DoNotOptimize(output->colour.data());
  }
  state.counters["triangles"] = static_cast<double>(list.triangles.size() / 3);
  state.SetLabel((*device)->name());
}

/// Faces, edges and the hidden layer, draw list included.
void overlayWholeFrame(benchmark::State& state, bool isCpu) {
  overlayFrame(state, isCpu, {}, true, false);
}

/// The device alone on a finished draw list.
void overlayDevice(benchmark::State& state, bool isCpu) {
  overlayFrame(state, isCpu, {}, true, true);
}

/// The device alone, faces before the picture and nothing that hides.
void overlayFaces(benchmark::State& state, bool isCpu) {
  DisplaySettings display;
  display.designEdges = false;
  overlayFrame(state, isCpu, display, false, true);
}

BENCHMARK(overlayDrawList)
    ->Name("overlay_draw_list_100k_triangles")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
#define ALIDADE_OVERLAY_ROW(function, name)  \
  BENCHMARK_CAPTURE(function, cpu, true)     \
      ->Name(name "/cpu")                    \
      ->Unit(benchmark::kMillisecond)        \
      ->MeasureProcessCPUTime()              \
      ->UseRealTime();                       \
  BENCHMARK_CAPTURE(function, vulkan, false) \
      ->Name(name "/vulkan")                 \
      ->Unit(benchmark::kMillisecond)        \
      ->MeasureProcessCPUTime()              \
      ->UseRealTime()
ALIDADE_OVERLAY_ROW(overlayWholeFrame, "overlay_frame_1080p_100k_triangles");
ALIDADE_OVERLAY_ROW(overlayDevice, "overlay_device_1080p_100k_triangles");
ALIDADE_OVERLAY_ROW(overlayFaces, "overlay_faces_1080p_100k_triangles");

}  // namespace
}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>

#include <benchmark/benchmark.h>

#include "bench/site.h"
#include "bench/street.h"
#include "cloud/point_store.h"
#include "cloud/selection.h"
#include "overlay/vulkan_splatter.h"
#include "raster/eye_dome.h"
#include "raster/occluder_mesh.h"
#include "raster/occlusion.h"
#include "raster/splatter.h"

namespace alidade {
namespace {

using test::cpuSeconds;
using test::hdCamera;
using test::overview;
using test::siteOf;

/// On the street between the houses.
RigidTransform street() {
  return RigidTransform::cameraLookingAt({402006, 5655006, 117}, {402100, 5655060, 113});
}

void splatSite(benchmark::State& state, const SplatOptions& options) {
  const auto store = siteOf(20'000'000);
  const Camera camera = hdCamera();
  const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, overview())}};
  const double start = cpuSeconds();
  for (auto _ : state) {
    benchmark::DoNotOptimize(splat(layers, camera, overview(), options).drawn);
  }
  state.counters["cpu_ms"] = 1e3 * (cpuSeconds() - start) / static_cast<double>(state.iterations());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * layers[0].selection.pointCount));
  state.SetLabel(splatKernelName());
}

void splat_depth_20M(benchmark::State& state) {
  splatSite(state, {.maximumSizePx = 1.0});
}
void splat_depth_newton_20M(benchmark::State& state) {
  splatSite(state, {.maximumSizePx = 1.0, .reciprocal = Reciprocal::Newton});
}
void splat_depth_multiply_add_20M(benchmark::State& state) {
  splatSite(state, {.maximumSizePx = 1.0, .reciprocal = Reciprocal::MultiplyAdd});
}
void splat_colour_20M(benchmark::State& state) {
  splatSite(state, {.colour = true, .maximumSizePx = 1.0});
}
void splat_colour_ids_20M(benchmark::State& state) {
  splatSite(state, {.colour = true, .ids = true, .maximumSizePx = 1.0});
}
void splat_colour_footprints_20M(benchmark::State& state) {
  splatSite(state, {.colour = true});
}

/// The prefix that the selection chooses: what a frame draws.
void splatSelected(benchmark::State& state, SplatOptions options) {
  const auto store = siteOf(20'000'000);
  const Camera camera = hdCamera();
  const std::vector<SplatLayer> layers{{store, select(*store, camera, overview(), {})}};
  const double start = cpuSeconds();
  for (auto _ : state) benchmark::DoNotOptimize(splat(layers, camera, overview(), options).drawn);
  state.counters["cpu_ms"] = 1e3 * (cpuSeconds() - start) / static_cast<double>(state.iterations());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * layers[0].selection.pointCount));
}

void splat_selected(benchmark::State& state) {
  splatSelected(state, {.colour = true});
}
void splat_selected_facing(benchmark::State& state) {
  splatSelected(state, {.colour = true, .planar = false});
}

/// The compute shaders, on whatever Vulkan device there is; `wide`: 64-bit atomics.
void splatVulkan(benchmark::State& state, bool wide) {
  auto device = GpuDevice::create();
  auto splatter = device ? createVulkanSplatter(*device, wide) : fail(device.error());
  if (!splatter) {
    state.SkipWithError(splatter.error().text().c_str());
    return;
  }
  SplatOptions options{.colour = true, .maximumSizePx = 1.0};
  options.device = splatter->get();
  splatSelected(state, options);
  state.SetLabel((*device)->name());
}
void splat_vulkan_selected(benchmark::State& state) {
  splatVulkan(state, true);
}
void splat_vulkan_two_passes_selected(benchmark::State& state) {
  splatVulkan(state, false);
}

void select_pixels_20M(benchmark::State& state) {
  const auto store = siteOf(20'000'000);
  const Camera camera = hdCamera();
  Selection selection;
  for (auto _ : state) selection = select(*store, camera, overview(), {});
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * store->pointCount()));
  state.counters["selected"] = static_cast<double>(selection.pointCount);
  state.counters["nodes"] = static_cast<double>(store->nodes().size());
}

void select_and_splat_20M(benchmark::State& state) {
  const auto store = siteOf(20'000'000);
  const Camera camera = hdCamera();
  std::uint64_t drawn = 0;
  for (auto _ : state) {
    drawn = splat({{store, select(*store, camera, street(), {})}}, camera, street(), {.colour = true}).drawn;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * drawn));
}

void occlusion_5M(benchmark::State& state) {
  const auto store = siteOf(5'000'000);
  const Camera camera = hdCamera();
  const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, street())}};
  for (auto _ : state) {
    benchmark::DoNotOptimize(occlusionDepth(layers, camera, street()).pointsDrawn);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * layers[0].selection.pointCount));
}

void occlusionStructured(benchmark::State& state, std::size_t points) {
  const test::ScannedStreet& street = test::streetOf(points);
  OccluderMeshBuilder builder(street.stations);
  builder.add(street.batch);
  const auto mesh = std::make_shared<OccluderMesh>(builder.build());
  OcclusionDepth occlusion;
  const double start = cpuSeconds();
  for (auto _ : state) occlusion = occlusionDepth(Occluders{{}, {mesh}}, street.camera, test::kStreetView);
  report(state, street, occlusion.depth, start);
  state.counters["quads"] = static_cast<double>(mesh->mergedQuads + mesh->cellQuads + mesh->borderSquares);
}

void occlusion_structured_5M(benchmark::State& state) {
  occlusionStructured(state, 5'000'000);
}

void occluder_mesh_build_5M(benchmark::State& state) {
  const test::ScannedStreet& street = test::streetOf(5'000'000);
  for (auto _ : state) {
    OccluderMeshBuilder builder(street.stations);
    builder.add(street.batch);
    benchmark::DoNotOptimize(builder.build().packs.size());
  }
}

/// The same returns without their grid.
void occlusion_street(benchmark::State& state) {
  const test::ScannedStreet& street = test::streetOf(static_cast<std::size_t>(state.range(0)) * 100'000);
  const std::vector<SplatLayer> layers{{street.store, selectAll(*street.store, street.camera, test::kStreetView)}};
  OcclusionDepth occlusion;
  const double start = cpuSeconds();
  for (auto _ : state) occlusion = occlusionDepth(layers, street.camera, test::kStreetView);
  report(state, street, occlusion.depth, start);
  state.counters["drawn"] = static_cast<double>(occlusion.pointsDrawn);
}

void occlusion_squares_5M(benchmark::State& state) {
  const test::ScannedStreet& street = test::streetOf(5'000'000);
  const std::vector<SplatLayer> layers{{street.store, selectAll(*street.store, street.camera, test::kStreetView)}};
  OcclusionDepth occlusion;
  const double start = cpuSeconds();
  for (auto _ : state) occlusion = squareOcclusionDepth(layers, street.camera, test::kStreetView);
  report(state, street, occlusion.depth, start);
}

void eye_dome_1080p(benchmark::State& state) {
  const test::ScannedStreet& street = test::streetOf(100'000);
  ColourImage colour(1920, 1080, Rgba8{200, 180, 160, 255});
  const double start = cpuSeconds();
  for (auto _ : state) applyEyeDome(street.truth, {}, colour);
  state.counters["cpu_ms"] = 1e3 * (cpuSeconds() - start) / static_cast<double>(state.iterations());
}

void build_store_5M(benchmark::State& state) {
  const auto source = siteOf(5'000'000);
  PointBatch batch;
  for (std::uint64_t i = 0; i < source->pointCount(); ++i)
    batch.position.push_back(source->sourcePosition(i));
  for (auto _ : state) {
    PointStoreBuilder builder;
    builder.add(batch);
    benchmark::DoNotOptimize(builder.build(Progress()));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * batch.size()));
}

BENCHMARK(splat_depth_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_depth_newton_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_depth_multiply_add_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_colour_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_colour_ids_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_colour_footprints_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_selected)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_selected_facing)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_vulkan_selected)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_vulkan_two_passes_selected)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(select_pixels_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(select_and_splat_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(occlusion_5M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(occlusion_structured_5M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(occluder_mesh_build_5M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(occlusion_street)->Unit(benchmark::kMillisecond)->UseRealTime()->Arg(1)->Arg(4)->Arg(15)->Arg(50)->Arg(200);
BENCHMARK(occlusion_squares_5M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(eye_dome_1080p)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(build_store_5M)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace alidade

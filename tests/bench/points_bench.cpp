// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>

#include <benchmark/benchmark.h>

#include "cloud/point_store.h"
#include "cloud/selection.h"
#include "raster/occlusion.h"
#include "raster/splatter.h"

namespace alidade {
namespace {

/// Terrain with hills and blocks of houses at survey coordinates, 200 m × 200 m, evenly dotted.
std::shared_ptr<const PointStore> siteOf(std::size_t count) {
  static std::map<std::size_t, std::shared_ptr<const PointStore>> made;
  auto& store = made[count];
  if (store) return store;
  PointStoreBuilder builder;
  std::uint64_t state = 42;
  const auto unit = [&state] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  PointBatch batch;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = 200 * unit(), y = 200 * unit();
    double z = 2 * std::sin(0.05 * x) + std::cos(0.08 * y) + 0.003 * unit();
    const bool house = std::fmod(x, 25) > 12 && std::fmod(y, 25) > 12;
    if (house) z += i % 4 == 0 ? 8.0 : 8.0 * unit();
    batch.position.push_back({402000.0 + x, 5655000.0 + y, 112.0 + z});
    const auto shade = static_cast<unsigned char>(40 + 200 * unit());
    batch.rgb.push_back({shade, static_cast<unsigned char>(house ? 90 : shade), 80});
    if (batch.size() == 1'000'000) builder.add(batch), batch.clear();
  }
  builder.add(batch);
  store = *builder.build(Progress());
  return store;
}

/// 1080p with full five-coefficient distortion.
Camera hdCamera() {
  return Camera(*Intrinsics::fromParameters(
      CameraModel::OpenCv5, 1920, 1080, {1150, 1150, 959.5, 539.5, -0.12, 0.03, 0.0005, -0.0004, -0.002}));
}

/// The whole site in view from above its edge.
RigidTransform overview() {
  return RigidTransform::cameraLookingAt({402100, 5654870, 190}, {402100, 5655085, 110});
}

/// On the street between the houses.
RigidTransform street() {
  return RigidTransform::cameraLookingAt({402006, 5655006, 117}, {402100, 5655060, 113});
}

void splatSite(benchmark::State& state, const SplatOptions& options) {
  const auto store = siteOf(20'000'000);
  const Camera camera = hdCamera();
  const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, overview())}};
  for (auto _ : state) {
    benchmark::DoNotOptimize(splat(layers, camera, overview(), options).drawn);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * layers[0].selection.pointCount));
  state.SetLabel(splatKernelName());
}

void splat_depth_20M(benchmark::State& state) {
  splatSite(state, {.maximumSizePx = 1.0});
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
BENCHMARK(splat_colour_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_colour_ids_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_colour_footprints_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(select_pixels_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(select_and_splat_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(occlusion_5M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(build_store_5M)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace alidade

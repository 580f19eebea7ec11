// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdint>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/street.h"
#include "cleaning/cleaning.h"
#include "cleaning/surface.h"
#include "raster/occluder_mesh.h"
#include "raster/occlusion.h"

namespace alidade {
namespace {

using test::cpuSeconds;

constexpr std::size_t kReturns = 5'000'000;

/// Of this process, now; counted from /proc, 0 where there is none.
double residentMegabytes() {
  std::ifstream file("/proc/self/statm");
  double pages = 0, resident = 0;
  file >> pages >> resident;
  return 1e-6 * resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// As a design of one element, which is what the occluder takes.
std::shared_ptr<const OccluderMesh> occluderOf(const SurfaceMesh& surface) {
  DesignModel model;
  model.origin = surface.vertices.empty() ? glm::dvec3(0) : surface.vertices.front();
  for (const glm::dvec3& vertex : surface.vertices) model.vertices.emplace_back(vertex - model.origin);
  for (const auto& triangle : surface.triangles) model.triangles.insert(model.triangles.end(), triangle.begin(), triangle.end());
  DesignElement element;
  element.globalId = element.name = "surface";
  element.indexCount = static_cast<std::uint32_t>(model.triangles.size());
  model.elements.push_back(element);
  return std::make_shared<OccluderMesh>(occluderMeshOf(model));
}

using Mesher = std::function<Result<SurfaceMesh>(const std::vector<glm::dvec3>&, const std::vector<glm::vec3>&)>;

/// A street of 5 M returns, thinned to one in a cube of `state.range(0)` millimetres, made a surface once; the row draws the
/// surface's depth and says how right it is.
void occlusionOfSurface(benchmark::State& state, const std::string& name, const Mesher& mesher) {
  const test::ScannedStreet& street = test::streetOf(kReturns);
  const double before = cpuSeconds(), memoryBefore = residentMegabytes();
  const auto keep = thinByVoxel(street.batch.position, 1e-3 * static_cast<double>(state.range(0)), Progress());
  if (!keep) return state.SkipWithError(keep.error().text().c_str());
  std::vector<glm::dvec3> points;
  std::vector<std::uint16_t> seenFrom;
  for (std::size_t i = 0; i < keep->size(); ++i) {
    if (!(*keep)[i]) continue;
    points.push_back(street.batch.position[i]);
    seenFrom.push_back(street.batch.scanner[i]);
  }
  const std::vector<glm::dvec3> eyes{street.stations[0].worldFromScanner.translation, street.stations[1].worldFromScanner.translation};
  const auto normals = estimateNormals(points, eyes, seenFrom, {}, Progress());
  if (!normals) return state.SkipWithError(normals.error().text().c_str());
  const auto surface = mesher(points, *normals);
  if (!surface) return state.SkipWithError(surface.error().text().c_str());
  state.counters["points"] = static_cast<double>(points.size());
  state.counters["triangles"] = static_cast<double>(surface->triangles.size());
  state.counters["build_cpu_s"] = cpuSeconds() - before;
  state.counters["mesh_mb"] = 1e-6 * static_cast<double>(surface->vertices.size() * sizeof(glm::dvec3) + surface->triangles.size() * 12);
  state.counters["kept_mb"] = residentMegabytes() - memoryBefore;
  const auto mesh = occluderOf(*surface);
  OcclusionDepth occlusion;
  const double start = cpuSeconds();
  for (auto _ : state) occlusion = occlusionDepth(Occluders{{}, {mesh}}, street.camera, test::kStreetView);
  report(state, street, occlusion.depth, start);
  test::savePicture(name, street.truth, occlusion.depth, occlusion.depth);
}

void occlusion_surface_greedy(benchmark::State& state) {
  const GreedyOptions options{2.5e-3 * static_cast<double>(state.range(0))};
  occlusionOfSurface(state, "surface_greedy", [&](const auto& points, const auto& normals) {
    return meshGreedily(points, normals, options, Progress());
  });
}

void occlusion_surface_poisson(benchmark::State& state) {
  const PoissonOptions options{static_cast<int>(state.range(1))};
  occlusionOfSurface(state, "surface_poisson", [&](const auto& points, const auto& normals) {
    return meshByPoisson(points, normals, options, Progress());
  });
}

BENCHMARK(occlusion_surface_greedy)->Unit(benchmark::kMillisecond)->UseRealTime()->Arg(100)->Iterations(10);
BENCHMARK(occlusion_surface_poisson)->Unit(benchmark::kMillisecond)->UseRealTime()->Args({100, 9})->Args({50, 10})->Iterations(10);

}  // namespace
}  // namespace alidade

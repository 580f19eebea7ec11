// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// One picture of 1080p aligned with two million points from 2° and 0.2 m off, everything between pixels and verdict.

#include <benchmark/benchmark.h>

#include "align/auto_align.h"
#include "bench/site.h"
#include "unit/align/room.h"

namespace alidade {

namespace {

void auto_align_frame(benchmark::State& state) {
  static const AlignmentScene scene = test::Room::scan(2'000'000);
  const Camera camera(*Intrinsics::fromParameters(CameraModel::OpenCv5, 1920, 1080, {1180, 1181, 963.5, 537.1, -0.11, 0.03, 4e-4, -3e-4, 0}));
  static const ColourImage photo = test::Room::photo(camera, test::Room::pose());
  RigidTransform start = test::Room::pose();
  start.rotation = glm::normalize(glm::angleAxis(0.035, glm::normalize(glm::dvec3(1, 2, 1))) * start.rotation);
  start.translation = -(start.rotation * (test::Room::pose().centre() + glm::dvec3(0.12, -0.12, 0.1)));
  const double before = test::cpuSeconds();
  int converged = 0;
  for (auto _ : state) {
    const auto summary = alignPicture(scene, photo, camera, start);
    if (!summary) state.SkipWithError(summary.error().text().c_str());
    else converged += summary->converged ? 1 : 0;
  }
  const auto runs = static_cast<double>(state.iterations());
  state.counters["cpu_all_threads_s"] = (test::cpuSeconds() - before) / runs;
  state.counters["converged"] = converged / runs;
}
BENCHMARK(auto_align_frame)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

}  // namespace alidade

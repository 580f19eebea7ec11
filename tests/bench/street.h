// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/site.h"
#include "cloud/point_store.h"
#include "survey/point_batch.h"
#include "unit/raster/occlusion_score.h"

namespace alidade::test {

/// The street of the tests, scanned from two stations whose returns lie in grids, with the truth of one
/// 1080p frame: rows that draw it also say how right they are, beyond 2 px of depth edges.
struct ScannedStreet {
  std::vector<Station> stations{2};
  PointBatch batch;
  std::shared_ptr<const PointStore> store;
  Camera camera = streetCamera(1920, 1080);
  DepthImage truth;
};

inline const ScannedStreet& streetOf(std::size_t points) {
  static std::map<std::size_t, ScannedStreet> made;
  auto [found, isNew] = made.try_emplace(points);
  ScannedStreet& street = found->second;
  if (!isNew) return street;
  const StreetScene scene;
  const glm::dvec3 places[] = {{0.5, -1.0, 1.8}, {18, 2.5, 1.8}};
  for (std::uint16_t s = 0; s < 2; ++s) {
    street.stations[s].worldFromScanner.translation = places[s];
    scene.scan(places[s], points / 2, 0.003, s + 1u, street.batch, 0.1, s);
  }
  PointStoreBuilder builder;
  builder.add(street.batch);
  street.store = *builder.build(Progress());
  street.truth = truthOf(scene, street.camera, kStreetView);
  return street;
}

inline void report(benchmark::State& state, const ScannedStreet& street, const DepthImage& depth, double cpuStart) {
  const Score score = scoreOf(street.truth, depth, true);
  state.counters["precision"] = score.precision;
  state.counters["recall"] = score.recall;
  state.counters["cpu_ms"] = 1e3 * (cpuSeconds() - cpuStart) / static_cast<double>(state.iterations());
}

}  // namespace alidade::test

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>

#include <sys/resource.h>

#include "camera/camera.h"
#include "cloud/point_store.h"
#include "geometry/rigid_transform.h"

namespace alidade::test {

/// Terrain with hills and blocks of houses at survey coordinates, 200 m × 200 m, evenly dotted.
inline std::shared_ptr<const PointStore> siteOf(std::size_t count) {
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

/// Of all threads of this process.
inline double cpuSeconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

/// 1080p with full five-coefficient distortion.
inline Camera hdCamera() {
  return Camera(*Intrinsics::fromParameters(
      CameraModel::OpenCv5, 1920, 1080, {1150, 1150, 959.5, 539.5, -0.12, 0.03, 0.0005, -0.0004, -0.002}));
}

/// The whole site in view from above its edge.
inline RigidTransform overview() {
  return RigidTransform::cameraLookingAt({402100, 5654870, 190}, {402100, 5655085, 110});
}

}  // namespace alidade::test

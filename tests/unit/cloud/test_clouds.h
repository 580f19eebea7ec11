// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "camera/camera.h"
#include "cloud/point_store.h"

namespace alidade::test {

/// A room's floor and walls, sampled ever denser towards one corner as a scanner there does.
inline PointBatch unevenRoom(std::size_t count, const glm::dvec3& offset = glm::dvec3(0),
                             std::uint32_t seed = 5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  PointBatch batch;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = 20 * std::pow(unit(random), 2.0), b = 12 * std::pow(unit(random), 2.0);
    glm::dvec3 p(a, b, 0.002 * unit(random));
    if (i % 3 == 1) p = glm::dvec3(a, 12.0, 0.4 * b);
    if (i % 3 == 2) p = glm::dvec3(20.0, b, 0.2 * a);
    // Millimetres and eighths: exactly shiftable by whole metres, as survey integers are.
    batch.position.push_back(glm::round(p * 1024.0) / 1024.0 + offset);
    batch.rgb.push_back({static_cast<unsigned char>(i), static_cast<unsigned char>(i >> 8),
                         static_cast<unsigned char>(i >> 16)});
  }
  return batch;
}

inline std::shared_ptr<const PointStore> storeFrom(const PointBatch& batch,
                                                   std::uint32_t leafPoints = 20000) {
  PointStoreBuilder::Options options;
  options.leafPoints = leafPoints;
  PointStoreBuilder builder(options);
  builder.add(batch);
  return *builder.build(Progress());
}

inline Camera pinhole(int width, int height, double focal) {
  return Camera(*Intrinsics::fromParameters(CameraModel::Pinhole, width, height,
                                            {focal, focal, width / 2.0 - 0.5, height / 2.0 - 0.5}));
}

/// Positions of an uncompressed LAS 1.2 file whose records begin with three 32-bit integers; empty where
/// there is no such file.
inline PointBatch lasPositions(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  PointBatch batch;
  if (bytes.size() < 227) return batch;
  const auto at = [&bytes](std::size_t offset, auto& value) {
    std::memcpy(&value, &bytes[offset], sizeof value);
  };
  std::uint32_t first = 0, count = 0;
  std::uint16_t length = 0;
  glm::dvec3 scale, offset;
  at(96, first), at(105, length), at(107, count), at(131, scale), at(155, offset);
  for (std::size_t i = 0; i < count && first + (i + 1) * length <= bytes.size(); ++i) {
    std::int32_t raw[3];
    at(first + i * length, raw);
    batch.position.push_back(glm::dvec3(raw[0], raw[1], raw[2]) * scale + offset);
  }
  return batch;
}

}  // namespace alidade::test

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cstring>
#include <map>

#include <gtest/gtest.h>

#include "cloud/point_store.h"
#include "unit/cloud/test_clouds.h"

namespace alidade {
namespace {

/// A room with every column a scan can bring.
PointBatch everyColumn(std::size_t count) {
  PointBatch batch = test::unevenRoom(count);
  batch.rgbWhite = 65535;
  ExtraColumn extra{"Reflectance", NumberType::F32, 1, {}}, pair{"pair", NumberType::I16, 2, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<std::uint32_t>(i);
    batch.intensity.push_back(static_cast<std::uint16_t>(n * 7));
    batch.classification.push_back(static_cast<std::uint8_t>(n % 19));
    batch.returnNumber.push_back(static_cast<std::uint8_t>(1 + n % 5));
    batch.returnCount.push_back(5);
    batch.gpsTime.push_back(1e9 + 1e-6 * n);
    batch.normal.push_back({0.5f, static_cast<float>(n), -1.0f});
    batch.scanner.push_back(static_cast<std::uint16_t>(n % 3));
    batch.pointSource.push_back(static_cast<std::uint16_t>(n));
    batch.row.push_back(n);
    batch.column.push_back(~n);
    const float value = 0.1f * static_cast<float>(n);
    const std::int16_t two[2] = {static_cast<std::int16_t>(n), static_cast<std::int16_t>(-1 - static_cast<int>(n))};
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    extra.data.insert(extra.data.end(), bytes, bytes + sizeof value);
    bytes = reinterpret_cast<const std::byte*>(two);
    pair.data.insert(pair.data.end(), bytes, bytes + sizeof two);
  }
  batch.extra = {extra, pair};
  return batch;
}

std::shared_ptr<const PointStore> storeOf(const PointBatch& batch, const PointStoreBuilder::Options& options) {
  PointStoreBuilder builder(options);
  for (std::size_t first = 0; first < 10; ++first) builder.add(batch.every(first, 10));
  return *builder.build(Progress());
}

TEST(StoreColumns, EveryColumnComesBackBesideItsPoint) {
  const PointBatch batch = everyColumn(60'000);
  const auto store = storeOf(batch, {.leafPoints = 2000});
  const PointBatch back = store->batch(0, store->pointCount());
  ASSERT_EQ(back.size(), batch.size());
  ASSERT_EQ(back.rgbWhite, 65535);
  ASSERT_EQ(back.extra.size(), 2u);
  for (std::size_t i = 0; i < back.size(); ++i) {
    const std::uint32_t n = back.row[i];  // the row names the point
    ASSERT_LT(n, batch.size());
    ASSERT_EQ(back.position[i], batch.position[n]);
    ASSERT_EQ(back.rgb[i], batch.rgb[n]);
    ASSERT_EQ(back.intensity[i], batch.intensity[n]);
    ASSERT_EQ(back.classification[i], batch.classification[n]);
    ASSERT_EQ(back.returnNumber[i], batch.returnNumber[n]);
    ASSERT_EQ(back.gpsTime[i], batch.gpsTime[n]);
    ASSERT_EQ(back.normal[i], batch.normal[n]);
    ASSERT_EQ(back.scanner[i], batch.scanner[n]);
    ASSERT_EQ(back.pointSource[i], batch.pointSource[n]);
    ASSERT_EQ(back.column[i], batch.column[n]);
    for (std::size_t e = 0; e < 2; ++e)
      ASSERT_EQ(std::memcmp(&back.extra[e].data[4 * i], &batch.extra[e].data[4 * n], 4), 0);
  }
}

TEST(StoreColumns, ThreadsDoNotChangeTheStore) {
  const PointBatch batch = everyColumn(400'000);
  for (const LevelKind levels : {LevelKind::BlueNoise, LevelKind::Random}) {
    const auto one = storeOf(batch, {.levels = levels, .leafPoints = 5000, .threads = 1});
    const auto three = storeOf(batch, {.levels = levels, .leafPoints = 5000, .threads = 3});
    ASSERT_EQ(one->nodes().size(), three->nodes().size());
    ASSERT_EQ(std::memcmp(one->points().data(), three->points().data(), one->points().size_bytes()), 0);
    for (std::size_t a = 0; a < one->attributes().size(); ++a)
      ASSERT_TRUE(std::ranges::equal(one->attributes()[a].data, three->attributes()[a].data));
    for (std::uint32_t n = 0; n < one->nodes().size(); ++n)
      ASSERT_TRUE(std::ranges::equal(one->levelsOf(n).cumulative, three->levelsOf(n).cumulative));
  }
}

}  // namespace
}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// The scanner-grid surface that is kept beside a store.

#include "app/scan_surface.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>

#include <gtest/gtest.h>
#include <unistd.h>

#include "cloud/store_index.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

constexpr int kRows = 80, kColumns = 160;

/// Two stations in a round room of radius 5 m and 7 m, each a grid of its own.
PointBatch roundRooms() {
  PointBatch batch;
  for (std::uint16_t s = 0; s < 2; ++s)
    for (int r = 0; r < kRows; ++r)
      for (int c = 0; c < kColumns; ++c) {
        const double azimuth = 0.02 * c, up = 0.02 * (r - kRows / 2), radius = s == 0 ? 5 : 7;
        batch.position.push_back(glm::dvec3(100 + 3 * s, 200, 10) + radius * glm::dvec3(std::cos(azimuth), std::sin(azimuth), std::tan(up)));
        batch.scanner.push_back(s);
        batch.row.push_back(static_cast<std::uint32_t>(r));
        batch.column.push_back(static_cast<std::uint32_t>(c));
      }
  return batch;
}

ScanSource sourceOf(PointBatch batch, bool withGrid) {
  if (!withGrid) batch.row.clear(), batch.column.clear();
  ScanSource source;
  source.name = "rooms";
  source.info.pointCount = batch.size();
  for (const glm::dvec3& p : batch.position) source.info.bounds.add(p);
  for (int s = 0; s < 2; ++s) source.info.stations.push_back({"S", {glm::dquat(1, 0, 0, 0), glm::dvec3(100 + 3 * s, 200, 10)}, kRows, kColumns});
  source.read = [batch](const ScanSource::Sink& sink, const Progress&) -> Result<void> {
    PointBatch copy = batch;
    sink(copy);
    return {};
  };
  return source;
}

struct KeptSurface : ::testing::Test {
  fs::path folder = fs::temp_directory_path() / ("alidade_surface_" + std::to_string(getpid()));
  std::string store = (folder / "rooms.alidade-points").string();
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  StoreFolder made(bool withGrid = true) {
    const ScanSource source = sourceOf(roundRooms(), withGrid);
    EXPECT_TRUE(indexScans(std::span(&source, 1), store, {}, Progress()).has_value());
    return *openStore(store);
  }
};

bool same(const OccluderMesh& a, const OccluderMesh& b) {
  const auto bytes = [](const auto& x, const auto& y) {
    return x.size() == y.size() && (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]) == 0);
  };
  return bytes(a.origins, b.origins) && bytes(a.blocks, b.blocks) && bytes(a.packs, b.packs) && a.returns == b.returns &&
         a.mergedQuads == b.mergedQuads && a.cellQuads == b.cellQuads && a.borderSquares == b.borderSquares && a.withoutGrid == b.withoutGrid;
}

}  // namespace

TEST_F(KeptSurface, IsJoinedOnceAndThenReadAsItWas) {
  const StoreFolder opened = made();
  const fs::path file = fs::path(store) / "part-0001/surface.bin";
  ASSERT_FALSE(fs::exists(file));
  const auto joined = surfaceOfPart(store, opened.parts[0], Progress());
  ASSERT_NE(joined, nullptr);
  EXPECT_EQ(joined->returns, 2u * kRows * kColumns);
  ASSERT_TRUE(fs::exists(file));
  const auto written = fs::last_write_time(file);
  const auto read = surfaceOfPart(store, opened.parts[0], Progress());
  ASSERT_NE(read, nullptr);
  EXPECT_TRUE(same(*joined, *read));
  EXPECT_EQ(fs::last_write_time(file), written);
  EXPECT_TRUE(openStore(store).has_value());
}

TEST_F(KeptSurface, IsMadeAnewWhereItIsDamagedOrOfAnotherPart) {
  const StoreFolder opened = made();
  const fs::path file = fs::path(store) / "part-0001/surface.bin";
  const auto joined = surfaceOfPart(store, opened.parts[0], Progress());
  const auto size = fs::file_size(file);
  for (const std::uint64_t at : {std::uint64_t{3}, std::uint64_t{9}, std::uint64_t{17}, size / 2, size - 1}) {
    {
      std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
      bytes.seekp(static_cast<std::streamoff>(at));
      bytes.put('\x5a');
    }
    const auto again = surfaceOfPart(store, opened.parts[0], Progress());
    ASSERT_NE(again, nullptr) << at;
    EXPECT_TRUE(same(*joined, *again)) << at;
  }
  fs::resize_file(file, size / 3);
  EXPECT_TRUE(same(*joined, *surfaceOfPart(store, opened.parts[0], Progress())));
  EXPECT_EQ(fs::file_size(file), size);
  StorePart other = opened.parts[0];
  other.manifest.nodesChecksum ^= 1;
  EXPECT_TRUE(same(*joined, *surfaceOfPart(store, other, Progress())));
}

TEST_F(KeptSurface, OfStationsOneByOneIsThatOfAllTogether) {
  const StoreFolder opened = made();
  const auto& part = opened.parts[0];
  const auto whole = joinGrids(*part.points, part.manifest.info.stations, Progress());
  const auto each = joinGrids(*part.points, part.manifest.info.stations, Progress(), kRows * kColumns);
  ASSERT_TRUE(whole && each);
  EXPECT_TRUE(same(*whole, *each));
  // A station that is too large is left to its points.
  EXPECT_EQ(joinGrids(*part.points, part.manifest.info.stations, Progress(), kRows * kColumns - 1), nullptr);
}

TEST_F(KeptSurface, ThereIsNoneWithoutAGridAndNoneWhenCancelled) {
  const StoreFolder opened = made(false);
  EXPECT_EQ(surfaceOfPart(store, opened.parts[0], Progress()), nullptr);
  EXPECT_FALSE(fs::exists(fs::path(store) / "part-0001/surface.bin"));
  fs::remove_all(store);
  const StoreFolder grid = made();
  Progress cancelled;
  cancelled.cancel();
  EXPECT_EQ(surfaceOfPart(store, grid.parts[0], cancelled), nullptr);
  EXPECT_FALSE(fs::exists(fs::path(store) / "part-0001/surface.bin"));
}

}  // namespace alidade

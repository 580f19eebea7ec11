// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Damaged LAZ and COPC files, and COPC read over a network.

#include <fstream>
#include <iterator>
#include <random>

#include "las/copc_hierarchy.h"
#include "las/http_source.h"
#include "las/las_writer.h"
#include "unit/las/all_points.h"
#include "unit/las/las_file_maker.h"
#include "unit/las/range_server.h"

using alidade::ByteSource;
using alidade::LasFormatWriter;
using alidade::LasReader;
using alidade::OctreeCell;
using alidade::PointBatch;
using alidade::Progress;
using alidade::testing::AllPoints;
using alidade::testing::expectSamePoints;
using alidade::testing::LasFileMaker;
using alidade::testing::RangeServer;
using alidade::testing::readEverything;
using ::testing::HasSubstr;
using Kind = LasFormatWriter::Kind;

namespace {

std::vector<std::uint8_t> bytesOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string writeBytes(const std::string& name, const std::vector<std::uint8_t>& bytes) {
  LasFileMaker file(2, 0, 20);
  file.bytes = bytes;
  return file.write(name);
}

PointBatch somePoints(std::size_t count, bool old) {
  PointBatch batch;
  std::mt19937 random(7);
  alidade::ExtraColumn rank{"scan_angle_rank", alidade::NumberType::I8, 1, std::vector<std::byte>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    batch.position.push_back({0.01 * static_cast<double>(i), 0.01 * static_cast<double>(random() % 1000), 1});
    batch.intensity.push_back(static_cast<std::uint16_t>(random() % 99));
    batch.gpsTime.push_back(static_cast<double>(i));
    batch.rgb.push_back(glm::u16vec3(random() % 65536));
  }
  batch.rgbWhite = 65535;
  if (old) batch.extra.push_back(rank);
  return batch;
}

/// A file of `count` points; COPC in two nodes.
std::string makeFile(Kind kind, bool old, std::size_t count) {
  const std::string path = writeBytes(kind == Kind::Copc ? "good.copc.laz" : "good.laz", {});
  alidade::ScanWriteOptions options;
  options.info.scale = glm::dvec3(0.01);
  options.cubeSize = 1e6;
  options.rootSpacing = 1;
  auto sink = LasFormatWriter(kind).create(path, options);
  const PointBatch points = somePoints(count, old);
  if (kind == Kind::Copc) {
    EXPECT_TRUE((*sink)->add(points.every(0, 2), OctreeCell{}).has_value());
    EXPECT_TRUE((*sink)->add(points.every(1, 2), OctreeCell{3, 0, 0, 0}).has_value());
  } else {
    EXPECT_TRUE((*sink)->add(points, {}).has_value());
  }
  EXPECT_TRUE((*sink)->finish().has_value());
  return path;
}

struct Coding {
  Kind kind;
  bool old;
};
constexpr Coding kCodings[] = {{Kind::Laz, true}, {Kind::Laz, false}, {Kind::Copc, false}};

/// Whatever comes of a damaged file: no more points than it promises, and an error with words.
void expectHarmless(const std::string& path) {
  const auto info = LasReader().inspect(path);
  std::uint64_t count = 0;
  const auto take = [&](PointBatch& batch) {
    count += batch.size();
    return true;
  };
  const auto read = LasReader().read(path, take, Progress());
  EXPECT_TRUE(!read || info) << "read what inspect refuses";
  if (info) {
    EXPECT_LE(count, info->pointCount);
  }
  if (!read) {
    EXPECT_NE(read.error().what, "");
  }
  (void)LasReader().sample(path, 100, [](PointBatch&) { return true; }, Progress());
}

}  // namespace

TEST(LazDamage, AFileCutAnywhereIsRefusedOrHarmless) {
  for (const Coding& coding : kCodings) {
    const auto good = bytesOf(makeFile(coding.kind, coding.old, 3000));
    for (std::size_t size = 0; size < good.size(); size += size < 1200 ? 37 : 1 + good.size() / 60) {
      const std::string path = writeBytes("cut.laz", {good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)});
      expectHarmless(path);
      EXPECT_FALSE(LasReader().read(path, [](PointBatch&) { return true; }, Progress()).has_value() && size < good.size() / 2)
          << "cut at " << size;
    }
  }
}

TEST(LazDamage, FlippedBitsAndOverwrittenNumbersAreHarmless) {
  for (const Coding& coding : kCodings) {
    const auto good = bytesOf(makeFile(coding.kind, coding.old, 1500));
    std::mt19937 random(coding.old ? 1 : 2);
    for (int trial = 0; trial < 120; ++trial) {
      auto bytes = good;
      // Half of the time in the header and records, where the lies hurt most.
      const std::size_t room = trial % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 900);
      for (int i = 0; i < 1 + trial % 4; ++i) {
        const std::size_t at = random() % (room - 4);
        if (trial % 3 == 0)
          std::memset(&bytes[at], trial % 2 ? 0xFF : 0, 4);
        else
          bytes[at] ^= static_cast<std::uint8_t>(1u << random() % 8);
      }
      expectHarmless(writeBytes("flipped.laz", bytes));
    }
  }
}

TEST(LazDamage, WithoutItsChunkTableAFileIsReadFromItsStart) {
  for (const bool old : {true, false}) {
    const std::string path = makeFile(Kind::Laz, old, 120000);
    const AllPoints whole = readEverything(path);
    ASSERT_EQ(whole.all.size(), 120000u) << whole.error;
    auto bytes = bytesOf(path);
    std::uint32_t pointsAt;
    std::memcpy(&pointsAt, &bytes[96], 4);
    std::int64_t tableAt;
    std::memcpy(&tableAt, &bytes[pointsAt], 8);

    // As a writer leaves it that could not go back: -1 there, the place at the end.
    auto streamed = bytes;
    std::memset(&streamed[pointsAt], 0xFF, 8);
    streamed.insert(streamed.end(), reinterpret_cast<std::uint8_t*>(&tableAt), reinterpret_cast<std::uint8_t*>(&tableAt) + 8);
    expectSamePoints(readEverything(writeBytes("streamed.laz", streamed)).all, whole.all, "table named at the end");

    // As an interrupted one leaves it: no table at all.
    auto interrupted = bytes;
    std::memset(&interrupted[pointsAt], 0, 8);
    interrupted.resize(static_cast<std::size_t>(tableAt));
    const AllPoints read = readEverything(writeBytes("interrupted.laz", interrupted));
    EXPECT_EQ(read.error, "");
    expectSamePoints(read.all, whole.all, "no table");
  }
}

TEST(LazDamage, HierarchyPagesThatRunInCirclesOrOutOfTheFileAreRefused) {
  const auto good = bytesOf(makeFile(Kind::Copc, false, 100));
  std::uint64_t rootAt;
  std::memcpy(&rootAt, &good[375 + 54 + 40], 8);
  const auto errorWith = [&](std::uint64_t offset, std::int32_t size, std::int32_t count) {
    auto bytes = good;
    std::memcpy(&bytes[rootAt + 16], &offset, 8);
    std::memcpy(&bytes[rootAt + 24], &size, 4);
    std::memcpy(&bytes[rootAt + 28], &count, 4);
    const std::string path = writeBytes("pages.copc.laz", bytes);
    const auto ok = LasReader().sample(path, 50, [](PointBatch&) { return true; }, Progress());
    return ok ? std::string() : ok.error().text();
  };
  EXPECT_THAT(errorWith(rootAt, 64, -1), HasSubstr("circles"));
  EXPECT_THAT(errorWith(good.size(), 3200, -1), HasSubstr("does not fit"));
  EXPECT_THAT(errorWith(good.size(), 100, 7), HasSubstr("not among the file's points"));
  EXPECT_THAT(errorWith(rootAt, 64, -5), HasSubstr("-5 points"));
}

TEST(CopcOverHttp, HeaderHierarchyAndChunksAreReadByFewRanges) {
  const std::string path = makeFile(Kind::Copc, false, 200000);
  const auto bytes = bytesOf(path);
  RangeServer server(bytes, RangeServer::Manner::Ranges);
  const std::string address = server.address("good.copc.laz");
  const auto info = LasReader().inspect(address);
  ASSERT_TRUE(info.has_value()) << info.error().text();
  EXPECT_EQ(info->pointCount, 200000u);
  EXPECT_LE(server.requests(), 3);
  EXPECT_LT(server.bytesSent(), bytes.size() / 2);

  // The root node alone, by the hierarchy: not the whole file.
  std::size_t count = 0;
  const std::size_t before = server.bytesSent();
  const auto sampled = LasReader().sample(
      address, 100000, [&](PointBatch& batch) { count += batch.size(); return true; }, Progress());
  ASSERT_TRUE(sampled.has_value()) << sampled.error().text();
  EXPECT_EQ(count, 100000u);
  EXPECT_LT(server.bytesSent() - before, bytes.size() * 3 / 4);
  expectSamePoints(readEverything(address).all, readEverything(path).all, "over the network");
}

TEST(CopcOverHttp, AServerThatCannotIsNamedWithItsReason) {
  const std::vector<std::uint8_t> bytes(200000, 1);
  const auto errorOf = [&](RangeServer::Manner manner) {
    RangeServer server(bytes, manner);
    const auto source = alidade::openHttpSource(server.address("a.laz"), {std::chrono::seconds(2), std::chrono::seconds(1)});
    return source ? std::string() : source.error().text();
  };
  EXPECT_THAT(errorOf(RangeServer::Manner::Missing), HasSubstr("no such file"));
  EXPECT_THAT(errorOf(RangeServer::Manner::WholeOnly), HasSubstr("no range requests"));
  EXPECT_THAT(errorOf(RangeServer::Manner::Silent), HasSubstr("in time"));
  const auto nobody = alidade::openHttpSource("http://127.0.0.1:1/a.laz");
  ASSERT_FALSE(nobody.has_value());
  EXPECT_THAT(nobody.error().text(), HasSubstr("cannot be read"));
}

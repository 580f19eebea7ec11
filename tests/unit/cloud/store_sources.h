// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "cloud/point_store.h"
#include "cloud/scan_source.h"
#include "cloud/store_folder.h"
#include "cloud/store_index.h"

namespace alidade::test {

/// A folder of its own, gone at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    static std::atomic<int> number{0};
    m_path = std::filesystem::temp_directory_path() / ("alidade-store-" + std::to_string(::getpid()) + "-" + std::to_string(number++));
    std::filesystem::create_directories(m_path);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(m_path, ignored);
  }
  std::string operator/(const std::string& name) const { return (m_path / name).string(); }

 private:
  std::filesystem::path m_path;
};

/// Points `first` to `first + count` of a made-up hall: millimetres on a survey's coordinates, with colour,
/// intensity, GPS time and an extra column. Every point depends on its number alone, so that nothing is kept.
inline PointBatch hallPoints(std::uint64_t first, std::uint64_t count, std::uint32_t seed) {
  PointBatch batch;
  ExtraColumn extra{"amplitude \xe9", NumberType::F32, 1, {}};  // as files have it: Latin-1, no UTF-8
  extra.data.resize(count * 4);
  for (std::uint64_t i = first; i < first + count; ++i) {
    std::uint64_t h = (i + 1) * 0x9e3779b97f4a7c15ull + seed;
    const auto next = [&h] {
      h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ull;
      h ^= h >> 27;
      return static_cast<double>(h >> 11) * 0x1p-53;
    };
    const double a = 180 * std::pow(next(), 1.5), b = 60 * next(), c = 0.01 * next();
    const glm::dvec3 p = i % 3 == 0 ? glm::dvec3(a, b, c) : i % 3 == 1 ? glm::dvec3(a, 60 + c, b / 5) : glm::dvec3(a, c, b / 5);
    batch.position.push_back(glm::dvec3(0.001) * glm::floor(p * 1000.0 + 5000000.0) + glm::dvec3(400000, 5500000, 100));
    batch.rgb.push_back(glm::u16vec3(i % 251, i % 241, i % 239));
    batch.intensity.push_back(static_cast<std::uint16_t>(i * 7));
    batch.gpsTime.push_back(3e8 + 1e-5 * static_cast<double>(i));
    const float value = 0.1f * static_cast<float>(i);
    std::memcpy(&extra.data[(i - first) * 4], &value, 4);
  }
  batch.extra = {extra};
  return batch;
}

inline constexpr std::uint64_t kHallBatch = 50'000;

inline ScanSource hallScan(std::uint64_t count, std::uint32_t seed = 1) {
  ScanSource scan;
  scan.name = "/scans/hall-" + std::to_string(seed) + ".las";
  scan.identity = scan.name + ":" + std::to_string(count);
  scan.info.pointCount = count;
  scan.info.scale = glm::dvec3(0.001);
  scan.info.offset = glm::dvec3(400000, 5500000, 100);
  scan.info.bounds.add(glm::dvec3(405000, 5505000, 5100)), scan.info.bounds.add(glm::dvec3(405180, 5505060.01, 5112));
  scan.info.crs = "EPSG:25832";
  scan.info.details = "made up";
  Station station;
  station.name = "S1";
  station.worldFromScanner.translation = {405010, 5505010, 5101.5};
  station.rows = 10, station.columns = 20;
  scan.info.stations = {station};
  scan.read = [count, seed](const ScanSource::Sink& sink, const Progress& progress) -> Result<void> {
    for (std::uint64_t first = 0; first < count; first += kHallBatch) {
      if (progress.cancelled()) return fail(cancelledError());
      PointBatch batch = hallPoints(first, std::min(kHallBatch, count - first), seed);
      if (!sink(batch)) break;
      progress.report(static_cast<double>(first) / static_cast<double>(count), "Reading");
    }
    return {};
  };
  scan.sample = [count, seed](std::uint64_t wanted, const ScanSource::Sink& sink, const Progress&) -> Result<void> {
    const std::uint64_t step = std::max<std::uint64_t>(1, count / wanted);
    for (std::uint64_t first = 0; first < count; first += kHallBatch) {
      PointBatch batch = hallPoints(first, std::min(kHallBatch, count - first), seed).every(0, step);
      if (!sink(batch)) break;
    }
    return {};
  };
  return scan;
}

/// The same scan as PointStoreBuilder makes it.
inline std::shared_ptr<const PointStore> inMemory(const ScanSource& scan, LevelKind levels = LevelKind::BlueNoise) {
  PointStoreBuilder::Options options;
  options.levels = levels;
  options.scale = scan.info.scale, options.offset = scan.info.offset;
  PointStoreBuilder builder(options);
  (void)scan.read([&](PointBatch& batch) { return builder.add(batch), true; }, Progress());
  return *builder.build(Progress());
}

inline bool sameBytes(std::span<const std::byte> a, std::span<const std::byte> b) {
  return std::ranges::equal(a, b);
}

/// Nothing where two stores hold the same, else what differs first.
inline std::string difference(const PointStore& a, const PointStore& b) {
  if (a.pointCount() != b.pointCount()) return "point count";
  if (a.nodes().size() != b.nodes().size()) return "node count";
  if (!sameBytes(std::as_bytes(a.points()), std::as_bytes(b.points()))) return "points";
  if (a.attributes().size() != b.attributes().size()) return "columns";
  for (std::size_t c = 0; c < a.attributes().size(); ++c) {
    const AttributeColumn &x = a.attributes()[c], &y = b.attributes()[c];
    if (x.name != y.name || x.type != y.type || x.components != y.components || !sameBytes(x.data, y.data)) return "column " + x.name;
  }
  for (std::uint32_t n = 0; n < a.nodes().size(); ++n) {
    const CloudNode &x = a.nodes()[n], &y = b.nodes()[n];
    if (x.origin != y.origin || x.step != y.step || x.size != y.size || x.bounds.min != y.bounds.min || x.bounds.max != y.bounds.max ||
        x.depth != y.depth || x.firstChild != y.firstChild || x.childCount != y.childCount || x.first != y.first || x.count != y.count ||
        x.spacing != y.spacing)
      return "node " + std::to_string(n);
    if (a.levelsOf(n).firstStep != b.levelsOf(n).firstStep || !std::ranges::equal(a.levelsOf(n).cumulative, b.levelsOf(n).cumulative))
      return "levels of node " + std::to_string(n);
  }
  if (a.medianSpacing() != b.medianSpacing() || a.rgbWhite() != b.rgbWhite()) return "summary";
  for (std::uint64_t p = 0; p < a.pointCount(); p += 977)
    if (a.sourcePosition(p) != b.sourcePosition(p)) return "source positions";
  return {};
}

inline std::string bytesOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Relative path -> content of all files of a folder.
inline std::map<std::string, std::string> filesOf(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[std::filesystem::relative(entry.path(), folder).string()] = bytesOf(entry.path().string());
  return files;
}

}  // namespace alidade::test

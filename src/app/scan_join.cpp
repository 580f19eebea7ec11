// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/scan_join.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include <fmt/format.h>

namespace alidade {

namespace {

constexpr std::uint16_t kNoStation = 65535;

/// Several scans become one file: every batch gets every column that any of them has.
class Columns {
 public:
  void learn(const PointBatch& batch) {
    m_rgb |= !batch.rgb.empty();
    m_time |= !batch.gpsTime.empty();
    m_scanner |= !batch.scanner.empty();
    m_grid |= !batch.row.empty();
    m_normal |= !batch.normal.empty();
    for (std::size_t i = 0; i < batch.extra.size(); ++i) {
      const ExtraColumn& column = batch.extra[i];
      if (!find(m_extra, column.name, ordinalOf(batch.extra, i))) m_extra.push_back({column.name, column.type, column.components, {}});
    }
  }

  void complete(PointBatch& batch) const {
    const std::size_t count = batch.size();
    if (find(m_extra, "scan_angle")) turnRankIntoAngle(batch);
    if (m_rgb && batch.rgb.empty()) batch.rgb.resize(count);
    if (m_time && batch.gpsTime.empty()) batch.gpsTime.resize(count);
    if (m_scanner && batch.scanner.empty()) batch.scanner.resize(count, kNoStation);
    if (m_grid && batch.row.empty()) {
      batch.row.resize(count);
      batch.column.resize(count);
    }
    if (m_normal && batch.normal.empty()) batch.normal.resize(count);
    for (std::size_t i = 0; i < m_extra.size(); ++i) {
      const ExtraColumn& column = m_extra[i];
      if (find(batch.extra, column.name, ordinalOf(m_extra, i))) continue;
      if (column.name == "scan_angle_rank" && find(batch.extra, "scan_angle")) continue;
      ExtraColumn& added = batch.extra.emplace_back(column);
      added.data.resize(count * added.bytesPerPoint());
    }
  }

 private:
  /// Among the columns of its name, from 0.
  static std::size_t ordinalOf(const std::vector<ExtraColumn>& columns, std::size_t index) {
    std::size_t ordinal = 0;
    for (std::size_t i = 0; i < index; ++i) ordinal += columns[i].name == columns[index].name;
    return ordinal;
  }
  static ExtraColumn* find(std::vector<ExtraColumn>& columns, const std::string& name, std::size_t ordinal = 0) {
    for (ExtraColumn& column : columns)
      if (column.name == name && ordinal-- == 0) return &column;
    return nullptr;
  }
  static const ExtraColumn* find(const std::vector<ExtraColumn>& columns, const std::string& name, std::size_t ordinal = 0) {
    return find(const_cast<std::vector<ExtraColumn>&>(columns), name, ordinal);
  }

  /// The older formats' whole degrees as the newer ones' 0.006 degrees.
  static void turnRankIntoAngle(PointBatch& batch) {
    ExtraColumn* rank = find(batch.extra, "scan_angle_rank");
    if (!rank || find(batch.extra, "scan_angle")) return;
    ExtraColumn angle{"scan_angle", NumberType::I16, 1, std::vector<std::byte>(2 * batch.size())};
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const auto value = static_cast<std::int16_t>(std::lround(numberAt(&rank->data[i], NumberType::I8) / 0.006));
      std::memcpy(angle.data.data() + 2 * i, &value, 2);
    }
    *rank = std::move(angle);
  }

  bool m_rgb = false, m_time = false, m_scanner = false, m_grid = false, m_normal = false;
  std::vector<ExtraColumn> m_extra;
};

/// "EPSG:2056+5728" beside "EPSG:2056": the same plane, and one that says what the heights are.
bool addsHeights(const std::string& crs, const std::string& plane) {
  return !plane.empty() && crs.starts_with(plane + "+");
}

/// What is said of all scans together.
Result<ScanInfo> describeAll(const std::vector<ScanSource>& scans) {
  ScanInfo all = scans.front().info;
  bool same = true;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const ScanInfo& info = scans[i].info;
    const bool agrees = info.crs.empty() || all.crs.empty() || info.crs == all.crs || addsHeights(info.crs, all.crs) || addsHeights(all.crs, info.crs);
    if (!agrees)
      return fail("The scans are in different coordinate systems", scans[i].name, "Transform them into one first");
    if (all.crs.empty() || addsHeights(info.crs, all.crs)) all.crs = info.crs;
    same = same && info.scale == all.scale && info.offset == all.offset;
    all.bounds.add(info.bounds);
    all.pointCount += info.pointCount;
    all.stations.insert(all.stations.end(), info.stations.begin(), info.stations.end());
    for (const std::string& attribute : info.attributes)
      if (std::ranges::find(all.attributes, attribute) == all.attributes.end()) all.attributes.push_back(attribute);
  }
  if (same) return all;
  // The finest steps of all, about the middle of all, as far as 32 bits reach.
  for (const ScanSource& scan : scans) all.scale = glm::min(all.scale, scan.info.scale);
  if (!all.bounds.empty() && glm::all(glm::greaterThan(all.scale, glm::dvec3(0))))
    all.scale = glm::max(all.scale, all.bounds.size() / 4.0e9);
  if (all.bounds.empty() || !glm::all(glm::greaterThan(all.scale, glm::dvec3(0)))) all.scale = glm::dvec3(0);
  else all.offset = glm::round(all.bounds.centre());
  return all;
}

/// What all the scans' files say together.
ScanNotes joinNotes(const std::vector<ScanSource>& scans, std::vector<ImportWarning>* warnings) {
  if (scans.size() == 1) return scans.front().notes;
  ScanNotes all;
  const auto warn = [&](std::string what, const ScanSource& scan) {
    if (warnings != nullptr) warnings->push_back({std::move(what), scan.name});
  };
  const auto meaningIn = [](const ScanNotes& notes, const std::string& column) {
    const auto found = std::ranges::find(notes.columns, column, &ColumnMeaning::column);
    return found == notes.columns.end() ? ColumnMeaning{column, {}, 0, {}, {}, {}, glm::dvec3(1), glm::dvec3(0)} : *found;
  };
  for (const ScanSource& scan : scans) {
    all.degrees |= scan.notes.degrees;
    if (all.gpsTime == GpsTimeKind::Unknown) all.gpsTime = scan.notes.gpsTime;
    else if (scan.notes.gpsTime != GpsTimeKind::Unknown && scan.notes.gpsTime != all.gpsTime)
      warn("The scans count GPS times differently, one in seconds of the week and one in standard time; all are kept as they are and named as the first scan's", scan);
    for (const ForeignRecord& record : scan.notes.records)
      warn(fmt::format("Record {} of {} is left out: it is of one scan of several", record.id, record.user), scan);
    for (const ColumnMeaning& meaning : scan.notes.columns) {
      if (std::ranges::find(all.columns, meaning.column, &ColumnMeaning::column) != all.columns.end()) continue;
      const bool same = std::ranges::all_of(scans, [&](const ScanSource& other) {
        return std::ranges::find(other.info.attributes, meaning.column) == other.info.attributes.end() ||
               meaningIn(other.notes, meaning.column).sameNumbers(meaning);
      });
      ColumnMeaning& joined = all.columns.emplace_back(meaning);
      joined.given &= same ? 0x19 : 0;  // the extremes are one scan's
      if (!same)
        warn(fmt::format("The scans' column \"{}\" has different scales, offsets or marks for missing values: its numbers are kept as they are, and these left out",
                         meaning.column), scan);
    }
  }
  return all;
}

struct Joined {
  std::vector<ScanSource> scans;
  std::vector<std::uint16_t> firstStation;  ///< a scan's station 0 among all
  Columns columns;

  /// Hands every batch of every scan to `sink`, completed; `each` reads one scan.
  template <class Each>
  Result<void> readAll(const ScanSource::Sink& sink, const Progress& progress, const Each& each) const {
    const double share = 1.0 / static_cast<double>(scans.size());
    bool stopped = false;
    for (std::size_t i = 0; i < scans.size() && !stopped; ++i) {
      const auto take = [&](PointBatch& batch) {
        for (auto& scanner : batch.scanner)
          if (scanner != kNoStation) scanner = static_cast<std::uint16_t>(scanner + firstStation[i]);
        columns.complete(batch);
        stopped = !sink(batch);
        return !stopped;
      };
      const double from = share * static_cast<double>(i);
      if (auto read = each(scans[i], take, progress.part(from, from + share)); !read) return fail(read.error());
    }
    return {};
  }
};

}  // namespace

Result<ScanSource> joinScans(std::vector<ScanSource> scans, std::vector<ImportWarning>* warnings) {
  if (scans.empty()) return fail("There are no scans", {}, "Name at least one");
  auto info = describeAll(scans);
  if (!info) return fail(info.error());
  ScanNotes notes = joinNotes(scans, warnings);
  auto joined = std::make_shared<Joined>();
  std::size_t stations = 0;
  for (const ScanSource& scan : scans) {
    joined->firstStation.push_back(static_cast<std::uint16_t>(stations));
    stations += scan.info.stations.size();
    const auto learn = [&](PointBatch& batch) {
      joined->columns.learn(batch);
      return false;
    };
    if (auto seen = scan.read(learn, Progress()); !seen) return fail(seen.error());
  }
  if (stations >= kNoStation) return fail("The scans have too many stations together", scans.front().name, "Take fewer scans");
  ScanSource source;
  source.name = scans.front().name;
  if (scans.size() == 1) source.identity = scans.front().identity;
  source.info = std::move(*info);
  source.notes = std::move(notes);
  joined->scans = std::move(scans);
  source.read = [joined](const ScanSource::Sink& sink, const Progress& progress) {
    return joined->readAll(sink, progress, [](const ScanSource& scan, const auto& take, const Progress& part) { return scan.read(take, part); });
  };
  source.sample = [joined, total = source.info.pointCount](std::uint64_t wanted, const ScanSource::Sink& sink, const Progress& progress) {
    const double share = static_cast<double>(wanted) / static_cast<double>(std::max<std::uint64_t>(1, total));
    return joined->readAll(sink, progress, [share](const ScanSource& scan, const auto& take, const Progress& part) {
      return scan.sample(static_cast<std::uint64_t>(share * static_cast<double>(scan.info.pointCount)) + 1, take, part);
    });
  };
  return source;
}

}  // namespace alidade

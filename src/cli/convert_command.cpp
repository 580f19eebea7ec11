// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/copc_tree.h"
#include "io/reader_registry.h"

namespace alidade::cli {

namespace {

namespace fs = std::filesystem;

struct Input {
  std::string path;
  const ScanReader* reader = nullptr;
  ScanInfo info;
  std::uint16_t firstStation = 0;  ///< its station 0 among all
};

/// Several scans become one file: every batch gets every column that any of them has.
class Columns {
 public:
  void learn(const PointBatch& batch) {
    m_rgb |= !batch.rgb.empty();
    m_time |= !batch.gpsTime.empty();
    m_scanner |= !batch.scanner.empty();
    m_grid |= !batch.row.empty();
    m_normal |= !batch.normal.empty();
    for (const ExtraColumn& column : batch.extra)
      if (!find(m_extra, column.name)) m_extra.push_back({column.name, column.type, column.components, {}});
  }

  void complete(PointBatch& batch) const {
    const std::size_t count = batch.size();
    if (find(m_extra, "scan_angle")) turnRankIntoAngle(batch);
    if (m_rgb && batch.rgb.empty()) batch.rgb.resize(count);
    if (m_time && batch.gpsTime.empty()) batch.gpsTime.resize(count);
    constexpr std::uint16_t kNoStation = 65535;
    if (m_scanner && batch.scanner.empty()) batch.scanner.resize(count, kNoStation);
    if (m_grid && batch.row.empty()) {
      batch.row.resize(count);
      batch.column.resize(count);
    }
    if (m_normal && batch.normal.empty()) batch.normal.resize(count);
    for (const ExtraColumn& column : m_extra) {
      if (find(batch.extra, column.name)) continue;
      if (column.name == "scan_angle_rank" && find(batch.extra, "scan_angle")) continue;
      ExtraColumn& added = batch.extra.emplace_back(column);
      added.data.resize(count * added.bytesPerPoint());
    }
  }

 private:
  static ExtraColumn* find(std::vector<ExtraColumn>& columns, const std::string& name) {
    const auto found = std::find_if(columns.begin(), columns.end(), [&](const auto& each) { return each.name == name; });
    return found == columns.end() ? nullptr : &*found;
  }
  static const ExtraColumn* find(const std::vector<ExtraColumn>& columns, const std::string& name) {
    return find(const_cast<std::vector<ExtraColumn>&>(columns), name);
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

Result<std::vector<Input>> openAll(const std::vector<std::string>& paths) {
  std::vector<Input> inputs;
  std::size_t stations = 0;
  for (const std::string& path : paths) {
    const auto reader = ReaderRegistry::instance().findAs<ScanReader>(path);
    if (!reader) return fail(reader.error());
    auto info = (*reader)->inspect(path);
    if (!info) return fail(info.error());
    inputs.push_back({path, *reader, std::move(*info), static_cast<std::uint16_t>(stations)});
    stations += inputs.back().info.stations.size();
  }
  return inputs;
}

/// What the one file says of all scans.
Result<ScanWriteOptions> describeAll(const std::vector<Input>& inputs) {
  ScanWriteOptions options;
  ScanInfo& all = options.info;
  all = inputs.front().info;
  bool same = true;
  for (std::size_t i = 1; i < inputs.size(); ++i) {
    const ScanInfo& info = inputs[i].info;
    if (!info.crs.empty() && !all.crs.empty() && info.crs != all.crs)
      return fail("The scans are in different coordinate systems", inputs[i].path, "Transform them into one first");
    if (all.crs.empty()) all.crs = info.crs;
    same = same && info.scale == all.scale && info.offset == all.offset;
    all.bounds.add(info.bounds);
    all.pointCount += info.pointCount;
    all.stations.insert(all.stations.end(), info.stations.begin(), info.stations.end());
  }
  if (same) return options;
  // The finest steps of all, about the middle of all, as far as 32 bits reach.
  for (const Input& input : inputs) all.scale = glm::min(all.scale, input.info.scale);
  if (!all.bounds.empty() && glm::all(glm::greaterThan(all.scale, glm::dvec3(0))))
    all.scale = glm::max(all.scale, all.bounds.size() / 4.0e9);
  if (all.bounds.empty() || !glm::all(glm::greaterThan(all.scale, glm::dvec3(0))))
    all.scale = glm::dvec3(0);
  else
    all.offset = glm::round(all.bounds.centre());
  return options;
}

Result<Columns> columnsOf(const std::vector<Input>& inputs) {
  Columns columns;
  for (const Input& input : inputs) {
    const auto seen = input.reader->read(
        input.path,
        [&](PointBatch& batch) {
          columns.learn(batch);
          return false;
        },
        Progress());
    if (!seen) return fail(seen.error());
  }
  return columns;
}

/// Hands every batch of every scan to `take`, completed.
template <class Take>
Result<std::vector<std::string>> readAll(const std::vector<Input>& inputs, const Columns& columns, const Progress& progress,
                                         const Take& take) {
  std::vector<std::string> warnings;
  const double share = 1.0 / static_cast<double>(inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    Result<void> taken;
    const auto read = inputs[i].reader->read(
        inputs[i].path,
        [&](PointBatch& batch) {
          for (auto& scanner : batch.scanner) scanner = static_cast<std::uint16_t>(scanner + inputs[i].firstStation);
          columns.complete(batch);
          taken = take(batch);
          return taken.has_value();
        },
        progress.part(share * static_cast<double>(i), share * static_cast<double>(i + 1)));
    if (!read) return fail(read.error());
    if (!taken) return fail(taken.error());
    for (const ImportWarning& warning : *read) warnings.push_back(fmt::format("{}: {}", inputs[i].path, warning.what));
  }
  return warnings;
}

struct Written {
  std::uint64_t points = 0;
  std::vector<std::string> warnings;
};

Result<Written> writeFlat(const std::vector<Input>& inputs, const ScanWriter& writer, const std::string& out,
                          const Progress& progress) {
  const auto options = describeAll(inputs);
  if (!options) return fail(options.error());
  const auto columns = columnsOf(inputs);
  if (!columns) return fail(columns.error());
  auto sink = writer.create(out, *options);
  if (!sink) return fail(sink.error());
  Written written;
  auto warnings = readAll(inputs, *columns, progress, [&](const PointBatch& batch) {
    written.points += batch.size();
    return (*sink)->add(batch, {});
  });
  if (!warnings) return fail(warnings.error());
  written.warnings = std::move(*warnings);
  if (auto done = (*sink)->finish(); !done) return fail(done.error());
  return written;
}

Result<Written> writeTree(const std::vector<Input>& inputs, const ScanWriter& writer, const std::string& out,
                          const Progress& progress) {
  auto options = describeAll(inputs);
  if (!options) return fail(options.error());
  const auto columns = columnsOf(inputs);
  if (!columns) return fail(columns.error());
  CopcTree tree;
  auto warnings = readAll(inputs, *columns, progress.part(0, 0.5), [&](PointBatch& batch) {
    tree.add(std::move(batch));
    return Result<void>();
  });
  if (!warnings) return fail(warnings.error());
  if (auto done = tree.write(writer, out, *options, progress.part(0.5, 1)); !done) return fail(done.error());
  return Written{tree.pointCount(), std::move(*warnings)};
}

Result<Answer> convert(const std::vector<std::string>& paths, const std::string& out, bool overwrite,
                       const Progress& progress) {
  const auto writer = ReaderRegistry::instance().findWriter(out);
  if (!writer) return fail(writer.error());
  std::error_code ignored;
  for (const std::string& path : paths)
    if (fs::equivalent(path, out, ignored)) return fail("A scan cannot be converted onto itself", out, "Name another file");
  if (!overwrite && fs::exists(out, ignored))
    return fail("The file exists already", out, "Name another one, or allow it with --overwrite");
  const auto inputs = openAll(paths);
  if (!inputs) return fail(inputs.error());
  auto written = (*writer)->isTree() ? writeTree(*inputs, **writer, out, progress)
                                     : writeFlat(*inputs, **writer, out, progress);
  if (!written) return fail(written.error());
  Answer answer;
  const std::uint64_t bytes = fs::file_size(out, ignored);
  answer.json = {{"output", out}, {"format", (*writer)->description().id}, {"points", written->points},
                 {"bytes", bytes}, {"warnings", written->warnings}};
  answer.text = fmt::format("{}: {} points, {} bytes\n", out, written->points, bytes);
  for (const std::string& warning : written->warnings) answer.text += "  warning  " + warning + "\n";
  return answer;
}

}  // namespace

void addConvert(Verbs& verbs) {
  struct Arguments {
    std::vector<std::string> inputs;
    std::string output;
    bool overwrite = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      verbs.add("convert", "Write scans into one file, with all their columns", [arguments](const Progress& progress) {
        return convert(arguments->inputs, arguments->output, arguments->overwrite, progress);
      });
  command->add_option("scans", arguments->inputs, "Scans of any format that is read")->required();
  command->add_option("-o,--output", arguments->output, "The file: .las, .laz or .copc.laz")->required();
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file where it exists");
}

}  // namespace alidade::cli

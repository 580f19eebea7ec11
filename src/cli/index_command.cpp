// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <charconv>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "app/scan_source.h"
#include "app/scan_surface.h"
#include "cli/command.h"
#include "cloud/store_folder.h"
#include "cloud/store_index.h"

namespace alidade::cli {

namespace {

/// "512M", "2G", "1.5G", or bytes; from 64 MiB up.
Result<std::uint64_t> parseMemory(const std::string& text) {
  const auto wrong = [&] { return fail("This is no amount of memory: " + text, {}, "Write 512M or 2G, at least 64M"); };
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  std::string unit(end, text.data() + text.size());
  if (error != std::errc() || !std::isfinite(number) || unit.size() > 1) return wrong();
  if (unit == "K" || unit == "k") number *= 0x1p10;
  else if (unit == "M" || unit == "m") number *= 0x1p20;
  else if (unit == "G" || unit == "g") number *= 0x1p30;
  else if (!unit.empty()) return wrong();
  if (number < 64 * 0x1p20 || number > 0x1p50) return wrong();
  return static_cast<std::uint64_t>(number);
}

struct Arguments {
  std::vector<std::string> scans;
  std::string output, memory = "2G", levels = "blue-noise";
  std::uint32_t seed = 1;
  bool append = false;
};

Result<Answer> index(const Arguments& arguments, const Progress& progress) {
  std::vector<ImportWarning> warnings;
  std::vector<ScanSource> sources;
  for (const std::string& path : arguments.scans) {
    auto source = openScan(path, &warnings);
    if (!source) return fail(source.error());
    sources.push_back(std::move(*source));
  }
  IndexOptions options;
  options.memoryBytes = *parseMemory(arguments.memory);
  options.levels = arguments.levels == "random" ? LevelKind::Random : LevelKind::BlueNoise;
  options.seed = arguments.seed;
  options.append = arguments.append;
  const auto report = indexScans(sources, arguments.output, options, progress.part(0, 0.9));
  if (!report) return fail(report.error());
  if (const auto store = openStore(arguments.output)) keepSurfaces(*store, progress.part(0.9, 1));
  if (report->dropped > 0)
    warnings.push_back({fmt::format("{} points without usable coordinates were left out", report->dropped), arguments.output});

  Answer answer;
  answer.json = {{"output", arguments.output}, {"points", report->points},   {"dropped", report->dropped},
                 {"parts", report->parts},     {"resumed_scans", report->kept}, {"seconds", report->seconds},
                 {"points_per_second", report->pointsPerSecond}, {"warnings", nlohmann::ordered_json::array()}};
  answer.text = fmt::format("{}: {} points, {} in all, {:.1f} s, {:.2f} Mpts/s\n", arguments.output, report->points,
                            report->parts == 1 ? "1 part" : fmt::format("{} parts", report->parts), report->seconds,
                            report->pointsPerSecond / 1e6);
  for (const ImportWarning& warning : warnings) {
    answer.json["warnings"].push_back(warning.what + " (" + warning.where + ")");
    answer.text += fmt::format("  warning  {} ({})\n", warning.what, warning.where);
  }
  return answer;
}

}  // namespace

void addIndex(Verbs& verbs) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add("index", "Make a point store of scans, or add scans to one",
                                [arguments](const Progress& progress) { return index(*arguments, progress); });
  command->add_option("scans", arguments->scans, "Scans of any format that is read")->required();
  command->add_option("-o,--output", arguments->output, "The store: a folder, by custom NAME.alidade-points")->required();
  command->add_option("--memory", arguments->memory, "For the points at work: 512M, 2G")
      ->capture_default_str()
      ->check(checkedBy(parseMemory, "MEMORY"));
  command->add_option("--levels", arguments->levels, "How points thin out: evenly spaced, or by a random draw")
      ->capture_default_str()
      ->check(CLI::IsMember({"blue-noise", "random"}));
  command->add_option("--seed", arguments->seed, "Of the random draw")->capture_default_str();
  command->add_flag("--append", arguments->append, "Add to a store that exists");
}

}  // namespace alidade::cli

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>

#include <fmt/format.h>

#include "app/scan_conversion.h"
#include "cli/command.h"

namespace alidade::cli {

namespace {

namespace fs = std::filesystem;

Result<Answer> convert(const std::vector<std::string>& paths, const std::string& out, bool overwrite, const Progress& progress) {
  std::error_code ignored;
  if (!overwrite && fs::exists(out, ignored))
    return fail("The file exists already", out, "Name another one, or allow it with --overwrite");
  const auto written = convertScans(paths, out, progress);
  if (!written) return fail(written.error());
  Answer answer;
  const std::uint64_t bytes = fs::file_size(out, ignored);
  answer.json = {{"output", out}, {"format", written->format}, {"points", written->points},
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
  command->add_option("scans", arguments->inputs, "Scans of any format that is read, and point stores")->required();
  command->add_option("-o,--output", arguments->output, "The file: .las, .laz or .copc.laz")->required();
  command->add_flag("--overwrite", arguments->overwrite, "Replace the file where it exists");
}

}  // namespace alidade::cli

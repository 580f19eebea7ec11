// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ifc/ifc_reader.h"

#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "ifc/step_scanner.h"
#include "plugin_api/child_process.h"
#include "survey/design_stream.h"

namespace alidade {

namespace {

constexpr std::uint64_t kLargestFile = std::uint64_t{4} << 30;

Result<std::string> readText(const std::string& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code))
    return fail("The file does not exist or is no plain file", path);
  const std::uint64_t size = std::filesystem::file_size(path, code);
  if (code) return fail("The file cannot be read: " + code.message(), path);
  if (size == 0) return fail("The file is empty", path, "Copy or export it again");
  if (size > kLargestFile) return fail("The file is larger than 4 GiB", path, "Split the model by storey or trade");
  std::string text(size, '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(text.data(), static_cast<std::streamsize>(size)))
    return fail("The file cannot be read", path, "Check the permission to read it");
  return text;
}

Result<StepSummary> scanFile(const std::string& path, std::uint64_t& size) {
  const auto text = readText(path);
  if (!text) return fail(text.error());
  size = text->size();
  auto summary = scanStep(*text);
  if (!summary) return fail(summary.error().in(path));
  if (const auto known = checkSchema(summary->schema); !known) return fail(known.error().in(path));
  return summary;
}

}  // namespace

ReaderDescription IfcReader::description() const {
  return {"ifc", "IFC building model", {"ifc"}};
}

int IfcReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  if (probe.holds("ISO-10303-21")) {
    if (probe.holds("'IFC") || probe.holds("'ifc")) return 90;
    return probe.extension == "ifc" ? 80 : 10;
  }
  return probe.extension == "ifc" ? 30 : 0;
}

Result<DesignInfo> IfcReader::inspect(const std::string& path) const {
  std::uint64_t size = 0;
  const auto summary = scanFile(path, size);
  if (!summary) return fail(summary.error());
  DesignInfo info;
  info.schema = summary->schema;
  info.crs = summary->crsName;
  for (const auto& [entity, count] : summary->count)
    if (isDrawnProduct(entity)) info.elementCount += count;
  info.details = fmt::format("{}, {} products", info.schema, info.elementCount);
  if (const auto storeys = summary->count.find("IFCBUILDINGSTOREY"); storeys != summary->count.end())
    info.details += fmt::format(" on {} storeys", storeys->second);
  if (summary->count.contains("IFCMAPCONVERSION")) info.details += ", georeferenced";
  if (!summary->program.empty()) info.details += ", by " + summary->program;
  return info;
}

Result<DesignModel> IfcReader::read(const std::string& path, const Progress& progress,
                                    std::vector<ImportWarning>& warnings) const {
  std::uint64_t size = 0;
  const auto summary = scanFile(path, size);
  if (!summary) return fail(summary.error());

  ChildOptions options;
  options.helper = "alidade-ifc-convert";
  options.arguments = {path};
  options.inputName = path;
  options.purpose = "Reading " + std::filesystem::path(path).filename().string();
  scaleLimits(options, size, 400, 60);
  const auto bytes = runChild(options, progress);
  if (!bytes) return fail(bytes.error());
  auto stream = decodeDesign(*bytes);
  if (!stream) return fail(stream.error().in(path));
  for (ConversionNote& note : stream->notes) warnings.push_back({std::move(note.what), std::move(note.where)});
  stream->model.name = std::filesystem::path(path).stem().string();
  return std::move(stream->model);
}

}  // namespace alidade

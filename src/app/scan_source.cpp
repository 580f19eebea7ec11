// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/scan_source.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

namespace alidade {

namespace fs = std::filesystem;

namespace {

/// Empty where the file's state cannot be told (a web address): such work never goes on after a kill.
std::string identityOf(const std::string& path, const std::string& reader) {
  std::error_code error;
  const fs::path whole = fs::canonical(path, error);
  if (error || !fs::is_regular_file(whole, error)) return {};
  const auto size = fs::file_size(whole, error);
  if (error) return {};
  const auto time = fs::last_write_time(whole, error);
  if (error) return {};
  return fmt::format("{}|{}|{}|{}", reader, whole.string(), size, time.time_since_epoch().count());
}

void addOnce(const std::vector<ImportWarning>& found, std::vector<ImportWarning>& all) {
  for (const ImportWarning& warning : found) {
    const auto same = [&](const ImportWarning& other) { return other.what == warning.what && other.where == warning.where; };
    if (std::ranges::none_of(all, same)) all.push_back(warning);
  }
}

}  // namespace

ScanSource scanSourceOf(const ScanReader& reader, const std::string& path, const ScanInfo& info,
                        std::vector<ImportWarning>* warnings) {
  ScanSource source;
  source.name = path;
  source.identity = identityOf(path, reader.description().id);
  source.info = info;
  source.read = [&reader, path, warnings](const ScanSource::Sink& sink, const Progress& progress) -> Result<void> {
    const auto read = reader.read(path, sink, progress);
    if (!read) return fail(read.error());
    if (warnings != nullptr) addOnce(*read, *warnings);
    return {};
  };
  source.sample = [&reader, path](std::uint64_t wanted, const ScanSource::Sink& sink, const Progress& progress) {
    return reader.sample(path, wanted, sink, progress);
  };
  return source;
}

}  // namespace alidade

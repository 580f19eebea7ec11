// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Work on a point store that was cut short and is gone on with after its diary or its spilled points were damaged: either
// the store comes about, or an error says why.
//
// An input is damage: {u8 file, u32 place, u8 count, bytes} one after the other; no bytes cut the file off there.

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <unistd.h>

#include "cloud/store_folder.h"
#include "cloud/store_index.h"

namespace {

using namespace alidade;
namespace fs = std::filesystem;

constexpr std::uint32_t kPoints = 3000;
constexpr std::array<const char*, 2> kFiles = {"diary.tmp", "spill.tmp"};

/// In memory where there is such a place: the work waits for the disk again and again.
fs::path makeFolder() {
  std::string name = (fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path()) / "alidade_resume_fuzz_XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) std::abort();
  return name;
}

ScanSource source() {
  ScanSource scan;
  scan.name = "hill", scan.identity = "hill 1";
  scan.info.pointCount = kPoints;
  scan.info.scale = glm::dvec3(0.001);
  scan.info.bounds.add(glm::dvec3(0)), scan.info.bounds.add(glm::dvec3(90, 90, 2));
  scan.read = [](const ScanSource::Sink& sink, const Progress&) -> Result<void> {
    PointBatch batch;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const std::uint32_t x = i * 7919 % 90000, y = i * 104729 % 90000;
      batch.position.push_back(glm::dvec3(0.001) * glm::dvec3(x, y, (x ^ y) % 2000));
      batch.intensity.push_back(static_cast<std::uint16_t>(i));
    }
    sink(batch);
    return {};
  };
  return scan;
}

Result<IndexReport> index(const fs::path& store, const Progress& progress) {
  const ScanSource scan = source();
  IndexOptions options;
  options.memoryBytes = 1;  // nothing fits: all of it is spilled
  options.threads = 1;
  return indexScans(std::span(&scan, 1), store, options, progress);
}

struct Workplace {
  fs::path folder = makeFolder(), cut = folder / "cut", store = folder / "store";
  Workplace() {
    Progress progress;
    progress = Progress([&progress](double fraction, std::string_view) {
      if (fraction > 0.41) progress.cancel();
    });
    if (index(cut, progress)) std::abort();
    for (const char* file : kFiles)
      if (!fs::exists(cut / "part-0001.partial" / file)) std::abort();
  }
  ~Workplace() { fs::remove_all(folder); }
};

void damage(const fs::path& work, const std::uint8_t* data, std::size_t size) {
  std::array<std::vector<char>, kFiles.size()> contents;
  for (std::size_t f = 0; f < kFiles.size(); ++f) {
    std::ifstream file(work / kFiles[f], std::ios::binary);
    contents[f].assign(std::istreambuf_iterator<char>(file), {});
  }
  for (std::size_t at = 0; at + 6 <= size;) {
    std::vector<char>& file = contents[data[at] % kFiles.size()];
    std::uint32_t place;
    std::memcpy(&place, data + at + 1, sizeof place);
    const std::size_t count = std::min<std::size_t>(data[at + 5], size - at - 6), first = file.empty() ? 0 : place % file.size();
    if (count == 0) file.resize(first);
    else std::memcpy(file.data() + first, data + at + 6, std::min(count, file.size() - first));
    at += 6 + count;
  }
  for (std::size_t f = 0; f < kFiles.size(); ++f) {
    std::ofstream file(work / kFiles[f], std::ios::binary | std::ios::trunc);
    file.write(contents[f].data(), static_cast<std::streamsize>(contents[f].size()));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Workplace workplace;
  fs::remove_all(workplace.store);
  fs::copy(workplace.cut, workplace.store, fs::copy_options::recursive);
  damage(workplace.store / "part-0001.partial", data, size);
  const auto report = index(workplace.store, Progress());
  if (!report && report.error().what.empty()) std::abort();
  if (!report) return 0;
  const auto opened = openStore(workplace.store);
  if (!opened || opened->parts[0].points->pointCount() != kPoints) std::abort();
  return 0;
}

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// LAS and LAZ indexed from the file's own records, packed byte by byte, and once more from columns: what both put on one
// lattice is the same, byte for byte.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include "cloud/part_index.h"
#include "las/las_reader.h"

namespace {

using namespace alidade;

/// Columns in memory.
class Columns : public PartSink {
 public:
  Result<void> begin(std::uint64_t, const Lattice&, const PointSchema&, bool) override {
    m_columns.clear();
    return {};
  }
  Result<void> write(std::size_t column, std::uint64_t offset, std::span<const std::byte> bytes) override {
    std::lock_guard lock(m_mutex);
    auto& to = m_columns[column];
    to.resize(std::max<std::size_t>(to.size(), offset + bytes.size()));
    std::copy(bytes.begin(), bytes.end(), to.begin() + static_cast<std::ptrdiff_t>(offset));
    return {};
  }
  Result<void> read(std::size_t column, std::uint64_t offset, std::span<std::byte> into) override {
    std::lock_guard lock(m_mutex);
    const auto& from = m_columns[column];
    if (offset > from.size() || into.size() > from.size() - offset) std::abort();
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(offset), into.size(), into.begin());
    return {};
  }
  friend bool operator==(const Columns& a, const Columns& b) { return a.m_columns == b.m_columns; }

 private:
  std::mutex m_mutex;
  std::map<std::size_t, std::vector<std::byte>> m_columns;
};

Result<PartTree> index(const std::string& path, const ScanInfo& info, bool byRecords, Columns& columns) {
  const LasReader reader;
  ScanSource source;
  source.name = path;
  source.info = info;
  const auto outcomeOf = [](const auto& read) -> Result<void> { return read ? Result<void>() : fail(read.error()); };
  source.read = [&](const ScanSource::Sink& sink, const Progress& progress) { return outcomeOf(reader.read(path, sink, progress)); };
  source.sample = [&](std::uint64_t wanted, const ScanSource::Sink& sink, const Progress& progress) { return reader.sample(path, wanted, sink, progress); };
  if (byRecords)
    source.readRecords = [&](const RecordSink& sink, const Progress& progress) -> Result<bool> {
      const auto read = reader.readRecords(path, sink, progress);
      if (!read) return fail(read.error());
      return read->has_value();
    };
  PartOptions options;
  options.cellPoints = 100;
  return indexPart(source, options, columns, Progress());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int descriptor = ::memfd_create("fuzz", 0);
  if (descriptor < 0 || ::write(descriptor, data, size) != static_cast<ssize_t>(size)) std::abort();
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  const auto info = LasReader().inspect(path);
  if (info && info->pointCount <= 100'000) {
    Columns packed, columns;
    const auto fromRecords = index(path, *info, true, packed), fromColumns = index(path, *info, false, columns);
    if (fromRecords && fromRecords->pointCount + fromRecords->dropped > info->pointCount) std::abort();
    if (fromRecords && fromColumns && fromRecords->lattice == fromColumns->lattice && fromRecords->schema == fromColumns->schema &&
        !(packed == columns))
      std::abort();
  }
  ::close(descriptor);
  return 0;
}

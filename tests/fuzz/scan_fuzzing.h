// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "plugin_api/reader.h"

namespace alidade::testing {

/// Feeds the bytes to a scan reader as a file in memory and holds what it hands over to the
/// reader's promises; a broken one aborts.
inline void fuzzScanReader(const ScanReader& reader, const std::uint8_t* data, std::size_t size) {
  const int descriptor = ::memfd_create("fuzz", 0);
  if (descriptor < 0 || ::write(descriptor, data, size) != static_cast<ssize_t>(size)) std::abort();
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor);

  const auto info = reader.inspect(path);
  std::uint64_t count = 0;
  const auto outcome = reader.read(
      path,
      [&](const PointBatch& batch) {
        count += batch.size();
        const auto fits = [&](const auto& column) { return column.empty() || column.size() == batch.size(); };
        const bool good = batch.size() <= 100000 && fits(batch.rgb) && fits(batch.intensity) &&
                          fits(batch.classification) && fits(batch.returnNumber) && fits(batch.gpsTime) &&
                          fits(batch.returnCount) && fits(batch.normal) && fits(batch.scanner) &&
                          fits(batch.pointSource) && fits(batch.row) && fits(batch.column);
        if (!good) std::abort();
        for (const auto& p : batch.position)
          if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
        return true;
      },
      Progress());
  ::close(descriptor);
  // What cannot be inspected cannot be read, and no more points come than were announced.
  if (outcome && !info) std::abort();
  if (outcome && count > info->pointCount) std::abort();
  if (!outcome && outcome.error().what.empty()) std::abort();
}

/// The same for a reader with a way of its own to take a sample.
inline void fuzzScanSample(const ScanReader& reader, const std::uint8_t* data, std::size_t size) {
  const int descriptor = ::memfd_create("fuzz", 0);
  if (descriptor < 0 || ::write(descriptor, data, size) != static_cast<ssize_t>(size)) std::abort();
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  const auto outcome = reader.sample(path, 1000, [](PointBatch&) { return true; }, Progress());
  ::close(descriptor);
  if (!outcome && outcome.error().what.empty()) std::abort();
}

}  // namespace alidade::testing

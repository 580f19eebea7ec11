// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "plugin_api/reader.h"

namespace alidade::testing {

/// A file with these bytes, gone with the object.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& name, const std::string& content)
      : m_path((std::filesystem::temp_directory_path() / ("alidade_" + std::to_string(::getpid()) + "_" + name)).string()) {
    std::ofstream(m_path, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
  }
  ~TemporaryFile() { std::filesystem::remove(m_path); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return m_path; }

 private:
  std::string m_path;
};

/// All that a reader gave: points, warnings, or an error.
struct ScanReading {
  PointBatch all;
  std::string warnings;
  std::string error;
};

inline ScanReading readScan(const ScanReader& reader, const std::string& path) {
  ScanReading reading;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  const auto outcome = reader.read(
      path,
      [&](const PointBatch& batch) {
        append(reading.all.position, batch.position);
        append(reading.all.rgb, batch.rgb);
        append(reading.all.intensity, batch.intensity);
        append(reading.all.classification, batch.classification);
        append(reading.all.gpsTime, batch.gpsTime);
        append(reading.all.normal, batch.normal);
        append(reading.all.row, batch.row);
        append(reading.all.column, batch.column);
        return true;
      },
      Progress());
  if (!outcome) {
    reading.error = outcome.error().text();
    return reading;
  }
  for (const auto& warning : *outcome) reading.warnings += warning.what + "\n";
  return reading;
}

/// The bytes of a number in either order, for files made by hand.
template <class T>
std::string bytesOf(T value, bool bigEndian = false) {
  std::string raw(sizeof(T), '\0');
  std::memcpy(raw.data(), &value, sizeof(T));
  if (bigEndian) raw.assign(raw.rbegin(), raw.rend());
  return raw;
}

}  // namespace alidade::testing

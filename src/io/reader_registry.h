// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "plugin_api/reader.h"
#include "plugin_api/scan_writer.h"

namespace alidade {

/// All readers and writers that the plugins bring. Loaded once, then read-only and thread-safe.
class ReaderRegistry {
 public:
  /// The process's registry. The first call loads every plugin from ALIDADE_PLUGIN_PATH, from
  /// ../lib/alidade/plugins beside the program, and from the installed place, in this order.
  static const ReaderRegistry& instance();

  ReaderRegistry() = default;
  ReaderRegistry(const ReaderRegistry&) = delete;
  ReaderRegistry& operator=(const ReaderRegistry&) = delete;
  ~ReaderRegistry();

  void loadFolder(const std::string& folder);
  void add(std::unique_ptr<Reader> reader);

  void add(std::unique_ptr<ScanWriter> writer);

  const std::vector<std::unique_ptr<Reader>>& readers() const { return m_readers; }
  const std::vector<std::unique_ptr<ScanWriter>>& writers() const { return m_writers; }

  /// The writer of the format that the path's name asks for. The error says what formats are written.
  Result<const ScanWriter*> findWriter(const std::string& path) const;

  /// The reader that claims the file, of any kind. The error says what formats are read.
  Result<const Reader*> find(const std::string& path) const;

  /// The same, of the kind R::kind() wanted: ScanReader, DesignReader, CameraReader, PictureReader,
  /// PointListReader.
  template <class R>
  Result<const R*> findAs(const std::string& path) const {
    auto found = findKind(path, kindOf<R>());
    if (!found) return fail(found.error());
    return static_cast<const R*>(*found);
  }

  /// Where no plugin could be loaded: one error a library that failed.
  const std::vector<Error>& loadErrors() const { return m_loadErrors; }

 private:
  Result<const Reader*> findKind(const std::string& path, ReaderKind kind) const;

  template <class R>
  static constexpr ReaderKind kindOf();

  std::vector<std::unique_ptr<Reader>> m_readers;
  std::vector<std::unique_ptr<ScanWriter>> m_writers;
  std::vector<Error> m_loadErrors;
};

template <> constexpr ReaderKind ReaderRegistry::kindOf<ScanReader>() { return ReaderKind::Scan; }
template <> constexpr ReaderKind ReaderRegistry::kindOf<DesignReader>() { return ReaderKind::Design; }
template <> constexpr ReaderKind ReaderRegistry::kindOf<CameraReader>() { return ReaderKind::Cameras; }
template <> constexpr ReaderKind ReaderRegistry::kindOf<PictureReader>() { return ReaderKind::Pictures; }
template <> constexpr ReaderKind ReaderRegistry::kindOf<PointListReader>() { return ReaderKind::Points; }

/// Opens the start of a file or looks at a folder. Error where it does not exist or cannot be read. Of a web
/// address (http, https) nothing is asked: its ending alone decides who reads it.
Result<FileProbe> probeFile(const std::string& path, std::vector<std::byte>& headStorage);

}  // namespace alidade

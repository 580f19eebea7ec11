// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// LAS 1.0 to 1.4 and LAZ of every kind (in one piece, in chunks, in layers), point formats 0-10.
///
/// Coordinates are `scale * integer + offset` in double; las_points.h says where every other field goes. Colours
/// are 16 bits a channel in the standard; a file whose colours never exceed 255 stored 8 bits.
///
/// Malformed input: refused where points would be wrong or missing (truncated, counts past the end,
/// impossible scale or record length, chunks that end early); repaired with a warning where only a description suffers
/// (bad VLRs, bad bounds, a disagreeing legacy count). A compressed file whose chunk table is missing
/// is decoded from its start.
class LasReader : public ScanReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<ScanInfo> inspect(const std::string& path) const override;
  Result<ScanNotes> notes(const std::string& path) const override;
  Result<std::vector<ImportWarning>> read(const std::string& path,
                                          const BatchSink& sink,
                                          const Progress& progress) const override;
  bool readsAnyOrder() const override { return true; }
  Result<std::vector<ImportWarning>> readAnyOrder(const std::string& path, const NumberedSink& sink,
                                                  const Progress& progress) const override;
  Result<std::optional<std::vector<ImportWarning>>> readRecords(const std::string& path, const RecordSink& sink,
                                                                const Progress& progress) const override;
  /// Short blocks of a LAS file, the beginnings of a LAZ file's chunks.
  Result<void> sample(const std::string& path, std::uint64_t wanted, const BatchSink& sink,
                      const Progress& progress) const override;
};

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/scan_writer.h"

namespace alidade {

/// LAS, LAZ and COPC. The point format follows the columns (las_schema.h); integers are the source's own where its
/// scale and offset are given. LAS 1.2 with GeoTIFF keys where that is enough, else 1.4 with the CRS as WKT.
class LasFormatWriter : public ScanWriter {
 public:
  enum class Kind { Las, Laz, Copc };
  explicit LasFormatWriter(Kind kind) : m_kind(kind) {}

  ReaderDescription description() const override;
  bool writes(const std::string& path) const override;
  bool isTree() const override { return m_kind == Kind::Copc; }
  Result<std::unique_ptr<ScanSink>> create(const std::string& path, const ScanWriteOptions& options) const override;

 private:
  Kind m_kind;
};

}  // namespace alidade

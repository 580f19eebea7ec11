// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"
#include "text-scan/row_file.h"

namespace alidade {

/// Lists of points as rows of numbers, of any size in bounded memory. What the columns mean is told by a
/// header ("x;y;z;intensity;r;g;b"), by a remark before the points ("//X Y Z R G B", "# columns: x y z - r g b", where - leaves
/// one out), or else guessed from count and ranges; the import warnings say how each one was understood.
///
/// Refused, with the line: what is no number, rows of different lengths, a file that ends before the number of
/// points that it promises. Tolerated: empty lines, remarks (# and //), more points than promised (with a warning). Points
/// whose coordinates are not finite are left out and counted.
class RowScanReader : public ScanReader {
 public:
  Result<ScanInfo> inspect(const std::string& path) const override;
  Result<std::vector<ImportWarning>> read(const std::string& path, const BatchSink& sink, const Progress& progress) const override;

 protected:
  virtual RowDialect dialect() const = 0;
};

/// Leica's PTS: a count, then rows of x y z, x y z i, x y z r g b or x y z i r g b; several such blocks in
/// one file. Intensities from -2048 to 2047, or from 0.
class PtsReader : public RowScanReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;

 protected:
  RowDialect dialect() const override { return RowDialect::Pts; }
};

/// XYZ, ASC, TXT and CSV: numbers between blanks, tabs, commas or semicolons, decimal commas where they
/// cannot be anything else.
class XyzReader : public RowScanReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;

 protected:
  RowDialect dialect() const override { return RowDialect::Xyz; }
};

}  // namespace alidade

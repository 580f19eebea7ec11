// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// LAS, LAZ and COPC: all points, then a sample, which for COPC goes by the hierarchy.

#include "las/las_reader.h"

#include "fuzz/scan_fuzzing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  alidade::testing::fuzzScanReader(alidade::LasReader(), data, size);
  alidade::testing::fuzzScanSample(alidade::LasReader(), data, size);
  return 0;
}

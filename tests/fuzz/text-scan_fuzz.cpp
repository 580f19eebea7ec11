// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "fuzz/scan_fuzzing.h"
#include "text-scan/ptx_reader.h"
#include "text-scan/row_scan_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  alidade::testing::fuzzScanReader(alidade::PtxReader(), data, size);
  alidade::testing::fuzzScanReader(alidade::PtsReader(), data, size);
  alidade::testing::fuzzScanReader(alidade::XyzReader(), data, size);
  return 0;
}

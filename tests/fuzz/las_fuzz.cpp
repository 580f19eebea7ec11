// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_reader.h"

#include "fuzz/scan_fuzzing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  alidade::testing::fuzzScanReader(alidade::LasReader(), data, size);
  return 0;
}

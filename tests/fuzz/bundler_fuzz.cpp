// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bundler/bundler_reader.h"

#include <cstdint>

#include "fuzz/camera_fuzzing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  alidade::testing::checkCameraSet(alidade::parseBundler(text, "fuzz.out", alidade::Progress()), size);
  alidade::testing::checkCameraSet(alidade::parseBal(text, "fuzz.txt", alidade::Progress()), size);
  return 0;
}

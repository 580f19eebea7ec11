// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "metashape/metashape_reader.h"

#include <cstdint>

#include "fuzz/camera_fuzzing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  alidade::testing::checkCameraSet(alidade::parseMetashape(text, "fuzz.xml", alidade::Progress()), size);
  return 0;
}

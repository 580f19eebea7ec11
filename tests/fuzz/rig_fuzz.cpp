// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/rig_file.h"

#include <cstdint>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto rig = alidade::parseRig(std::string(reinterpret_cast<const char*>(data), size), "fuzz.json");
  if (!rig) {
    if (rig.error().what.empty()) std::abort();
    return 0;
  }
  for (const auto& camera : rig->cameras)
    if (camera.sensorFromCamera && !camera.sensorFromCamera->isFinite()) std::abort();
  return 0;
}

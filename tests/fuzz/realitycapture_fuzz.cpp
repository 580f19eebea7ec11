// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "realitycapture/xmp_reader.h"

#include <cstdint>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto camera = alidade::parseXmp(text, "fuzz.xmp", glm::ivec2(640, 480));
  if (!camera) {
    if (camera.error().what.empty()) std::abort();
    return 0;
  }
  if (camera->cameraFromWorld && !camera->cameraFromWorld->isFinite()) std::abort();
  if (camera->intrinsics && !camera->intrinsics->validate()) std::abort();
  if (!camera->intrinsics && camera->noIntrinsics.empty()) std::abort();
  return 0;
}

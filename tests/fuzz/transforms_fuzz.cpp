// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "transforms/transforms_reader.h"

#include <cstdint>

#include "fuzz/camera_fuzzing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto size64 = [](const std::string&) { return std::optional(glm::ivec2(64, 48)); };
  alidade::testing::checkCameraSet(alidade::parseTransforms(text, "fuzz.json", size64), size);
  return 0;
}

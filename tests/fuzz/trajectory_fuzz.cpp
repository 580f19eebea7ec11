// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdint>

#include "fuzz/camera_fuzzing.h"
#include "trajectory/euroc_reader.h"
#include "trajectory/pose_table_reader.h"
#include "trajectory/tum_trajectory_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  alidade::testing::checkCameraSet(alidade::parseTumTrajectory(text, "fuzz.txt", alidade::Progress()), size);
  alidade::testing::checkCameraSet(alidade::parseEuroc(text, "fuzz.csv", alidade::Progress()), size);
  alidade::testing::checkCameraSet(alidade::parsePoseTable(text, "fuzz.csv", alidade::Progress()), size);
  return 0;
}

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "opencv-calib/euroc_sensor_reader.h"
#include "opencv-calib/opencv_calibration_reader.h"

#include <cstdint>

#include "fuzz/camera_fuzzing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  // The ending decides nothing but the wording; both are in the field.
  alidade::testing::checkCameraSet(alidade::parseOpenCvCalibration(text, "fuzz.yml"), size);
  alidade::testing::checkCameraSet(alidade::parseOpenCvCalibration(text, "fuzz.xml"), size);
  alidade::testing::checkCameraSet(alidade::parseEurocCamera(text, "sensor.yaml"), size);
  return 0;
}

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <QObject>

#include "opencv-calib/euroc_sensor_reader.h"
#include "opencv-calib/opencv_calibration_reader.h"
#include "plugin_api/reader_plugin.h"

class OpenCvCalibrationPlugin : public QObject, public alidade::ReaderPlugin {
  Q_OBJECT
  Q_PLUGIN_METADATA(IID ALIDADE_READER_PLUGIN_IID)
  Q_INTERFACES(alidade::ReaderPlugin)

 public:
  std::vector<std::unique_ptr<alidade::Reader>> readers() const override {
    std::vector<std::unique_ptr<alidade::Reader>> all;
    all.push_back(std::make_unique<alidade::OpenCvCalibrationReader>());
    all.push_back(std::make_unique<alidade::EurocSensorReader>());
    return all;
  }
};

#include "plugin.moc"

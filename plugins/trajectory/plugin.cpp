// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <QObject>

#include "plugin_api/reader_plugin.h"
#include "trajectory/euroc_reader.h"
#include "trajectory/pose_table_reader.h"
#include "trajectory/tum_trajectory_reader.h"

class TrajectoryPlugin : public QObject, public alidade::ReaderPlugin {
  Q_OBJECT
  Q_PLUGIN_METADATA(IID ALIDADE_READER_PLUGIN_IID)
  Q_INTERFACES(alidade::ReaderPlugin)

 public:
  std::vector<std::unique_ptr<alidade::Reader>> readers() const override {
    std::vector<std::unique_ptr<alidade::Reader>> all;
    all.push_back(std::make_unique<alidade::TumTrajectoryReader>());
    all.push_back(std::make_unique<alidade::EurocReader>());
    all.push_back(std::make_unique<alidade::PoseTableReader>());
    return all;
  }
};

#include "plugin.moc"

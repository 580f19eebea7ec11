// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <QObject>

#include "las/las_reader.h"
#include "las/las_writer.h"
#include "plugin_api/reader_plugin.h"

namespace alidade {

class LasPlugin : public QObject, public ReaderPlugin {
  Q_OBJECT
  Q_PLUGIN_METADATA(IID ALIDADE_READER_PLUGIN_IID)
  Q_INTERFACES(alidade::ReaderPlugin)

 public:
  std::vector<std::unique_ptr<Reader>> readers() const override {
    std::vector<std::unique_ptr<Reader>> all;
    all.push_back(std::make_unique<LasReader>());
    return all;
  }
  std::vector<std::unique_ptr<ScanWriter>> writers() const override {
    std::vector<std::unique_ptr<ScanWriter>> all;
    for (const auto kind : {LasFormatWriter::Kind::Las, LasFormatWriter::Kind::Laz, LasFormatWriter::Kind::Copc})
      all.push_back(std::make_unique<LasFormatWriter>(kind));
    return all;
  }
};

}  // namespace alidade

#include "plugin.moc"

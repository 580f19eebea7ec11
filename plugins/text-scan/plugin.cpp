// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <QObject>

#include "plugin_api/reader_plugin.h"
#include "text-scan/ptx_reader.h"
#include "text-scan/row_scan_reader.h"

namespace alidade {

class TextScanPlugin : public QObject, public ReaderPlugin {
  Q_OBJECT
  Q_PLUGIN_METADATA(IID ALIDADE_READER_PLUGIN_IID)
  Q_INTERFACES(alidade::ReaderPlugin)

 public:
  std::vector<std::unique_ptr<Reader>> readers() const override {
    std::vector<std::unique_ptr<Reader>> all;
    all.push_back(std::make_unique<PtxReader>());
    all.push_back(std::make_unique<PtsReader>());
    all.push_back(std::make_unique<XyzReader>());
    return all;
  }
};

}  // namespace alidade

#include "plugin.moc"

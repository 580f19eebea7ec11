// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <QObject>

#include "e57/e57_image_readers.h"
#include "e57/e57_reader.h"
#include "plugin_api/reader_plugin.h"

namespace alidade {

class E57Plugin : public QObject, public ReaderPlugin {
  Q_OBJECT
  Q_PLUGIN_METADATA(IID ALIDADE_READER_PLUGIN_IID)
  Q_INTERFACES(alidade::ReaderPlugin)

 public:
  std::vector<std::unique_ptr<Reader>> readers() const override {
    std::vector<std::unique_ptr<Reader>> all;
    all.push_back(std::make_unique<E57Reader>());
    all.push_back(std::make_unique<E57CameraReader>());
    all.push_back(std::make_unique<E57PictureReader>());
    return all;
  }
};

}  // namespace alidade

#include "plugin.moc"

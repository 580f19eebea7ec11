// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <vector>

#include <QtPlugin>

#include "plugin_api/reader.h"
#include "plugin_api/scan_writer.h"

namespace alidade {

/// What a plugin library hands over: its readers, and its writers where it has any. The number in the interface id is the version of
/// this folder; io/ loads no other.
class ReaderPlugin {
 public:
  virtual ~ReaderPlugin() = default;
  virtual std::vector<std::unique_ptr<Reader>> readers() const = 0;
  virtual std::vector<std::unique_ptr<ScanWriter>> writers() const { return {}; }
};

}  // namespace alidade

#define ALIDADE_READER_PLUGIN_IID "org.alidade.ReaderPlugin/5"
Q_DECLARE_INTERFACE(alidade::ReaderPlugin, ALIDADE_READER_PLUGIN_IID)

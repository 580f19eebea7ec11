// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// A folder of pictures (PNG, JPEG, TIFF, BMP, WebP; not its subfolders) or one picture file. Other
/// files in the folder are passed over, hidden ones too. Pictures stand in natural order: img2
/// before img10. They have no times.
class PictureFolderReader : public PictureReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<PictureSetInfo> inspect(const std::string& path) const override;
  Result<std::unique_ptr<PictureSource>> open(const std::string& path) const override;
};

/// "img2" before "img10": runs of digits compare by value, the rest by letter without case; equal
/// names by their bytes, so that the order is total.
bool naturallyLess(std::string_view a, std::string_view b);

}  // namespace alidade

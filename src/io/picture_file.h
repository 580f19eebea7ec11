// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <map>
#include <string>

#include "base/error.h"
#include "base/image.h"

namespace alidade {

/// Decodes PNG, JPEG, TIFF … to 8-bit RGBA; gray becomes r = g = b. EXIF orientation is *not*
/// applied: calibrations refer to the sensor's own rows and columns.
Result<ColourImage> readPicture(const std::string& path);

/// Writes PNG with `text` as tEXt/iTXt chunks. Atomic: a full disk leaves no half file.
Result<void> writePng(const ColourImage& image, const std::string& path,
                      const std::map<std::string, std::string>& text = {});

/// The text chunks of a PNG, for reading a picture's own data back.
Result<std::map<std::string, std::string>> readPngText(const std::string& path);

}  // namespace alidade

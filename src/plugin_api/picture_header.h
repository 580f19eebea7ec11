// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/image.h"

namespace alidade {

// What is known of a picture file before a decoder may touch it, and how decoded samples become
// Alidade's pixels. Free of any decoder library: io/ and the picture plugin share it.

enum class PictureFormat { None, Png, Jpeg, Tiff, Bmp, WebP };

/// By its first bytes (12 are enough), whatever the file is called.
PictureFormat pictureFormatOf(std::span<const std::byte> head);
std::string_view pictureFormatName(PictureFormat format);

/// True for "png", "jpg", "jpeg", "tif", "tiff", "bmp" and "webp" (lower case, without the dot).
bool isPictureExtension(std::string_view extension);

struct PictureHeader {
  PictureFormat format = PictureFormat::None;
  int width = 0;   ///< pixels, as stored: EXIF orientation is not applied
  int height = 0;
};

/// Format and size from the header alone. Error where the file is no picture, is cut off, or
/// promises more pixels than any coding could keep in a file of its size.
Result<PictureHeader> readPictureHeader(const std::string& path);
/// The same for a picture that stands inside another file; `where` names it in errors.
Result<PictureHeader> pictureHeaderOf(std::span<const std::byte> bytes, const std::string& where);

/// Decoders paint the missing part of a cut-off JPEG gray and call it success: this walks the
/// segments up to the end-of-image marker. True for other formats, whose decoders notice.
Result<void> checkPictureComplete(const std::string& path, const PictureHeader& header);
Result<void> checkPictureComplete(std::span<const std::byte> bytes, const std::string& where, const PictureHeader& header);

/// Decoded samples as a library hands them over: interleaved rows, 8 or 16 bits, blue first.
struct RawPicture {
  const unsigned char* data = nullptr;
  std::size_t rowBytes = 0;
  int width = 0, height = 0;
  int channels = 3;          ///< 1 gray, 2 gray + alpha, 3 BGR, 4 BGRA
  int bytesPerChannel = 1;   ///< 1 or 2 (native order)
};

/// 8-bit RGBA: gray becomes r = g = b, 16 bits are scaled (65535 is 255), missing alpha is 255.
ColourImage colourImageFrom(const RawPicture& raw);

}  // namespace alidade

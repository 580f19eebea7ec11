// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/picture_file.h"

#include <exception>

#include <opencv2/imgcodecs.hpp>

#include "plugin_api/picture_header.h"

namespace alidade {

Result<ColourImage> readPicture(const std::string& path) {
  const auto header = readPictureHeader(path);
  if (!header) return fail(header.error());
  if (auto complete = checkPictureComplete(path, *header); !complete) return fail(complete.error());
  try {
    // UNCHANGED keeps 16 bits and alpha, and leaves the EXIF orientation alone.
    const cv::Mat decoded = cv::imread(path, cv::IMREAD_UNCHANGED);
    const std::string format(pictureFormatName(header->format));
    if (decoded.empty())
      return fail("The " + format + " picture cannot be decoded: it is cut off, damaged or of an unknown kind", path,
                  "Copy the file again or save it anew as PNG or JPEG");
    if (decoded.depth() != CV_8U && decoded.depth() != CV_16U)
      return fail("The " + format + " picture holds floating-point or signed numbers", path, "Save it with 8 or 16 bits a channel");
    return colourImageFrom({decoded.data, decoded.step[0], decoded.cols, decoded.rows, decoded.channels(),
                            decoded.depth() == CV_16U ? 2 : 1});
  } catch (const std::exception& error) {
    return fail(std::string("The picture cannot be decoded: ") + error.what(), path, "Copy the file again");
  }
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/png_file.h"

#include <vector>

#include <png.h>

#include "simulate/output_file.h"

namespace alidade {

Result<void> writePng(const std::string& path, const ColourImage& image, bool colour) {
  const int channels = colour ? 3 : 1;
  std::vector<png_byte> pixels;
  pixels.reserve(image.size() * channels);
  for (std::size_t i = 0; i < image.size(); ++i) {
    const Rgba8& c = image.data()[i];
    pixels.push_back(c.r);
    if (colour) pixels.insert(pixels.end(), {c.g, c.b});
  }
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width());
  header.height = static_cast<png_uint_32>(image.height());
  header.format = colour ? PNG_FORMAT_RGB : PNG_FORMAT_GRAY;
  // Noise hardly packs: the fast setting costs a few percent of size and saves most of the time.
  header.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<char> file(size);
  if (!png_image_write_to_memory(&header, file.data(), &size, 0, pixels.data(), 0, nullptr))
    return fail(std::string("The picture cannot be packed: ") + header.message, path);
  return writeWholeFile(path, {file.data(), size});
}

}  // namespace alidade

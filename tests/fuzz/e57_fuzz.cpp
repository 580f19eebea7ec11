// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/e57_reader.h"

#include <string>

#include "e57/crc32c.h"
#include "e57/e57_image_readers.h"
#include "fuzz/camera_fuzzing.h"
#include "fuzz/scan_fuzzing.h"

namespace {

/// The same bytes with right checksums: else no mutation would get past them.
std::string withChecksums(std::string file) {
  for (std::size_t page = 0; page + 1024 <= file.size(); page += 1024) {
    const auto sum = alidade::crc32c(std::as_bytes(std::span(file).subspan(page, 1020)));
    for (std::size_t i = 0; i < 4; ++i) file[page + 1020 + i] = static_cast<char>(sum >> (24 - 8 * i) & 255);
  }
  return file;
}

void fuzzPictures(const std::string& bytes) {
  const int descriptor = ::memfd_create("fuzz", 0);
  if (descriptor < 0 || ::write(descriptor, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  alidade::testing::checkCameraSet(alidade::E57CameraReader().inspect(path), bytes.size());
  if (const auto source = alidade::E57PictureReader().open(path))
    if (const auto picture = (*source)->picture(0); !picture && picture.error().what.empty()) std::abort();
  ::close(descriptor);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  alidade::testing::fuzzScanReader(alidade::E57Reader(), data, size);
  const std::string mended = withChecksums(std::string(reinterpret_cast<const char*>(data), size));
  alidade::testing::fuzzScanReader(alidade::E57Reader(), reinterpret_cast<const std::uint8_t*>(mended.data()), mended.size());
  fuzzPictures(mended);
  return 0;
}

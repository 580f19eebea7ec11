// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// The three files of a model in one input: as text with form feeds between them (cameras, images, points),
// as bytes each of the three after two bytes of length.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "colmap/colmap_model.h"
#include "fuzz/camera_fuzzing.h"

namespace {

using namespace alidade;

std::string_view takePart(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\f'), rest.size());
  const std::string_view part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return part;
}

Result<CameraSet> readModel(std::string_view rest, bool withFeatures) {
  const std::string_view cameras = takePart(rest), images = takePart(rest);
  ColmapModel model;
  if (auto done = parseColmapCameras(cameras, "cameras.txt", model); !done) return fail(done.error());
  if (auto done = parseColmapImages(images, "images.txt", withFeatures, Progress(), model); !done)
    return fail(done.error());
  if (withFeatures)
    if (auto done = parseColmapPoints(rest, "points3D.txt", Progress(), model); !done) return fail(done.error());
  return model.take();
}

std::span<const std::byte> takeBytes(std::span<const std::byte>& rest) {
  if (rest.size() < 2) return {};
  const std::size_t wanted = std::to_integer<std::size_t>(rest[0]) | std::to_integer<std::size_t>(rest[1]) << 8;
  rest = rest.subspan(2);
  const auto part = rest.first(std::min(wanted, rest.size()));
  rest = rest.subspan(part.size());
  return part;
}

Result<CameraSet> readBinary(std::span<const std::byte> rest, bool withFeatures) {
  const auto cameras = takeBytes(rest), images = takeBytes(rest);
  ColmapModel model;
  if (auto done = parseColmapBinaryCameras(cameras, "cameras.bin", model); !done) return fail(done.error());
  if (auto done = parseColmapBinaryImages(images, "images.bin", withFeatures, Progress(), model); !done)
    return fail(done.error());
  if (withFeatures)
    if (auto done = parseColmapBinaryPoints(rest, "points3D.bin", Progress(), model); !done) return fail(done.error());
  return model.take();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  testing::checkCameraSet(readModel(text, false), size);
  testing::checkCameraSet(readModel(text, true), size);
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  testing::checkCameraSet(readBinary(bytes, false), size);
  testing::checkCameraSet(readBinary(bytes, true), size);
  return 0;
}

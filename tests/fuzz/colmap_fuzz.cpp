// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// The three files of a model in one input, form feeds between them: cameras, images, points.

#include <algorithm>
#include <cstdint>

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
  return std::move(model.set);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  testing::checkCameraSet(readModel(text, false), size);
  testing::checkCameraSet(readModel(text, true), size);
  return 0;
}

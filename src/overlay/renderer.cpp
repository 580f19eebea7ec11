// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "overlay/annotation_painter.h"
#include "overlay/picture_scaling.h"
#include "overlay/scan_painter.h"
#include "overlay/text_sprites.h"
#include "raster/occlusion.h"

namespace alidade {

namespace {

constexpr int kLargestEdgePx = 16384;

/// Pixels of each element by state, over bands of rows.
void countElements(OverlayPicture& picture, const IdImage& hiddenElement, std::uint32_t elementCount) {
  using Counts = std::array<std::uint64_t, 3>;
  std::vector<std::vector<Counts>> perWorker(workerCount());
  parallelFor(picture.element.size(), std::size_t{1} << 18,
              [&](std::size_t first, std::size_t last, int worker) {
                auto& counts = perWorker[worker];
                counts.resize(elementCount + 1, Counts{});
                for (std::size_t i = first; i < last; ++i) {
                  const std::uint32_t id = picture.element.data()[i];
                  const std::uint8_t state = picture.state.data()[i];
                  if (id != 0 && id <= elementCount && state < 3) ++counts[id][state];
                  const std::uint32_t behind = hiddenElement.empty() ? 0 : hiddenElement.data()[i];
                  if (behind != 0 && behind <= elementCount) ++counts[behind][1];
                }
              });
  std::uint32_t layer = 0;
  for (std::uint32_t id = 1; id <= elementCount; ++id) {
    while (layer + 1 < picture.firstElementOfLayer.size() && id - 1 >= picture.firstElementOfLayer[layer + 1])
      ++layer;
    ElementPixels pixels{layer, id - 1 - picture.firstElementOfLayer[layer], 0, 0, 0};
    for (const auto& counts : perWorker) {
      if (counts.empty()) continue;
      pixels.visible += counts[id][0];
      pixels.hidden += counts[id][1];
      pixels.unknown += counts[id][2];
    }
    if (pixels.visible + pixels.hidden + pixels.unknown > 0) picture.elements.push_back(pixels);
  }
}

Result<void> checkFrame(const FrameDescription& frame, int width, int height) {
  if (frame.camera.width() <= 0 || frame.camera.height() <= 0)
    return fail("The frame has no camera", {}, "Give the frame a calibrated camera");
  if (!frame.cameraFromWorld.isFinite())
    return fail("The frame's pose holds numbers that are not finite", {},
                "Import the pose again, or refine it");
  if (width <= 0 || height <= 0 || width > kLargestEdgePx || height > kLargestEdgePx)
    return fail(
        "A picture of " + std::to_string(width) + " × " + std::to_string(height) + " pixels cannot be drawn",
        {}, "Choose a size of 1 to " + std::to_string(kLargestEdgePx) + " pixels an edge");
  return {};
}

}  // namespace

struct OverlayRenderer::Impl {
  std::unique_ptr<OverlayDevice> device;
  ScanPainter scans;
  TextSprites texts;
  // The camera image at the result's size; the source is held so that its address stays its name.
  std::shared_ptr<const ColourImage> source;
  ColourImage scaled;

  const ColourImage* imageFor(const FrameDescription& frame, int width, int height);
};

/// Shrinking averages, on the CPU and once per image and size; enlarging is the device's stretch.
const ColourImage* OverlayRenderer::Impl::imageFor(const FrameDescription& frame, int width, int height) {
  if (!frame.image || frame.image->empty() || !frame.display.imagePass) return nullptr;
  const int sourceWidth = frame.image->width(), sourceHeight = frame.image->height();
  if (sourceWidth <= width && sourceHeight <= height) return frame.image.get();
  if (source != frame.image || scaled.width() > width || scaled.height() > height ||
      scaled.width() != std::min(width, sourceWidth) || scaled.height() != std::min(height, sourceHeight)) {
    scaled = shrunk(*frame.image, std::min(width, sourceWidth), std::min(height, sourceHeight));
    source = frame.image;
  }
  return &scaled;
}

Result<std::unique_ptr<OverlayRenderer>> OverlayRenderer::create() {
  auto device = createOverlayDevice();
  if (!device) return fail(device.error());
  return std::make_unique<OverlayRenderer>(std::move(*device));
}

OverlayRenderer::OverlayRenderer(std::unique_ptr<OverlayDevice> device) : m_impl(std::make_unique<Impl>()) {
  m_impl->device = std::move(device);
}

OverlayRenderer::~OverlayRenderer() = default;

std::string OverlayRenderer::deviceName() const {
  return m_impl->device->name();
}

Result<OverlayPicture> OverlayRenderer::render(const FrameDescription& frame) {
  const int width = frame.width > 0 ? frame.width : frame.camera.width();
  const int height = frame.height > 0 ? frame.height : frame.camera.height();
  if (auto ok = checkFrame(frame, width, height); !ok) return fail(ok.error());
  const bool isScaled = width != frame.camera.width() || height != frame.camera.height();
  const Camera camera = isScaled ? frame.camera.scaledTo(width, height) : frame.camera;

  ScanPictures scans = m_impl->scans.draw(frame, camera, m_impl->device->splatDevice());
  DrawList list = buildDrawList(frame, camera);
  list.image = m_impl->imageFor(frame, width, height);
  const bool hides = frame.display.depthPass && scans.chosen > 0;
  list.scanDepth = hides ? &scans.depth : nullptr;
  list.pointColour = scans.colour.empty() ? nullptr : &scans.colour;
  auto drawn = m_impl->device->draw(list);
  if (!drawn) return fail(drawn.error());

  OverlayPicture picture;
  picture.colour = std::move(drawn->colour);
  picture.designDepth = std::move(drawn->designDepth);
  picture.element = std::move(drawn->element);
  picture.state = std::move(drawn->state);
  picture.scanDepth = std::move(scans.depth);
  picture.pointsTotal = scans.total;
  picture.pointsDrawn = scans.drawn;
  picture.pointsJudged = scans.judged;
  picture.worstErrorPx = list.worstErrorPx;
  std::uint32_t elementCount = 0;
  for (const DesignLayer& layer : frame.designs) {
    picture.firstElementOfLayer.push_back(elementCount);
    if (layer.model) elementCount += static_cast<std::uint32_t>(layer.model->elements.size());
  }
  if (!frame.playing) countElements(picture, drawn->hiddenElement, elementCount);
  paintAnnotations(picture, frame, camera, m_impl->texts);
  return picture;
}

}  // namespace alidade

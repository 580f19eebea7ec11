// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "app/jobs.h"
#include "app/version.h"
#include "inspect/hit.h"
#include "io/picture_file.h"

namespace alidade {

double scanSpacing(const FrameDescription& frame) {
  double spacing = 0;
  for (const ScanLayer& scan : frame.scans) spacing = std::max(spacing, scan.points.store->medianSpacing());
  return spacing;
}

namespace {

std::string poseText(const Frame& frame) {
  std::string text;
  switch (frame.poseSource) {
    case PoseSource::None: text = "none"; break;
    case PoseSource::File: text = "as imported"; break;
    case PoseSource::Interpolated: text = "interpolated along the trajectory"; break;
    case PoseSource::Refined: text = "refined"; break;
  }
  if (frame.quality)
    text += fmt::format(", {} observations, rms {:.2f} px, ±{:.1f} mm", frame.quality->observations, frame.quality->rmsPx,
                        glm::length(frame.quality->positionStdM) * 1000.0);
  return text;
}

const char* hiddenStyleName(HiddenStyle style) {
  switch (style) {
    case HiddenStyle::Hide: return "not drawn";
    case HiddenStyle::Ghost: return "as ghost";
    case HiddenStyle::Dash: return "dashed";
  }
  return "";
}

/// Shares of the front-most design, pixel by pixel; what is buried behind it counts with its element only.
std::string drawnText(const OverlayPicture& picture, const DisplaySettings& display) {
  std::array<std::uint64_t, 4> pixels{};
  for (std::size_t i = 0; i < picture.state.size(); ++i) ++pixels[picture.state.data()[i] & 3];
  const auto visible = pixels[static_cast<int>(Visibility::Visible)], hidden = pixels[static_cast<int>(Visibility::Hidden)],
             unknown = pixels[static_cast<int>(Visibility::Unknown)];
  const double all = static_cast<double>(visible + hidden + unknown);
  if (!display.designPass) return "design switched off";
  if (all == 0) return "no design in this picture";
  if (!display.depthPass) return "scan occlusion switched off";
  return fmt::format("design {:.0f} % visible, {:.0f} % hidden ({}), {:.0f} % unknown", 100 * visible / all,
                     100 * hidden / all, hiddenStyleName(display.hidden), 100 * unknown / all);
}

/// Scale at the depth of whatever fills the middle of the picture; 0 where nothing does.
void giveScale(TitleBlock& title, const OverlayPicture& picture, const Camera& camera) {
  std::vector<float> depths;
  const int width = picture.scanDepth.width(), height = picture.scanDepth.height();
  for (int y = height * 2 / 5; y < height * 3 / 5; y += 3)
    for (int x = width * 2 / 5; x < width * 3 / 5; x += 3)
      if (const float z = picture.scanDepth.at(x, y); std::isfinite(z)) depths.push_back(z);
  if (depths.size() < 50) return;
  std::sort(depths.begin(), depths.end());
  const double low = depths[depths.size() / 10], high = depths[depths.size() * 9 / 10];
  // A bar holds for one depth; where the middle of the picture spans many it would mislead.
  if (high > 1.25 * low) return;
  title.scaleDepthM = depths[depths.size() / 2];
  title.metresPerPixelAtCentre = title.scaleDepthM / camera.intrinsics().fx;
}

TitleBlock titleOf(const Project& project, const Frame& frame, const CameraRecord& camera, const RenderedFrame& rendered) {
  TitleBlock title;
  const auto index = static_cast<std::size_t>(&frame - project.frames.data());
  const Intrinsics& in = camera.camera.intrinsics();
  title.project = project.name;
  title.frame = fmt::format("{} ({} of {})", frame.name, index + 1, project.frames.size());
  title.time = fmt::format("{:.2f} s", frame.timeSecs);
  title.camera = fmt::format("{}, {}, {} × {} px", camera.name, cameraModelName(in.model), in.width, in.height);
  title.poseSource = poseText(frame);
  const glm::dvec3 at = rendered.description.cameraFromWorld.centre();
  title.coordinates = fmt::format("E {:.3f}  N {:.3f}  H {:.3f} m", at.x, at.y, at.z);
  title.hidden = drawnText(rendered.picture, project.display);
  title.software = softwareName();
  giveScale(title, rendered.picture,
            rendered.description.camera.scaledTo(rendered.picture.colour.width(), rendered.picture.colour.height()));
  return title;
}

}  // namespace

Result<RenderedFrame> renderFrame(const Project& project, const LoadedData& data, FrameId frameId, const FrameWish& wish,
                                  OverlayRenderer& renderer, PictureCache& pictures) {
  const Frame* frame = project.findFrame(frameId);
  if (!frame) return fail("The project holds no such frame", project.path);
  std::shared_ptr<const ColourImage> image;
  if (project.display.imagePass) {
    auto decoded = pictures.picture(project, *frame);
    if (!decoded) return fail(decoded.error());
    image = std::move(*decoded);
  }
  auto description = describeFrame(project, data, frameId, std::move(image), wish.selection);
  if (!description) return fail(description.error());
  description->width = wish.width;
  description->height = wish.height;
  description->pointBudget = wish.pointBudget;

  RenderedFrame rendered;
  rendered.description = std::move(*description);
  auto picture = renderer.render(rendered.description);
  if (!picture) return fail(picture.error());
  rendered.picture = std::move(*picture);
  rendered.poseQuality = frame->quality;
  rendered.scanSpacingM = scanSpacing(rendered.description);
  rendered.title = titleOf(project, *frame, *project.findCamera(frame->camera), rendered);
  return rendered;
}

Result<void> exportPicture(const RenderedFrame& frame, const std::string& path, bool bare) {
  const auto text = titleText(frame.title);
  if (bare) return writePng(frame.picture.colour, path, text);
  return writePng(withTitleBlock(frame.picture.colour, frame.title), path, text);
}

CursorReadout readoutAt(const RenderedFrame& frame, const glm::dvec2& pixel) {
  CursorReadout readout;
  const DepthImage& depth = frame.picture.scanDepth;
  if (depth.empty()) return readout;
  const Camera camera = frame.description.camera.scaledTo(depth.width(), depth.height());
  const RigidTransform pose = frame.description.shutter.poseAtRow(frame.description.cameraFromWorld, pixel.y, depth.height());
  const auto hit = hitAt(depth, camera, pose, pixel, {frame.poseQuality, frame.scanSpacingM});
  if (!hit) return readout;
  readout.world = hit->world;
  readout.depthM = hit->depthM;
  readout.distanceM = hit->distanceM;
  readout.uncertaintyM = hit->sigmaM;
  return readout;
}

}  // namespace alidade

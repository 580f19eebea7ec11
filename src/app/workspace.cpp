// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/workspace.h"

#include <algorithm>
#include <unordered_set>

#include "app/observing.h"
#include "app/pose_clock.h"
#include "app/scan_loading.h"
#include "io/reader_registry.h"

namespace alidade {

namespace {

Result<std::shared_ptr<const DesignModel>> loadDesign(const Design& design, std::vector<ImportWarning>& warnings,
                                                      const Progress& progress) {
  const auto reader = ReaderRegistry::instance().findAs<DesignReader>(design.source.path);
  if (!reader) return fail(reader.error());
  auto model = (*reader)->read(design.source.path, progress, warnings);
  if (!model) return fail(model.error());
  return std::make_shared<const DesignModel>(std::move(*model));
}

}  // namespace

Result<LoadOutcome> loadData(const Project& project, const Progress& progress, const PartLoaded& partLoaded) {
  LoadOutcome outcome;
  const auto show = [&](LoadedData part) {
    if (partLoaded && !progress.cancelled()) partLoaded(std::move(part));
  };
  for (const Scan& scan : project.scans) {
    if (!partLoaded || progress.cancelled()) break;
    progress.report(0, "First picture");
    // A scan that cannot be sampled is read, or refused with its reason, below.
    if (auto sample = sampleScan(scan, static_cast<int>(&scan - project.scans.data()), progress.part(0, 0)); sample && !sample->empty())
      show({{{scan.id, std::move(*sample)}}, {}});
  }
  const double parts = std::max<std::size_t>(1, project.scans.size() + project.designs.size());
  double done = 0;
  const auto nextPart = [&] {
    const Progress part = progress.part(done / parts, (done + 1) / parts);
    ++done;
    return part;
  };
  for (const Design& design : project.designs) {
    auto model = loadDesign(design, outcome.warnings, nextPart());
    if (progress.cancelled()) return fail(cancelledError());
    if (model) {
      outcome.data.designs[design.id] = std::move(*model);
      show({{}, {{design.id, outcome.data.designs[design.id]}}});
    } else {
      outcome.problems.push_back(model.error());
    }
  }
  for (const Scan& scan : project.scans) {
    auto layers = loadScan(scan, static_cast<int>(&scan - project.scans.data()), outcome.warnings, nextPart());
    if (progress.cancelled()) return fail(cancelledError());
    if (layers) {
      outcome.data.scans[scan.id] = std::move(*layers);
      show({{{scan.id, outcome.data.scans[scan.id]}}, {}});
    } else {
      outcome.problems.push_back(layers.error());
    }
  }
  progress.report(1.0, "Loaded");
  return outcome;
}

void mergeInto(LoadedData& data, const LoadedData& part) {
  for (const auto& [id, scan] : part.scans) data.scans[id] = scan;
  for (const auto& [id, design] : part.designs) data.designs[id] = design;
}

void dropSamples(LoadedData& data, const Project& project) {
  std::erase_if(data.scans, [&](const auto& entry) {
    const bool sample = std::ranges::any_of(entry.second, [](const ScanLayer& layer) { return layer.sampleOf > 0; });
    return sample && std::ranges::any_of(project.scans, [&](const Scan& scan) { return scan.id == entry.first; });
  });
}

namespace {

DesignLayer layerOf(const Design& design, std::shared_ptr<const DesignModel> model, const SelectionState& selection) {
  DesignLayer layer;
  if (!design.hiddenElements.empty()) {
    const std::unordered_set<std::string> hidden(design.hiddenElements.begin(), design.hiddenElements.end());
    layer.elementVisible.reserve(model->elements.size());
    for (const DesignElement& element : model->elements)
      layer.elementVisible.push_back(hidden.contains(element.globalId) ? 0 : 1);
  }
  if (selection.design == design.id && selection.element >= 0)
    layer.selected.push_back(static_cast<std::uint32_t>(selection.element));
  layer.model = std::move(model);
  return layer;
}

}  // namespace

Result<FrameDescription> describeFrame(const Project& project, const LoadedData& data, FrameId frameId,
                                       std::shared_ptr<const ColourImage> image, const SelectionState& selection,
                                       const std::optional<RigidTransform>& pose) {
  const Frame* frame = project.findFrame(frameId);
  if (!frame) return fail("The project holds no such frame", project.path);
  const CameraRecord* camera = project.findCamera(frame->camera);
  if (!camera)
    return fail("Frame '" + frame->name + "' has no camera", project.path,
                "Add a calibration: a COLMAP model or an OpenCV calibration file");
  if (!pose && !frame->cameraFromWorld)
    return fail("Frame '" + frame->name + "' has no pose", project.path,
                "Add poses: a COLMAP model or a trajectory that covers this frame");
  if (image && (image->width() != camera->camera.width() || image->height() != camera->camera.height()))
    return fail("The picture is " + std::to_string(image->width()) + " × " + std::to_string(image->height()) +
                    " px, its camera is calibrated for " + std::to_string(camera->camera.width()) + " × " +
                    std::to_string(camera->camera.height()),
                frame->name, "Use the calibration that belongs to this picture");

  FrameDescription description;
  description.camera = camera->camera;
  description.cameraFromWorld = pose ? *pose : *frame->cameraFromWorld;
  description.shutter = shutterOf(project, *frame);
  description.image = std::move(image);
  for (const Scan& scan : project.scans)
    if (const auto it = data.scans.find(scan.id); scan.visible && it != data.scans.end())
      description.scans.insert(description.scans.end(), it->second.begin(), it->second.end());
  for (const Design& design : project.designs)
    if (const auto it = data.designs.find(design.id); design.visible && it != data.designs.end())
      description.designs.push_back(layerOf(design, it->second, selection));
  description.stakePoints = project.stakePoints;
  if (!selection.stakePoint.empty()) description.selectedStakePoints.push_back(selection.stakePoint);
  for (const Annotation& annotation : project.annotations)
    if (annotation.anchor == AnnotationAnchor::World || annotation.frame == frameId)
      description.annotations.push_back(annotation);
  description.selectedAnnotation = selection.annotation;
  for (const Observation& seen : project.observations) {
    if (seen.frame != frameId || !seen.enabled || !seen.hasPixel()) continue;
    if (const auto projected = fittedPixel(camera->camera, description.shutter, description.cameraFromWorld, seen))
      description.residuals.push_back({seen.pixel, *projected, seen.name});
  }
  description.display = project.display;
  return description;
}

void allowForPlaying(FrameDescription& frame) {
  constexpr double allowedPx = 0.5;
  frame.playing = true;
  frame.display.subdivisionErrorPx = std::max(frame.display.subdivisionErrorPx, allowedPx);
}

}  // namespace alidade

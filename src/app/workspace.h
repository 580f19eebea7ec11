// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "overlay/frame_description.h"
#include "plugin_api/reader.h"
#include "survey/project.h"

namespace alidade {

/// The heavy data behind a project, loaded: immutable, shared between threads, keyed by id.
struct LoadedData {
  std::map<ScanId, std::vector<ScanLayer>> scans;  ///< one entry a part of the scan's store
  std::map<DesignId, std::shared_ptr<const DesignModel>> designs;
};

/// Reads all scans and designs of the project. A source that fails becomes a problem, not a failure:
/// the rest still loads.
struct LoadOutcome {
  LoadedData data;
  std::vector<Error> problems;
  std::vector<ImportWarning> warnings;
};
/// What can be shown before all is there: an even sample of each large scan at once, then each design and scan as it is
/// ready. Called on the loading thread; later parts replace earlier ones of the same id.
using PartLoaded = std::function<void(LoadedData part)>;
Result<LoadOutcome> loadData(const Project& project, const Progress& progress, const PartLoaded& partLoaded = {});
/// Takes over what a part holds.
void mergeInto(LoadedData& data, const LoadedData& part);
/// Leaves out the samples of these scans whose whole never came.
void dropSamples(LoadedData& data, const Project& project);

/// Decoded pictures, the last few kept, made on a thread of its own: whoever asks waits for it, and what is expected
/// next is decoded while nobody waits. Thread-safe.
class PictureCache {
 public:
  explicit PictureCache(std::size_t capacity = 8);
  ~PictureCache();
  Result<std::shared_ptr<const ColourImage>> picture(const Project& project, const Frame& frame);
  /// Decodes these next, in this order, as far as the capacity goes; replaces what was expected before.
  void expect(const Project& project, const std::vector<FrameId>& next);
  void clear();

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// What is selected, everywhere the same: window, overlay and 3D view share it.
struct SelectionState {
  DesignId design;
  int element = -1;  ///< index in the design; -1: none
  std::string stakePoint;
  AnnotationId annotation;
  friend bool operator==(const SelectionState&, const SelectionState&) = default;
};

/// The frame as plain data for the overlay. Error where the frame has no pose (`pose` stands in for it) or no camera.
Result<FrameDescription> describeFrame(const Project& project, const LoadedData& data, FrameId frame,
                                       std::shared_ptr<const ColourImage> image, const SelectionState& selection = {},
                                       const std::optional<RigidTransform>& pose = {});

/// Lowers what the frame costs to what a video that plays can spend: see FrameDescription::playing, and design edges may sag by half
/// a pixel against the lens's curve.
void allowForPlaying(FrameDescription& frame);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "adjust/resection.h"
#include "app/workspace.h"
#include "base/error.h"
#include "base/progress.h"
#include "overlay/renderer.h"
#include "raster/occlusion.h"
#include "report/picture_export.h"
#include "simulate/demo_site.h"

namespace alidade {

// Every job that the window and the command line share: no widget, progress and cancel, a Result.

/// What to make a project of; every list may be empty.
struct NewProjectInputs {
  std::vector<std::string> scans;
  bool scansAlone = false;           ///< without the pictures and cameras that files of scans hold, too (E57)
  std::vector<std::string> designs;
  std::vector<std::string> images;   ///< folders or files
  std::vector<std::string> videos;
  std::vector<std::string> cameras;  ///< poses and intrinsics
  std::vector<std::string> rigs;     ///< rig files: a sensor's trajectory and the cameras on it, with their pictures
  std::vector<std::string> stakePoints;
  std::vector<std::string> controlPoints;
};

struct NewProjectOutcome {
  Project project;
  std::vector<std::string> notes;  ///< what could not be matched, each with the next step
};

/// Inspects every input and joins pictures with poses by name, else by time, else by order.
Result<NewProjectOutcome> newProject(const NewProjectInputs& inputs, const Progress& progress);

/// Adds to an existing project what was dropped on it; sniffs each file's kind.
Result<NewProjectOutcome> addToProject(const Project& project, const std::vector<std::string>& paths,
                                       const Progress& progress);

/// Writes the demo site and a project file demo.alidade in `folder`; returns the project's path. `asVideo`: the project is of
/// video.mp4 (H.264) with the trajectory's poses, instead of the pictures with theirs.
Result<std::string> makeDemo(const std::string& folder, const DemoOptions& options, const Progress& progress, bool asVideo = false);

/// Writes picture files as a video, in that order.
Result<void> encodeVideo(const std::vector<std::string>& pictures, const std::string& path, double framesPerSecond,
                         const Progress& progress);

/// A picture rendered and ready to be saved.
struct RenderedFrame {
  FrameDescription description;
  OverlayPicture picture;
  TitleBlock title;
  std::optional<PoseQuality> poseQuality;
  double scanSpacingM = 0;  ///< median over the clouds; 0 without a scan
};
/// Median spacing of the coarsest scan in the frame, metres; 0 without a scan.
double scanSpacing(const FrameDescription& frame);
/// How a frame is wanted, beside the project's display settings.
struct FrameWish {
  int width = 0, height = 0;      ///< pixels; 0: the raw picture's
  std::uint64_t pointBudget = 0;  ///< points drawn at most; 0: all
  SelectionState selection = {};
};
Result<RenderedFrame> renderFrame(const Project& project, const LoadedData& data, FrameId frame, const FrameWish& wish,
                                  OverlayRenderer& renderer, PictureCache& pictures);

/// With the title block unless `bare`; atomic.
Result<void> exportPicture(const RenderedFrame& frame, const std::string& path, bool bare);

/// Observations CSV: header `u,v,e,n,h[,sigma_px[,name]]`.
Result<std::vector<ResectionObservation>> readObservations(const std::string& path);

/// Refines a frame's pose. The project is changed only where it converged and not `dryRun`.
Result<ResectionSummary> refineFrame(Project& project, FrameId frame,
                                     const std::vector<ResectionObservation>& observations,
                                     const ResectionOptions& options, bool dryRun);

/// One projected point: pixel and depth are NaN where undefined.
struct ProjectedPoint {
  glm::dvec2 pixel;
  double depth;
  Visibility state;
};
Result<std::vector<ProjectedPoint>> projectPoints(const Project& project, const LoadedData& data, FrameId frame,
                                                  const std::vector<glm::dvec3>& world);

/// What the cursor points at: from the scan's depth under the pixel.
struct CursorReadout {
  std::optional<glm::dvec3> world;
  double depthM = 0;
  double distanceM = 0;
  std::optional<double> uncertaintyM;  ///< one sigma, from the pose's covariance and the scan's spacing
};
CursorReadout readoutAt(const RenderedFrame& frame, const glm::dvec2& pixel);

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/image.h"
#include "camera/camera.h"
#include "camera/rolling_shutter.h"
#include "cloud/point_styler.h"
#include "geometry/rigid_transform.h"
#include "raster/occluder_mesh.h"
#include "survey/design_model.h"
#include "survey/display_settings.h"
#include "survey/project.h"

namespace alidade {

/// A scan: its points, and the surface that its scanners saw where it has their grid.
struct ScanLayer {
  ScanPoints points;
  std::shared_ptr<const OccluderMesh> surface;  ///< tells what hides where the points are too sparse; null: none
  std::uint64_t sampleOf = 0;  ///< points of the whole scan where these are only a sample of it; 0: these are all
};

/// A design with what of it is shown. `elementVisible` and `elementColour` are by element, or empty
/// for "all" and "the element's own".
struct DesignLayer {
  std::shared_ptr<const DesignModel> model;
  std::vector<std::uint8_t> elementVisible;
  std::vector<Rgba8> elementColour;
  std::vector<std::uint32_t> selected;  ///< element indices drawn highlighted
};

/// A mark at an observation: where it was picked and where the pose puts it.
struct ResidualMark {
  glm::dvec2 observedPx;
  glm::dvec2 projectedPx;
  std::string name;
};

/// All that a frame's picture is made of: plain data, no device, no file. World coordinates are
/// double; whatever turns them to float first subtracts the camera's centre.
struct FrameDescription {
  Camera camera;  ///< of the raw picture's size
  RigidTransform cameraFromWorld;
  RollingShutter shutter;  ///< how the rows were read while the camera moved; the design, the scan and what is marked in the world follow it
  std::shared_ptr<const ColourImage> image;  ///< raw picture; null draws a dark ground
  int width = 0, height = 0;  ///< of the result; 0: the raw picture's. The lens is scaled to it.

  std::vector<ScanLayer> scans;
  std::vector<DesignLayer> designs;
  std::vector<StakePoint> stakePoints;
  std::vector<std::string> selectedStakePoints;  ///< by name
  std::vector<Annotation> annotations;           ///< those of this frame and those tied to the world
  AnnotationId selectedAnnotation;
  std::vector<ResidualMark> residuals;
  DisplaySettings display;

  // While the view moves, frames are quick before they are complete (frame_pacer.h).
  std::uint64_t pointBudget = 0;  ///< of each scan pass, over all scans; 0: none
  double selectionAgeMs = 0;      ///< points chosen for an earlier frame may serve this one for so long
  double enlargement = 1;  ///< a draft is shown so many times larger than it is drawn: letters and marks are drawn so much smaller
  /// Of a video that plays, where a frame has a fifteenth of a second: what hides the design is judged by the scanners' own
  /// grid alone where there is one, else by the points, on half the picture's width and height where they are even, and
  /// spread along its surfaces (see raster/depth_spread.h); elements' pixels are not counted.
  bool playing = false;
};

/// Pixels of one design element, counted on the result. The front layer counts by its state; the hidden
/// layer's pixels are added to `hidden` of their element, so that what lies buried under a visible surface
/// is reported too, whatever the hidden style. A pixel may therefore count for two elements.
struct ElementPixels {
  std::uint32_t layer = 0;
  std::uint32_t element = 0;
  std::uint64_t visible = 0, hidden = 0, unknown = 0;
};

/// The picture and what can be asked of it. All images are of the result's size.
///
/// Two layers of the design are drawn. The front layer is the design surface nearest to the camera, be it
/// visible, hidden or unknown; the images below speak of it alone. The hidden layer lies behind where the
/// front layer is visible: a face of another element (no back faces of closed solids), hidden by that
/// surface or by the scan, and drawn through it as HiddenStyle asks. Of several the smallest element is
/// shown, so that a pipe is seen through the pavement and the bed that it lies in. No scan, no hidden layer.
/// How a pixel looks may differ from its `state`: specks are drawn as what is around them.
struct OverlayPicture {
  ColourImage colour;
  DepthImage scanDepth;    ///< occlusion depth: +inf or NaN as in raster/occlusion.h
  DepthImage designDepth;  ///< front-most design surface, metres along the axis; +inf where none
  IdImage element;         ///< 1 + index over all layers' elements in order; 0 where none
  Image<std::uint8_t>
      state;  ///< Visibility of the design at the pixel, as its enum value; Outside where none

  std::uint64_t pointsTotal = 0, pointsDrawn = 0;  ///< see ScanPictures
  std::uint64_t pointsJudged = 0;
  double worstErrorPx = 0;  ///< largest distance of a drawn design edge from its exact curve, pixels
  std::vector<ElementPixels> elements;  ///< those with a pixel in the picture; none of a video that plays

  /// The layer and element behind an `element` pixel value.
  std::vector<std::uint32_t> firstElementOfLayer;
};

}  // namespace alidade

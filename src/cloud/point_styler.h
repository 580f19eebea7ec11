// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>

#include <glm/glm.hpp>

#include "cloud/point_store.h"
#include "cloud/point_summary.h"
#include "cloud/selection.h"
#include "survey/point_style.h"

namespace alidade {

/// A scan's points, and what styling them needs.
struct ScanPoints {
  std::shared_ptr<const PointStore> store;
  std::shared_ptr<const PointSummary> summary;  ///< null: ranges are not known, automatic ones are empty
  int number = 0;                               ///< counts the scans, for colour by scan
};

/// Colours and filters one store's points as a PointStyle asks. What was made for a node is kept until
/// the style changes: a still style costs a frame next to nothing, a new one a pass over the points in
/// view. Memory: 8 bytes for each styled point, at most some 500 MB beyond what one frame needs.
/// One user at a time.
class PointStyler {
 public:
  explicit PointStyler(ScanPoints scan);
  ~PointStyler();

  enum class Part { ColourAndFilter, Filter };

  /// Lets the ranges draw styled copies, valid until the next call; ranges left empty are dropped and
  /// pointCount follows. Does nothing where the style asks for nothing. `eye` is the camera's centre,
  /// world metres, for colour by distance.
  void apply(const PointStyle& style, Part part, const glm::dvec3& eye, Selection& selection);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace alidade

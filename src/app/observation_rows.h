// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "survey/ids.h"

namespace alidade {

/// What a row of an observations file says.
enum class ObservationKind {
  Control,   ///< u v: a surveyed point e n h (± sigma_m)
  Scan,      ///< u v: a point e n h picked in a scan (± sigma_m, 0.003 where not given)
  Tie,       ///< u v: an unknown point, the same name in several frames; e n h may give its start
  Edge,      ///< u v: a place on the straight edge from e n h to e2 n2 h2
  Depth,     ///< depth_m: of the point of that name, along the frame's optical axis (± sigma_m)
  Surface,   ///< the tie point of that name lies on the plane through e n h with the normal e2 n2 h2 (± sigma_m)
  Position,  ///< the frame's camera stands at e n h (± sigma_m): a surveyed tripod
};

struct ObservationRow {
  ObservationKind kind = ObservationKind::Control;
  std::string where;   ///< file and line
  std::string frame;   ///< name or index; empty: the one given with the command
  std::string name;
  glm::dvec2 pixel{0};
  std::optional<glm::dvec3> world, second;
  double sigmaPx = 0.5, sigmaM = 0, depthM = 0;
  bool heldOut = false;
  ObservationId id;    ///< of the project's own
};

/// CSV with a header of columns in any order: u,v,e,n,h[,sigma_px][,name][,frame][,kind][,use][,sigma_m][,e2,n2,h2][,depth_m].
/// `kind` is control (as without it), scan, tie, edge, depth, surface or position; `use` 1 (as without it), 0: the row is
/// skipped, or check: held out (points, edges and depths). Unknown and repeated
/// columns and rows of another length than the header are refused. Every error names file and line.
Result<std::vector<ObservationRow>> readObservationRows(const std::string& path);

}  // namespace alidade

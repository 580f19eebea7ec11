// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "cleaning/cleaning.h"
#include "cleaning/registration.h"
#include "cleaning/surface.h"

namespace alidade {

// Jobs on a scan file as a whole: clean it into another file, fit it to another, make a surface of it. Positions are held in memory
// (some 40 bytes a point); everything else streams from file to file. The source is never changed, so undo is to
// go on with the source.

/// What to do, in this order; what is empty is left out.
struct ScanCleaning {
  std::optional<StatisticalOutlierOptions> outliers;
  std::optional<RadiusOutlierOptions> radius;
  std::optional<double> voxelMeters;
  std::optional<GroundOptions> ground;   ///< ASPRS class 2; what was in it and is not, becomes class 1
  std::optional<NormalOptions> normals;  ///< towards the scan's stations, where it has any
};

struct ScanCleaningSummary {
  std::uint64_t read = 0, written = 0;
  std::uint64_t outliers = 0, lonely = 0, thinned = 0;  ///< dropped by each step
  std::uint64_t ground = 0;                             ///< of those written
  std::vector<std::string> notes;
};

/// Reads `source`, writes `target` in the format of its name. Error where they are one file, where the target's format
/// needs a tree, and for an unreadable or unwritable file; a target that is there is replaced at the very end only.
Result<ScanCleaningSummary> cleanScan(const std::string& source, const std::string& target, const ScanCleaning& cleaning, const Progress& progress);

/// Fits one scan file to another (see registerScan).
Result<Registration> registerScanFiles(const std::string& moving, const std::string& fixed, const RegistrationOptions& options,
                                       const Progress& progress);

/// Writes a scan anew where a transform puts it: points, normals and stations; coordinates are rounded to the source's own
/// step again. Errors as for cleanScan.
Result<void> moveScan(const std::string& source, const std::string& target, const RigidTransform& targetFromSource, const Progress& progress);

struct SurfaceOrder {
  std::optional<GreedyOptions> greedy;    ///< one of the two
  std::optional<PoissonOptions> poisson;
  std::optional<double> voxelMeters;      ///< thinned before
};
struct SurfaceSummary {
  std::size_t points = 0, vertices = 0, triangles = 0;
  double seconds = 0;  ///< of the reconstruction alone
};

/// Makes a surface of a scan and writes it as PLY or OBJ. The scan's own normals are used where it has them.
Result<SurfaceSummary> meshScan(const std::string& source, const std::string& target, const SurfaceOrder& order, const Progress& progress);

}  // namespace alidade

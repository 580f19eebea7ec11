// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/progress.h"
#include "cloud/store_folder.h"
#include "raster/occluder_mesh.h"

namespace alidade {

/// The surface that a scan's stations saw, from their grids. Stations are joined a few at a time, so that at most so many
/// returns are held at once (20 bytes each); one with more is left to its points. Null where no grid is known, and when cancelled.
std::shared_ptr<const OccluderMesh> joinGrids(const PointStore& store, const std::vector<Station>& stations, const Progress& progress,
                                              std::uint64_t mostReturns = 40'000'000);

/// The same for a part of a store on disk, joined once and kept in the part's folder:
///
///   surface.bin   "ALISURF" and a byte for the version, u64 checksum of all that follows, u64 the part's nodes checksum and count of points,
///                 u64 counts, then origins, blocks and packs, each with its u64 count, as OccluderMesh lays them
///
/// A file that is damaged, or of another version or part, is made anew. Where the folder cannot be written and the part is large,
/// there is none: joining would read all of it each time.
std::shared_ptr<const OccluderMesh> surfaceOfPart(const std::string& storePath, const StorePart& part, const Progress& progress);

/// Joins and keeps the surfaces of all parts that have none yet.
void keepSurfaces(const StoreFolder& store, const Progress& progress);

}  // namespace alidade

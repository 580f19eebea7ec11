// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "cloud/point_store.h"
#include "cloud/store_manifest.h"

namespace alidade {

/// A store on disk: NAME.alidade-points/ with
///
///   manifest.json            what it holds (store_manifest.h); written last, in one step
///   part-0001/points.bin     DisplayPoint a point
///             exact.bin      the lattice's exact coordinates, where it has such a column
///             column-001.bin … the schema's columns
///             nodes.bin      nodes and their places (store_data.h)
///             tables.bin     u32, cumulative counts a level step, node after node
///             part.json      a manifest of this part alone
///             surface.bin    what its stations saw, where that was joined since; no part of the checks here
///   part-0002.partial/       work in progress; no part of the store
struct StorePart {
  PartManifest manifest;
  std::shared_ptr<const PointStore> points;
};

struct StoreFolder {
  std::string path;
  std::vector<StorePart> parts;  ///< one a scan
};

/// A folder that is called a store, or holds a store's manifest; openStore says whether it is whole.
bool isStoreFolder(const std::string& path);

/// Opens a store: manifest, nodes and tables are read and checked, columns are mapped and their sizes
/// checked. Damage inside a column shows as other points, never as a crash. A store that is open must not be
/// cut shorter by others.
Result<StoreFolder> openStore(const std::string& path);

/// One part, from its folder.
Result<StorePart> openPart(const std::string& folder, const PartManifest& manifest);

}  // namespace alidade

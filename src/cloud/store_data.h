// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "cloud/part_index.h"
#include "cloud/point_store.h"

namespace alidade {

/// Everything of a store but its columns, from the tree as it was built.
PointStoreData storeDataOf(const PartTree& part);

}  // namespace alidade

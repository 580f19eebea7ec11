// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/store_data.h"

#include <cmath>

namespace alidade {

PointStoreData storeDataOf(const PartTree& part) {
  PointStoreData data;
  data.lattice = part.lattice;
  data.schema = part.schema;
  data.levelKind = part.tree.kind;
  data.law = part.tree.law;
  data.lawShift = part.tree.lawShift;
  const std::int32_t rootDepth = part.nodes.empty() ? 0 : part.nodes[0].depth;
  const double half = part.lattice.exact == ExactCoordinates::Lattice ? 0.0 : 0.5 * part.lattice.step;
  for (const BuildNode& built : part.nodes) {
    PointStoreData::NodePlace place;
    place.corner = part.lattice.corner + (glm::i64vec3(built.tile) << std::int64_t{16});
    place.firstStep = built.firstBucket;
    place.stepCount = built.bucketCount;
    place.tableOffset = built.tableOffset;
    CloudNode node;
    node.origin = part.lattice.positionOf(place.corner);
    node.step = part.lattice.step;
    node.size = std::ldexp(part.lattice.step * 65536.0, -built.depth);
    if (built.hasBounds()) {
      // Where points are shown at their cells' middle, the source lies up to half a unit away.
      node.bounds.add(part.lattice.positionOf(part.lattice.corner + built.low) - half);
      node.bounds.add(part.lattice.positionOf(part.lattice.corner + built.high) + half);
    }
    node.depth = static_cast<std::uint32_t>(built.depth - rootDepth);
    node.firstChild = built.firstChild;
    node.childCount = built.childCount;
    node.first = built.first;
    node.count = built.count;
    node.spacing = built.spacingUnits * part.lattice.step;
    data.nodes.push_back(node);
    data.places.push_back(place);
  }
  return data;
}

}  // namespace alidade

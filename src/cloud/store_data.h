// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "cloud/part_index.h"
#include "cloud/point_store.h"

namespace alidade {

/// Everything of a store but its columns, from the tree as it was built.
PointStoreData storeDataOf(const PartTree& part);

/// A node with its place, field by field, little endian: what nodes.bin is made of.
inline constexpr std::size_t kNodeBytes = (11 + 1) * sizeof(double) + 6 * sizeof(std::uint32_t) + (1 + 3 + 1) * sizeof(std::uint64_t) + sizeof(NodeSlab);
static_assert(sizeof(NodeSlab) == 7 * sizeof(float));
std::vector<std::byte> packNodes(const PointStoreData& data);
/// `bytes` holds whole nodes.
void unpackNodes(std::span<const std::byte> bytes, PointStoreData& data);

/// True where nodes, places and tables fit one another, the points and the numbers that they are counted with:
/// whoever walks over them stays inside.
bool isSound(const PointStoreData& data);

}  // namespace alidade

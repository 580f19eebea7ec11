// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdlib>

#include <gtest/gtest.h>

#include "mesh/mesh_reader.h"

namespace alidade {
namespace {
TEST(Mesh, Placeholder) { EXPECT_EQ(MeshReader().description().id, "mesh"); }
}  // namespace
}  // namespace alidade

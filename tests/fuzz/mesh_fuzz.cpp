// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// What of the mesh reader runs inside Alidade on bytes from outside: checking and moving the files' text.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "mesh/mesh_source.h"

namespace {

void check(const alidade::Result<alidade::MeshSource>& source, std::size_t size) {
  if (!source) {
    if (source.error().what.empty()) std::abort();
    return;
  }
  for (int a = 0; a < 3; ++a)
    if (!std::isfinite(source->offset[a]) || source->offset[a] != std::round(source->offset[a])) std::abort();
  // Numbers may grow from "1" to "-1.23456789e+11", never more; glTF nodes get a matrix each.
  if (source->content.size() > 64 * size + 65536) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string content(reinterpret_cast<const char*>(data), size);
  check(alidade::prepareObj(content, "/nonexistent"), size);
  check(alidade::prepareStl(content), size);
  check(alidade::preparePly(content), size);
  check(alidade::prepareGltf(content, content.starts_with("glTF")), size);
  return 0;
}

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// What of the IFC reader runs inside Alidade on bytes from outside: the STEP scanner, and the decoder of
// the design stream that the helper program sends.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

#include "ifc/step_scanner.h"
#include "survey/design_stream.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto summary = alidade::scanStep({reinterpret_cast<const char*>(data), size});
  if (summary && summary->schema.empty()) std::abort();
  if (!summary && summary.error().what.empty()) std::abort();

  const auto design = alidade::decodeDesign(std::as_bytes(std::span(data, size)));
  if (!design) return design.error().what.empty() ? (std::abort(), 0) : 0;
  for (const auto index : design->model.triangles)
    if (index >= design->model.vertices.size()) std::abort();
  for (const auto& edge : design->model.edges)
    if (edge[0] >= design->model.vertices.size() || edge[1] >= design->model.vertices.size()) std::abort();
  for (const auto& e : design->model.elements)
    if (std::uint64_t{e.firstIndex} + e.indexCount > design->model.triangles.size() ||
        std::uint64_t{e.firstEdge} + e.edgeCount > design->model.edges.size())
      std::abort();
  if (!design->model.elements.empty() && alidade::encodeDesign(*design).size() > 2 * size + 4096) std::abort();
  return 0;
}

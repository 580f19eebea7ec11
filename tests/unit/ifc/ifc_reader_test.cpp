// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdlib>
#include <filesystem>
#include <map>

#include <gtest/gtest.h>

#include "ifc/ifc_reader.h"

namespace alidade {
namespace {


TEST(IfcRealFiles, DISABLED_PrintElements) {
  const char* name = std::getenv("IFC");
  std::vector<ImportWarning> warnings;
  const auto model = IfcReader().read(name, Progress(), warnings);
  ASSERT_TRUE(model) << model.error().text();
  for (const auto& e : model->elements) {
    const auto box = model->elementBounds(&e - model->elements.data());
    std::printf("%-22s %-24s %-40s %-16s #%02x%02x%02x%02x tris %5u edges %5u  %.3f %.3f %.3f  size %.3f %.3f %.3f props %zu\n", e.globalId.c_str(), e.type.c_str(), e.name.c_str(), e.storey.c_str(), e.colour.r, e.colour.g, e.colour.b, e.colour.a, e.indexCount / 3, e.edgeCount, box.min.x, box.min.y, box.min.z, box.size().x, box.size().y, box.size().z, e.properties.size());
  }
  const auto box = model->bounds();
  std::printf("%zu elements %zu triangles %zu edges; %f %f %f .. %f %f %f origin %f %f %f crs %s\n", model->elements.size(), model->triangles.size() / 3, model->edges.size(), box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z, model->origin.x, model->origin.y, model->origin.z, model->crs.c_str());
  for (const auto& [k, v] : model->elements[model->elements.size() / 2].properties) std::printf("  %s = %s\n", k.c_str(), v.c_str());
  for (const auto& w : warnings) std::printf("! %s (%s)\n", w.what.c_str(), w.where.c_str());
}

}  // namespace
}  // namespace alidade

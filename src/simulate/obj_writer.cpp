// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <set>
#include <string>

#include <fmt/format.h>

#include "simulate/design_writer.h"
#include "simulate/output_file.h"

namespace alidade {

glm::dvec3 designColour(Material material) {
  switch (material) {
    case Material::Brick:
      return {0.72, 0.36, 0.26};
    case Material::ScreedConcrete:
      return {0.66, 0.68, 0.70};
    case Material::CastIron:
      return {0.25, 0.27, 0.30};
    case Material::ClayPipe:
      return {0.80, 0.45, 0.20};
    case Material::Kerb:
      return {0.80, 0.80, 0.76};
    default:
      return {0.58, 0.66, 0.74};
  }
}

Result<void> writeDesignObj(const std::string& path, const SiteModel& site) {
  const std::string library = path.substr(0, path.size() - 4) + ".mtl";
  const std::string shortName = library.substr(library.find_last_of('/') + 1);
  std::string text =
      "# Alidade demo site: the design, world coordinates in metres, z up\nmtllib " + shortName + "\n";
  const SiteMesh& mesh = site.design;
  for (const glm::dvec3& p : mesh.positions) {
    const glm::dvec3 world = site.worldFromSite * p;
    text += fmt::format("v {:.4f} {:.4f} {:.4f}\n", world.x, world.y, world.z);
  }
  std::uint32_t object = 0xFFFFFFFFu;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (mesh.triangleObject[i] != object) {
      object = mesh.triangleObject[i];
      text += fmt::format("g {}\nusemtl m{}\n", mesh.objects[object].name,
                          static_cast<int>(mesh.objects[object].material));
    }
    const auto& t = mesh.triangles[i];
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  std::set<Material> used;
  for (const DesignItem& item : site.items) used.insert(item.material);
  std::string materials;
  for (const Material material : used) {
    const glm::dvec3 colour = designColour(material);
    materials += fmt::format("newmtl m{}\nKd {:.3f} {:.3f} {:.3f}\n", static_cast<int>(material), colour.r,
                             colour.g, colour.b);
  }
  if (auto written = writeWholeFile(library, materials); !written) return written;
  return writeWholeFile(path, text);
}

}  // namespace alidade

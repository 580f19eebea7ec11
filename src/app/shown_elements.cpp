// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/shown_elements.h"

#include <algorithm>

namespace alidade {

bool showOnlyStorey(Design& design, const DesignModel& model, const std::string& storey) {
  if (std::ranges::find(model.elements, storey, &DesignElement::storey) == model.elements.end()) return false;
  design.hiddenElements.clear();
  for (const DesignElement& element : model.elements)
    if (element.storey != storey) design.hiddenElements.push_back(element.globalId);
  return true;
}

std::size_t hideByName(Project& project, const LoadedData& data, const std::string& name) {
  std::size_t hidden = 0;
  for (Scan& scan : project.scans)
    if (scan.name == name) scan.visible = false, ++hidden;
  for (Design& design : project.designs) {
    if (design.name == name) design.visible = false, ++hidden;
    const auto loaded = data.designs.find(design.id);
    if (loaded == data.designs.end()) continue;
    for (const DesignElement& element : loaded->second->elements) {
      if (element.globalId != name && element.name != name) continue;
      design.hiddenElements.push_back(element.globalId);
      ++hidden;
    }
  }
  return hidden;
}

}  // namespace alidade

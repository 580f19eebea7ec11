// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include <fmt/format.h>

#include "app/jobs.h"
#include "cli/command.h"
#include "cli/input_rows.h"
#include "cli/project_input.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

/// The design's element that the picture shows at a pixel.
const DesignElement* elementAt(const RenderedFrame& rendered, int x, int y) {
  std::uint32_t id = rendered.picture.element.at(x, y);
  if (id-- == 0) return nullptr;
  const auto& first = rendered.picture.firstElementOfLayer;
  std::size_t layer = 0;
  while (layer + 1 < first.size() && first[layer + 1] <= id) ++layer;
  return &rendered.description.designs[layer].model->elements[id - first[layer]];
}

void describe(const RenderedFrame& rendered, const glm::dvec2& pixel, Answer& answer) {
  const bool inside = pixel.x > -0.5 && pixel.y > -0.5 && pixel.x < rendered.picture.colour.width() - 0.5 && pixel.y < rendered.picture.colour.height() - 0.5;
  const int x = inside ? static_cast<int>(std::lround(pixel.x)) : 0, y = inside ? static_cast<int>(std::lround(pixel.y)) : 0;
  Json point = {{"u_px", pixel.x}, {"v_px", pixel.y}, {"world_m", nullptr}, {"depth_m", nullptr}, {"distance_m", nullptr},
                {"uncertainty_m", nullptr}, {"element", nullptr}};
  std::string words = fmt::format("{:.3f} {:.3f}", pixel.x, pixel.y);
  const CursorReadout readout = inside ? readoutAt(rendered, pixel) : CursorReadout();
  if (readout.world) {
    point["world_m"] = {readout.world->x, readout.world->y, readout.world->z};
    point["depth_m"] = readout.depthM, point["distance_m"] = readout.distanceM;
    words += fmt::format(" {:.4f} {:.4f} {:.4f} {:.4f}", readout.world->x, readout.world->y, readout.world->z, readout.distanceM);
    if (readout.uncertaintyM) point["uncertainty_m"] = *readout.uncertaintyM;
    words += readout.uncertaintyM ? fmt::format(" {:.4f}", *readout.uncertaintyM) : " nan";
  } else {
    words += " nan nan nan nan nan";
  }
  if (const DesignElement* element = inside ? elementAt(rendered, x, y) : nullptr) {
    const char* state = stateName(static_cast<Visibility>(rendered.picture.state.at(x, y)));
    point["element"] = {{"global_id", element->globalId}, {"name", element->name}, {"type", element->type}, {"storey", element->storey}, {"state", state}};
    words += fmt::format(" {} {}", state, element->name.empty() ? element->globalId : element->name);
  }
  answer.json["points"].push_back(std::move(point));
  answer.text += words + "\n";
}

}  // namespace

void addPick(Verbs& verbs) {
  struct Arguments {
    std::string project, frame;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add(
      "pick", "What stands at pixels from standard input: u v E N H distance ± [state element], one line a pixel",
      [arguments](const Progress& progress) -> Result<Answer> {
        const auto rows = rowsFromInput(2, "pixels", "u v", progress);
        if (!rows) return fail(rows.error());
        for (std::size_t i = 0; i < rows->size(); ++i)
          if (!std::isfinite((*rows)[i][0]) || !std::isfinite((*rows)[i][1]))
            return fail(fmt::format("Pixel {} is no finite number", i + 1), "standard input", "Give u v, one pixel a line");
        auto open = openProject(arguments->project, arguments->frame, true, progress);
        if (!open) return fail(open.error());
        auto renderer = OverlayRenderer::create();
        if (!renderer) return fail(renderer.error());
        PictureCache pictures;
        const auto rendered = renderFrame(open->project, open->data, open->frame, {}, **renderer, pictures);
        if (!rendered) return fail(rendered.error());
        Answer answer;
        answer.json = {{"frame", open->project.findFrame(open->frame)->name}, {"points", Json::array()}};
        for (const auto& row : *rows) describe(*rendered, {row[0], row[1]}, answer);
        return answer;
      });
  command->add_option("project", arguments->project, "Project file")->required();
  command->add_option("--frame", arguments->frame, "Name, or index from 0")->required();
}

}  // namespace alidade::cli

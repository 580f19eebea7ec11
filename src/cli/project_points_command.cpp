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

Json numberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace

void addProjectPoints(Verbs& verbs) {
  struct Arguments {
    std::string project, frame;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add(
      "project-points", "Project world points from standard input: u v depth state, one line a point",
      [arguments](const Progress& progress) -> Result<Answer> {
        const auto rows = rowsFromInput(3, "points", "E N H", progress);
        if (!rows) return fail(rows.error());
        std::vector<glm::dvec3> points;
        for (const auto& row : *rows) points.emplace_back(row[0], row[1], row[2]);
        auto open = openProject(arguments->project, arguments->frame, true, progress);
        if (!open) return fail(open.error());
        auto projected = projectPoints(open->project, open->data, open->frame, points);
        if (!projected) return fail(projected.error());
        Answer answer;
        answer.json = {{"frame", open->project.findFrame(open->frame)->name}, {"points", Json::array()}};
        for (const ProjectedPoint& p : *projected) {
          answer.json["points"].push_back({{"u_px", numberOrNull(p.pixel.x)}, {"v_px", numberOrNull(p.pixel.y)},
                                           {"depth_m", numberOrNull(p.depth)}, {"state", stateName(p.state)}});
          answer.text += fmt::format("{:.6f} {:.6f} {:.6f} {}\n", p.pixel.x, p.pixel.y, p.depth, stateName(p.state));
        }
        return answer;
      });
  command->add_option("project", arguments->project, "Project file")->required();
  command->add_option("--frame", arguments->frame, "Name, or index from 0")->required();
}

}  // namespace alidade::cli

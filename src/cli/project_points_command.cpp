// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <charconv>
#include <cmath>
#include <iostream>

#include <fmt/format.h>

#include "app/jobs.h"
#include "cli/command.h"
#include "cli/project_input.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

const char* stateName(Visibility state) {
  switch (state) {
    case Visibility::Visible: return "visible";
    case Visibility::Hidden: return "hidden";
    case Visibility::Unknown: return "unknown";
    case Visibility::Outside: return "outside";
  }
  return "";
}

/// One point a line: three numbers between blanks, tabs, commas or semicolons; # starts a comment.
Result<std::vector<glm::dvec3>> readPoints(std::istream& input) {
  std::vector<glm::dvec3> points;
  std::string line;
  for (int number = 1; std::getline(input, line); ++number) {
    if (const auto comment = line.find('#'); comment != std::string::npos) line.erase(comment);
    const char* at = line.data();
    const char* const end = line.data() + line.size();
    const auto skip = [&] {
      while (at < end && (*at == ' ' || *at == '\t' || *at == ',' || *at == ';' || *at == '\r')) ++at;
    };
    skip();
    if (at == end) continue;
    glm::dvec3 p{0};
    for (int axis = 0; axis < 3; ++axis) {
      const auto [next, error] = std::from_chars(at, end, p[axis]);
      if (error != std::errc())
        return fail("A line needs three numbers: E N H", "standard input, line " + std::to_string(number));
      at = next;
      skip();
    }
    points.push_back(p);
  }
  return points;
}

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
        auto points = readPoints(std::cin);
        if (!points) return fail(points.error());
        auto open = openProject(arguments->project, arguments->frame, true, progress);
        if (!open) return fail(open.error());
        auto projected = projectPoints(open->project, open->data, open->frame, *points);
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

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <charconv>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <sstream>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

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

/// All of standard input. Waits in short steps, so that Ctrl+C ends a wait for somebody's typing.
Result<std::string> readInput(const Progress& progress) {
  constexpr int kWaitMs = 100;
  std::string text;
  std::vector<char> block(1 << 16);
  for (;;) {
    progress.report(0.0, "Reading points from standard input");
    if (progress.cancelled()) return fail(cancelledError());
    pollfd waiting{STDIN_FILENO, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, kWaitMs);
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t count = ::read(STDIN_FILENO, block.data(), block.size());
    if (count == 0) return text;
    if (count > 0) text.append(block.data(), static_cast<std::size_t>(count));
    else if (errno != EINTR && errno != EAGAIN)
      return fail(fmt::format("The points cannot be read: {}", std::strerror(errno)), "standard input",
                  "Give them by < FILE or through a pipe: E N H, one point a line");
  }
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
      if (end - at > 1 && *at == '+' && at[1] != '-') ++at;  // from_chars takes no plus sign
      const auto [next, error] = std::from_chars(at, end, p[axis]);
      if (error != std::errc())
        return fail("A line needs three numbers: E N H", fmt::format("standard input, line {}", number),
                    "Write metres with a decimal point, blanks or commas between, and # before remarks");
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
        const auto text = readInput(progress);
        if (!text) return fail(text.error());
        std::istringstream input(*text);
        auto points = readPoints(input);
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

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include <fmt/format.h>

#include "app/camera_mount.h"
#include "cli/command.h"
#include "cli/number_list.h"
#include "geometry/angle.h"
#include "io/project_store.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string project, camera, body, position, angles, positionStd, anglesStd;
  bool remove = false, dryRun = false;
};

Result<glm::dvec3> parseThree(const std::string& text) {
  const auto v = numberList(text, 3, 3, "", "Give X,Y,Z");
  if (!v) return fail(v.error());
  return glm::dvec3((*v)[0], (*v)[1], (*v)[2]);
}

/// The camera of that name, or the only one.
Result<CameraId> cameraByName(const Project& project, const std::string& name) {
  std::string names;
  for (const CameraRecord& camera : project.cameras) {
    if (camera.name == name) return camera.id;
    names += (names.empty() ? "'" : ", '") + camera.name + "'";
  }
  if (project.cameras.empty()) return fail("The project has no camera", project.path, "Add a calibration: alidade-cli new --cameras");
  if (name.empty() && project.cameras.size() == 1) return project.cameras.front().id;
  return fail(name.empty() ? "The project has several cameras" : "No camera is called '" + name + "'", project.path,
              "Give --camera, one of " + names);
}

Result<MountFigures> changed(const Arguments& arguments, const CameraRecord& camera) {
  MountFigures figures = camera.mount ? figuresOf(*camera.mount) : MountFigures();
  if (!arguments.body.empty()) figures.body = arguments.body;
  const auto take = [](const std::string& text, glm::dvec3& value, double unit) -> Result<void> {
    if (text.empty()) return {};
    const auto three = parseThree(text);
    if (!three) return fail(three.error());
    value = unit * *three;
    return {};
  };
  const double degree = radiansFromDegrees(1);
  return take(arguments.position, figures.positionM, 1)
      .and_then([&] { return take(arguments.angles, figures.anglesRad, degree); })
      .and_then([&] { return take(arguments.positionStd, figures.positionStdM, 1e-3); })
      .and_then([&] { return take(arguments.anglesStd, figures.anglesStdRad, degree); })
      .map([&] { return figures; });
}

void describe(const CameraRecord& camera, Answer& answer) {
  const MountFigures f = figuresOf(*camera.mount);
  const auto vec = [](const glm::dvec3& v) { return Json{v.x, v.y, v.z}; };
  const double degree = degreesFromRadians(1);
  answer.json["mounts"].push_back({{"camera", camera.name}, {"body", f.body}, {"position_on_body_m", vec(f.positionM)},
                                   {"angles_deg", vec(degree * f.anglesRad)}, {"offset_std_m", vec(f.positionStdM)},
                                   {"rotation_std_rad", vec(f.anglesStdRad)}});
  // Rounded, and a negative nothing made a nothing.
  const auto shown = [](double value) { return std::round(value * 1e4) / 1e4 + 0.0; };
  answer.text += fmt::format("{} on {}: x {:.4f}  y {:.4f}  z {:.4f} m, ω {:.4f}  φ {:.4f}  κ {:.4f}°", camera.name, f.body, shown(f.positionM.x),
                             shown(f.positionM.y), shown(f.positionM.z), shown(degree * f.anglesRad.x), shown(degree * f.anglesRad.y),
                             shown(degree * f.anglesRad.z));
  if (f.positionStdM != glm::dvec3(0))
    answer.text += fmt::format("; ± {:.1f} {:.1f} {:.1f} mm", 1e3 * f.positionStdM.x, 1e3 * f.positionStdM.y, 1e3 * f.positionStdM.z);
  if (f.anglesStdRad != glm::dvec3(0))
    answer.text += fmt::format("; ± {:.4f} {:.4f} {:.4f}°", degree * f.anglesStdRad.x, degree * f.anglesStdRad.y, degree * f.anglesStdRad.z);
  answer.text += "\n";
}

Result<Answer> run(const Arguments& arguments) {
  auto project = loadProject(arguments.project);
  if (!project) return fail(project.error());
  const bool sets = !(arguments.body + arguments.position + arguments.angles + arguments.positionStd + arguments.anglesStd).empty();
  int followed = 0;
  if (sets || arguments.remove) {
    const auto id = cameraByName(*project, arguments.camera);
    if (!id) return fail(id.error());
    std::optional<CameraMount> mount;
    if (sets) {
      const auto figures = changed(arguments, *project->findCamera(*id));
      if (!figures) return fail(figures.error());
      auto made = mountOf(*figures);
      if (!made) return fail(made.error());
      mount = std::move(*made);
    }
    const auto set = setMount(*project, *id, mount);
    if (!set) return fail(set.error());
    followed = *set;
  }
  if (!arguments.camera.empty())
    if (const auto id = cameraByName(*project, arguments.camera); !id) return fail(id.error());
  const bool saves = (sets || arguments.remove) && !arguments.dryRun;
  if (saves)
    if (auto saved = saveProject(*project, arguments.project); !saved) return fail(saved.error());
  Answer answer;
  answer.json = {{"mounts", Json::array()}, {"saved", saves}, {"poses_followed", followed}};
  for (const CameraRecord& camera : project->cameras)
    if (camera.mount && (arguments.camera.empty() || camera.name == arguments.camera)) describe(camera, answer);
  if (sets || arguments.remove) answer.text += fmt::format("{} {} followed\n", followed, followed == 1 ? "pose" : "poses");
  if (answer.text.empty()) answer.text = "No camera sits on a body\n";
  return answer;
}

}  // namespace

void addMount(Verbs& verbs) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add("mount", "Show or set where cameras sit on the bodies that carry them",
                                [arguments](const Progress&) { return run(*arguments); });
  const auto three = checkedBy(parseThree, "X,Y,Z");
  command->add_option("project", arguments->project, "Project file")->required();
  command->add_option("--camera", arguments->camera, "Name, where the project has several");
  command->add_option("--body", arguments->body, "What carries it: a trajectory's sensor, or another camera; those on one body make a rig");
  command->add_option("--position", arguments->position, "Of the camera's centre in the body's axes, metres")->check(three);
  command->add_option("--angles", arguments->angles, "Degrees about the body's x, then the new y, then the new z; 0,0,0: the body's axes")->check(three);
  command->add_option("--position-sigma", arguments->positionStd, "Standard deviations along the camera's axes, millimetres: kept and shown; adjustments do not weigh by them")->check(three);
  command->add_option("--angle-sigma", arguments->anglesStd, "Standard deviations about the camera's axes, degrees: kept and shown")->check(three);
  auto* remove = command->add_flag("--remove", arguments->remove, "The camera sits on no body; its trajectory goes back to the body's place");
  for (const char* other : {"--body", "--position", "--angles", "--position-sigma", "--angle-sigma"}) remove->excludes(other);
  command->add_flag("--dry-run", arguments->dryRun, "Report only; leave the project as it is");
}

}  // namespace alidade::cli

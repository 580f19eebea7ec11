// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "app/scan_cleaning.h"
#include "cli/command.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

/// "8,1.0": a whole number and a length or factor, in the order that `wholeFirst` says.
Result<std::pair<int, double>> parsePair(const std::string& text, bool wholeFirst) {
  int whole = 0;
  double real = 0;
  char tail = 0;
  const bool good = wholeFirst ? std::sscanf(text.c_str(), "%d,%lf%c", &whole, &real, &tail) == 2
                               : std::sscanf(text.c_str(), "%lf,%d%c", &real, &whole, &tail) == 2;
  if (!good || whole < 1 || !(real > 0) || !std::isfinite(real))
    return fail("'" + text + "' is not two numbers above 0", {}, wholeFirst ? "Give neighbours,deviations such as 8,1.0" : "Give metres,neighbours such as 0.1,4");
  return std::pair(whole, real);
}

struct CleanArguments {
  std::string scan, output, outliers, radius;
  double voxel = 0, window = GroundOptions().largestWindowMeters;
  bool ground = false, normals = false, overwrite = false;
};

Result<Answer> runClean(const CleanArguments& arguments, const Progress& progress) {
  if (!arguments.overwrite && std::filesystem::exists(arguments.output))
    return fail("The file is there already", arguments.output, "Choose another name or add --overwrite");
  ScanCleaning cleaning;
  if (!arguments.outliers.empty()) {
    const auto pair = parsePair(arguments.outliers, true);
    if (!pair) return fail(pair.error());
    cleaning.outliers = {pair->first, pair->second};
  }
  if (!arguments.radius.empty()) {
    const auto pair = parsePair(arguments.radius, false);
    if (!pair) return fail(pair.error());
    cleaning.radius = {pair->second, pair->first};
  }
  if (arguments.voxel > 0) cleaning.voxelMeters = arguments.voxel;
  if (arguments.ground) {
    cleaning.ground.emplace();
    cleaning.ground->largestWindowMeters = arguments.window;
  }
  if (arguments.normals) cleaning.normals.emplace();
  const auto summary = cleanScan(arguments.scan, arguments.output, cleaning, progress);
  if (!summary) return fail(summary.error());
  Answer answer;
  answer.json = {{"output", arguments.output}, {"points_read", summary->read}, {"points_written", summary->written},
                 {"outliers", summary->outliers}, {"lonely", summary->lonely}, {"thinned", summary->thinned},
                 {"ground", summary->ground}, {"notes", summary->notes}};
  answer.text = fmt::format("{}\n  read      {}\n  outliers  {}\n  lonely    {}\n  thinned   {}\n  written   {}\n", arguments.output, summary->read,
                            summary->outliers, summary->lonely, summary->thinned, summary->written);
  if (cleaning.ground) answer.text += fmt::format("  ground    {}\n", summary->ground);
  for (const std::string& note : summary->notes) answer.text += "  note      " + note + '\n';
  return answer;
}

struct RegisterArguments {
  std::string moving, fixed;
  RegistrationOptions options;
};

Result<Answer> runRegister(const RegisterArguments& arguments, const Progress& progress) {
  const auto found = registerScanFiles(arguments.moving, arguments.fixed, arguments.options, progress);
  if (!found) return fail(found.error());
  Answer answer;
  const glm::dquat& q = found->fixedFromMoving.rotation;
  const glm::dvec3& t = found->fixedFromMoving.translation;
  answer.json = {{"converged", true}, {"fixed_from_moving_wxyz", {q.w, q.x, q.y, q.z}}, {"fixed_from_moving_translation_m", {t.x, t.y, t.z}},
                 {"shift_m", {found->shiftMeters.x, found->shiftMeters.y, found->shiftMeters.z}},
                 {"rms_plane_m", found->rmsPlaneMeters}, {"rms_point_m", found->rmsPointMeters}, {"share", found->share},
                 {"pairs", found->pairs}, {"iterations", found->iterations}};
  answer.text = found->report();
  return answer;
}

struct MeshArguments {
  std::string scan, output;
  double greedy = 0, voxel = 0;
  int poisson = 0;
  bool overwrite = false;
};

Result<Answer> runMesh(const MeshArguments& arguments, const Progress& progress) {
  if (!arguments.overwrite && std::filesystem::exists(arguments.output))
    return fail("The file is there already", arguments.output, "Choose another name or add --overwrite");
  SurfaceOrder order;
  if (arguments.greedy > 0) order.greedy = {arguments.greedy};
  if (arguments.poisson > 0) order.poisson = {arguments.poisson};
  if (arguments.voxel > 0) order.voxelMeters = arguments.voxel;
  const auto summary = meshScan(arguments.scan, arguments.output, order, progress);
  if (!summary) return fail(summary.error());
  Answer answer;
  answer.json = {{"output", arguments.output}, {"points", summary->points}, {"vertices", summary->vertices},
                 {"triangles", summary->triangles}, {"seconds", summary->seconds}};
  answer.text = fmt::format("{}\n  points    {}\n  vertices  {}\n  triangles {}\n  took      {:.1f} s\n", arguments.output, summary->points,
                            summary->vertices, summary->triangles, summary->seconds);
  return answer;
}

}  // namespace

void addClean(Verbs& verbs) {
  auto arguments = std::make_shared<CleanArguments>();
  CLI::App* command = verbs.add("clean", "Thin a scan, drop its outliers, mark its ground, write it anew",
                                [arguments](const Progress& progress) { return runClean(*arguments, progress); });
  command->add_option("scan", arguments->scan, "Scan to read; it is left as it is")->required();
  command->add_option("-o,--output", arguments->output, "Scan to write, by its ending")->required();
  command->add_option("--outliers", arguments->outliers, "NEIGHBOURS,DEVIATIONS of statistical outliers, such as 8,1.0")
      ->check(checkedBy([](const std::string& text) { return parsePair(text, true); }, "K,S"));
  command->add_option("--radius", arguments->radius, "METRES,NEIGHBOURS that a point must have around it, such as 0.1,4")
      ->check(checkedBy([](const std::string& text) { return parsePair(text, false); }, "R,K"));
  command->add_option("--voxel", arguments->voxel, "Keep one point in each cube of this edge, metres")->check(positiveNumber());
  command->add_flag("--ground", arguments->ground, "Classify ground points (class 2)");
  command->add_option("--ground-window", arguments->window, "Widest thing on the ground, metres")->check(positiveNumber());
  command->add_flag("--normals", arguments->normals, "Estimate normals, towards the scan's stations");
  command->add_flag("--overwrite", arguments->overwrite, "Replace the output where it is there");
}

void addRegister(Verbs& verbs) {
  auto arguments = std::make_shared<RegisterArguments>();
  CLI::App* command = verbs.add("register", "Fit a scan to another one and say how well it fits",
                                [arguments](const Progress& progress) { return runRegister(*arguments, progress); });
  command->add_option("moving", arguments->moving, "Scan to move")->required();
  command->add_option("fixed", arguments->fixed, "Scan that stays")->required();
  command->add_option("--reach", arguments->options.reachMeters, "How far apart they may be, metres")->check(positiveNumber());
  command->add_option("--share", arguments->options.leastShare, "Least share of the moving points in the overlap, 0 to 1")->check(numberWithin(0.01, 1.0));
}

void addMesh(Verbs& verbs) {
  auto arguments = std::make_shared<MeshArguments>();
  CLI::App* command = verbs.add("mesh", "Make a surface of a scan",
                                [arguments](const Progress& progress) { return runMesh(*arguments, progress); });
  command->add_option("scan", arguments->scan, "Scan to read")->required();
  command->add_option("-o,--output", arguments->output, "PLY or OBJ to write")->required();
  CLI::Option* greedy = command->add_option("--greedy", arguments->greedy, "Join neighbours by edges of at most this length, metres")->check(positiveNumber());
  command->add_option("--poisson", arguments->poisson, "Poisson reconstruction, depth of its octree, such as 9")->check(CLI::Range(2, 13))->excludes(greedy);
  command->add_option("--voxel", arguments->voxel, "Thin first: one point in each cube of this edge, metres")->check(positiveNumber());
  command->add_flag("--overwrite", arguments->overwrite, "Replace the output where it is there");
}

}  // namespace alidade::cli

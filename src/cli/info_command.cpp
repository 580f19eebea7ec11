// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "cli/command.h"
#include "cloud/store_folder.h"
#include "io/project_store.h"
#include "io/reader_registry.h"
#include "survey/scan_notes.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

struct Description {
  Json json;
  std::string text;
};

Json vec(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

Json boundsJson(const Bounds& bounds) {
  if (bounds.empty()) return nullptr;
  return {{"min", vec(bounds.min)}, {"max", vec(bounds.max)}};
}

std::string boundsText(const Bounds& bounds, bool degrees = false) {
  if (bounds.empty()) return "  bounds    not stated\n";
  if (degrees)
    return fmt::format("  bounds    E {:.8f} … {:.8f}°  N {:.8f} … {:.8f}°  H {:.3f} … {:.3f}\n", bounds.min.x, bounds.max.x, bounds.min.y,
                       bounds.max.y, bounds.min.z, bounds.max.z);
  return fmt::format("  bounds    E {:.3f} … {:.3f}  N {:.3f} … {:.3f}  H {:.3f} … {:.3f} m\n", bounds.min.x, bounds.max.x,
                     bounds.min.y, bounds.max.y, bounds.min.z, bounds.max.z);
}

std::string crsText(const std::string& crs) {
  if (crs.empty()) return "  crs       not stated\n";
  return fmt::format("  crs       {}\n", crs.size() > 100 ? crs.substr(0, 97) + "…" : crs);
}

/// From the header alone: over the rectangle of the bounds, whatever part of it holds points.
std::string densityText(double pointsPerSquareMetre) {
  if (!(pointsPerSquareMetre > 0)) return "";
  const std::string points = pointsPerSquareMetre < 100 ? fmt::format("{:.3g}", pointsPerSquareMetre) : fmt::format("{:.0f}", pointsPerSquareMetre);
  return fmt::format("  density   {} points a square metre of the bounds\n", points);
}

std::string stationsText(const std::vector<Station>& stations) {
  constexpr std::size_t kMost = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(stations.size(), kMost); ++i) {
    const glm::dvec3 at = stations[i].worldFromScanner.translation;
    text += fmt::format("            {}: E {:.3f}  N {:.3f}  H {:.3f} m", stations[i].name.empty() ? std::to_string(i + 1) : stations[i].name,
                        at.x, at.y, at.z);
    if (stations[i].rows > 0) text += fmt::format(", {} rows of {}", stations[i].rows, stations[i].columns);
    text += '\n';
  }
  if (stations.size() > kMost) text += "            …\n";
  return text;
}

Result<Description> describe(const ScanReader& reader, const std::string& path) {
  const auto info = reader.inspect(path);
  if (!info) return fail(info.error());
  const auto notes = reader.notes(path);
  if (!notes) return fail(notes.error());
  const glm::dvec3 size = info->bounds.size();
  const double area = notes->degrees ? 0 : size.x * size.y, density = area > 0 ? static_cast<double>(info->pointCount) / area : 0;
  Description out;
  out.json = {{"kind", "scan"},        {"points", info->pointCount}, {"bounds_m", boundsJson(info->bounds)},
              {"crs", info->crs},      {"scale_m", vec(info->scale)}, {"attributes", info->attributes},
              {"stations", Json::array()}, {"details", info->details}, {"warnings", notes->warnings}};
  out.json["points_per_square_metre"] = area > 0 ? Json(density) : Json(nullptr);
  for (const Station& station : info->stations)
    out.json["stations"].push_back({{"name", station.name}, {"position_m", vec(station.worldFromScanner.translation)},
                                    {"rows", station.rows}, {"columns", station.columns}});
  out.text = fmt::format("  points    {}\n", info->pointCount) + boundsText(info->bounds, notes->degrees) + densityText(density) +
             crsText(info->crs) + fmt::format("  columns   {}\n", fmt::join(info->attributes, ", "));
  if (!info->stations.empty()) out.text += fmt::format("  stations  {}\n", info->stations.size()) + stationsText(info->stations);
  out.text += fmt::format("  format    {}\n", info->details);
  for (const std::string& warning : notes->warnings) out.text += fmt::format("  warning   {}\n", warning);
  return out;
}

Result<Description> describe(const DesignReader& reader, const std::string& path) {
  const auto info = reader.inspect(path);
  if (!info) return fail(info.error());
  Description out;
  out.json = {{"kind", "design"}, {"elements", info->elementCount}, {"schema", info->schema}, {"crs", info->crs},
              {"details", info->details}};
  out.text = fmt::format("  elements  {}\n  schema    {}\n", info->elementCount, info->schema) + crsText(info->crs);
  if (!info->details.empty()) out.text += fmt::format("  format    {}\n", info->details);
  return out;
}

Result<Description> describe(const CameraReader& reader, const std::string& path) {
  const auto set = reader.inspect(path);
  if (!set) return fail(set.error());
  Description out;
  out.json = {{"kind", "cameras"}, {"cameras", Json::array()}, {"poses", set->pictures.size()}, {"details", set->details},
              {"warnings", Json::array()}};
  for (const auto& warning : set->warnings) out.json["warnings"].push_back(warning.what + " (" + warning.where + ")");
  out.text = fmt::format("  poses     {}\n", set->pictures.size());
  for (std::size_t i = 0; i < set->cameras.size(); ++i) {
    const Intrinsics& camera = set->cameras[i];
    const auto& unsized = set->camerasWithoutSize;
    const bool hasSize = std::find(unsized.begin(), unsized.end(), static_cast<int>(i)) == unsized.end();
    const double foldBack = Camera(camera).foldBackRadius();
    out.json["cameras"].push_back({{"model", cameraModelName(camera.model)}, {"width", hasSize ? Json(camera.width) : Json(nullptr)},
                                   {"height", hasSize ? Json(camera.height) : Json(nullptr)}, {"parameters", camera.parameters()},
                                   {"fold_back_radius", std::isfinite(foldBack) ? Json(foldBack) : Json(nullptr)}});
    const std::string size = hasSize ? fmt::format("{} × {} px", camera.width, camera.height) : "of its picture's size";
    out.text += fmt::format("  camera    {} {}, f {:.2f} px", cameraModelName(camera.model), size, camera.fx);
    out.text += std::isfinite(foldBack) ? fmt::format(", folds back at r = {:.3f}\n", foldBack) : "\n";
  }
  return out;
}

Result<Description> describe(const PictureReader& reader, const std::string& path) {
  const auto set = reader.inspect(path);
  if (!set) return fail(set.error());
  Description out;
  out.json = {{"kind", set->isVideo ? "video" : "pictures"}, {"pictures", set->pictures.size()}, {"width", set->width},
              {"height", set->height}, {"frames_per_second", set->framesPerSecond}, {"details", set->details}};
  out.text = fmt::format("  pictures  {}, {} × {} px\n", set->pictures.size(), set->width, set->height);
  if (set->isVideo && !set->pictures.empty()) {
    double shortest = std::numeric_limits<double>::infinity(), longest = 0;
    for (std::size_t i = 1; i < set->pictures.size(); ++i) {
      const double step = set->pictures[i].timeSecs - set->pictures[i - 1].timeSecs;
      shortest = std::min(shortest, step), longest = std::max(longest, step);
    }
    const bool several = set->pictures.size() > 1;
    out.json["duration_s"] = set->pictures.back().timeSecs - set->pictures.front().timeSecs;
    out.json["shortest_step_s"] = several ? Json(shortest) : Json(nullptr);
    out.json["longest_step_s"] = several ? Json(longest) : Json(nullptr);
    out.text += fmt::format("  rate      {:.3f} Hz", set->framesPerSecond);
    if (several && longest > 1.02 * shortest) out.text += fmt::format(", varying: steps of {:.1f} to {:.1f} ms", 1000 * shortest, 1000 * longest);
    out.text += fmt::format("\n  length    {:.3f} s\n", set->pictures.back().timeSecs - set->pictures.front().timeSecs);
  }
  return out;
}

Result<Description> describe(const PointListReader& reader, const std::string& path) {
  const auto list = reader.read(path);
  if (!list) return fail(list.error());
  Bounds bounds;
  for (const auto& point : list->points) bounds.add(point.position);
  Description out;
  out.json = {{"kind", "points"}, {"points", list->points.size()}, {"bounds_m", boundsJson(bounds)}};
  out.text = fmt::format("  points    {}\n", list->points.size()) + boundsText(bounds);
  return out;
}

Result<Description> describeProject(const std::string& path) {
  const auto project = loadProject(path);
  if (!project) return fail(project.error());
  std::size_t posed = 0;
  for (const Frame& frame : project->frames) posed += frame.cameraFromWorld.has_value();
  Description out;
  out.json = {{"kind", "project"}, {"name", project->name}, {"crs", project->crs}, {"scans", project->scans.size()},
              {"designs", project->designs.size()}, {"cameras", project->cameras.size()}, {"frames", project->frames.size()},
              {"frames_with_pose", posed}, {"stake_points", project->stakePoints.size()},
              {"control_points", project->controlPoints.size()}, {"observations", project->observations.size()},
              {"annotations", project->annotations.size()}, {"mounts", Json::array()}, {"source_problems", Json::array()}};
  out.text = fmt::format("  project   {}\n  scans     {}\n  designs   {}\n  frames    {} ({} with a pose)\n", project->name,
                         project->scans.size(), project->designs.size(), project->frames.size(), posed);
  for (const CameraRecord& camera : project->cameras) {
    if (!camera.mount) continue;
    const RigidTransform bodyFromCamera = camera.mount->cameraFromBody.inverse();
    const glm::dvec3& at = bodyFromCamera.translation;
    const glm::dquat& q = bodyFromCamera.rotation;
    const glm::dvec3 &offset = camera.mount->offsetStdM, &turn = camera.mount->rotationStdRad;
    out.json["mounts"].push_back({{"camera", camera.name}, {"body", camera.mount->body}, {"position_on_body_m", {at.x, at.y, at.z}},
                                  {"body_from_camera_wxyz", {q.w, q.x, q.y, q.z}}, {"offset_std_m", {offset.x, offset.y, offset.z}},
                                  {"rotation_std_rad", {turn.x, turn.y, turn.z}}});
    out.text += fmt::format("  mounted   {} at {:.4f} {:.4f} {:.4f} m on {}\n", camera.name, at.x, at.y, at.z, camera.mount->body);
  }
  for (const SourceProblem& problem : checkSources(*project)) {
    out.json["source_problems"].push_back(problem.path + " " + problem.what);
    out.text += fmt::format("  problem   {} {}\n", problem.path, problem.what);
  }
  return out;
}

Result<Description> describeStore(const std::string& path) {
  const auto store = openStore(path);
  if (!store) return fail(store.error());
  Description out;
  out.json = {{"kind", "point_store"}, {"points", 0}, {"bounds_m", nullptr}, {"parts", Json::array()}};
  std::uint64_t points = 0;
  Bounds bounds;
  std::string parts;
  for (const StorePart& part : store->parts) {
    const PartManifest& manifest = part.manifest;
    points += manifest.pointCount;
    bounds.add(part.points->bounds());
    std::vector<std::string> columns;
    for (const AttributeColumn& column : part.points->attributes()) columns.push_back(column.name);
    const char* levels = manifest.levelKind == LevelKind::BlueNoise ? "blue-noise" : "random";
    out.json["parts"].push_back({{"source", manifest.source}, {"points", manifest.pointCount}, {"dropped", manifest.dropped},
                                 {"bounds_m", boundsJson(part.points->bounds())}, {"crs", manifest.info.crs}, {"attributes", columns},
                                 {"stations", manifest.info.stations.size()}, {"levels", levels}, {"nodes", manifest.nodeCount},
                                 {"spacing_m", part.points->medianSpacing()}});
    parts += fmt::format("  part      {}\n            {} points, {} nodes, {} levels, spacing {:.4f} m; {}\n", manifest.source,
                         manifest.pointCount, manifest.nodeCount, levels, part.points->medianSpacing(), fmt::join(columns, ", "));
  }
  out.json["points"] = points;
  out.json["bounds_m"] = boundsJson(bounds);
  out.text = fmt::format("  points    {} in {}\n", points, store->parts.size() == 1 ? "1 part" : fmt::format("{} parts", store->parts.size())) +
             boundsText(bounds) + parts;
  return out;
}

/// By its name, or by its first bytes: a project may have lost its ending.
bool isProject(const std::string& path) {
  if (path.ends_with(".alidade")) return true;
  std::vector<std::byte> head;
  const auto probe = probeFile(path, head);
  return probe && probe->startsWith("SQLite format 3");
}

Result<Description> describeFile(const std::string& path) {
  if (isProject(path)) return describeProject(path);
  if (isStoreFolder(path)) return describeStore(path);
  const auto reader = ReaderRegistry::instance().find(path);
  if (!reader) return fail(reader.error());
  auto described = [&]() -> Result<Description> {
    switch ((*reader)->kind()) {
      case ReaderKind::Scan: return describe(static_cast<const ScanReader&>(**reader), path);
      case ReaderKind::Design: return describe(static_cast<const DesignReader&>(**reader), path);
      case ReaderKind::Cameras: return describe(static_cast<const CameraReader&>(**reader), path);
      case ReaderKind::Pictures: return describe(static_cast<const PictureReader&>(**reader), path);
      case ReaderKind::Points: return describe(static_cast<const PointListReader&>(**reader), path);
    }
    return fail("The reader is of an unknown kind", path);
  }();
  if (described) described->json["reader"] = (*reader)->description().id;
  return described;
}

}  // namespace

void addInfo(Verbs& verbs) {
  auto files = std::make_shared<std::vector<std::string>>();
  CLI::App* command = verbs.add(
      "info", "Say what files hold, from their headers alone", [files](const Progress&) -> Result<Answer> {
        Answer answer;
        answer.json = {{"files", Json::array()}};
        for (const std::string& path : *files) {
          auto described = describeFile(path);
          Json entry = {{"path", path}};
          if (described) {
            entry.update(described->json);
            answer.text += path + "\n" + described->text;
          } else {
            const Error& error = described.error();
            entry["error"] = {{"what", error.what}, {"where", error.where}, {"advice", error.advice}};
            answer.text += path + "\n  error     " + error.text() + "\n";
            answer.failed = true;
          }
          answer.json["files"].push_back(std::move(entry));
        }
        return answer;
      });
  command->add_option("files", *files, "Scans, designs, cameras, pictures, stake-out lists, projects, point stores")->required();
}

}  // namespace alidade::cli

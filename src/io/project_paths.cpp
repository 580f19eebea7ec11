// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/project_paths.h"

#include <filesystem>

namespace alidade {

namespace fs = std::filesystem;

namespace {

fs::path absoluteOf(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  return (error ? path : absolute).lexically_normal();
}

fs::path resolved(const fs::path& path) {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(path, error);
  return error ? path : canonical;
}

bool climbs(const fs::path& relative) { return !relative.empty() && *relative.begin() == ".."; }

template <class P, class Visit>
void visitSources(P& project, const Visit& visit) {
  for (auto& scan : project.scans) visit(scan.source);
  for (auto& design : project.designs) visit(design.source);
  for (auto& video : project.videos) visit(video.source);
  for (auto& trajectory : project.trajectories) visit(trajectory.source);
  for (auto& frame : project.frames) visit(frame.image);
}

}  // namespace

void forEachSource(Project& project, const std::function<void(SourceFile&)>& visit) { visitSources(project, visit); }

void forEachSource(const Project& project, const std::function<void(const SourceFile&)>& visit) {
  visitSources(project, visit);
}

std::string pathRelativeToProject(const std::string& source, const std::string& projectFile) {
  if (source.empty()) return {};
  const fs::path absolute = absoluteOf(source);
  const fs::path folder = absoluteOf(projectFile).parent_path();
  fs::path relative = absolute.lexically_relative(folder);
  if (climbs(relative)) relative = resolved(absolute).lexically_relative(resolved(folder));
  return relative.empty() ? absolute.string() : relative.string();
}

std::string pathFromProject(const std::string& stored, const std::string& projectFile) {
  if (stored.empty()) return {};
  const fs::path relative = fs::path(stored).lexically_normal();
  if (relative.is_absolute()) return relative.string();
  const fs::path folder = absoluteOf(projectFile).parent_path();
  return ((climbs(relative) ? resolved(folder) : folder) / relative).lexically_normal().string();
}

}  // namespace alidade

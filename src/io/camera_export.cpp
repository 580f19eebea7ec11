// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/camera_export.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <span>

#include <fmt/format.h>

#include "io/atomic_file.h"
#include "io/camera_export_parts.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

/// File names, with their folder where two pictures have the same.
Result<void> nameFrames(ExportedSet& set) {
  const auto name = [&](bool withFolder) {
    std::set<std::string> names;
    for (ExportedFrame& each : set.frames) {
      const fs::path path = each.frame->image.path.empty() ? fs::path(each.frame->name) : fs::path(each.frame->image.path);
      each.name = withFolder ? (path.parent_path().filename() / path.filename()).string() : path.filename().string();
      if (each.name.empty()) each.name = each.frame->name;
      names.insert(each.name);
    }
    return names.size() == set.frames.size();
  };
  if (name(false) || name(true)) return {};
  return fail("Two pictures have the same name in folders of the same name", {}, "Rename the pictures or their folders");
}

}  // namespace

CameraFormat cameraFormatOf(const std::string& path) {
  const std::string extension = lowerCase(fs::path(path).extension().string());
  return extension == ".json" ? CameraFormat::Transforms : extension == ".csv" ? CameraFormat::Table : CameraFormat::Colmap;
}

Result<void> writeAtomically(const std::string& path, std::string_view text) {
  auto file = AtomicFile::create(path);
  if (!file) return fail(file.error());
  file->write(std::as_bytes(std::span(text)));
  return file->commit();
}

std::string coefficientBeyond(const Distortion& d, std::string_view allowed) {
  const std::pair<const char*, double> all[] = {
      {"k1", d.k[0]}, {"k2", d.k[1]}, {"k3", d.k[2]}, {"k4", d.k[3]}, {"k5", d.k[4]}, {"k6", d.k[5]}, {"q1", d.q[0]},
      {"q2", d.q[1]}, {"q3", d.q[2]}, {"p1", d.p1},   {"p2", d.p2},   {"t3", d.t[0]}, {"t4", d.t[1]}, {"t5", d.t[2]},
      {"t6", d.t[3]}, {"s1", d.s[0]}, {"s2", d.s[1]}, {"s3", d.s[2]}, {"s4", d.s[3]}, {"shear", d.shear}, {"skew", d.skew},
      {"tauX", d.tauX}, {"tauY", d.tauY}, {"imageSkew", d.imageSkew}};
  for (const auto& [name, value] : all)
    if (value != 0 && allowed.find(name) == std::string_view::npos) return name;
  return {};
}

Result<CameraExport> exportCameras(const Project& project, CameraFormat format, const std::string& path) {
  CameraExport done;
  ExportedSet set;
  std::size_t poseless = 0, cameraless = 0;
  for (const Frame& frame : project.frames) {
    const CameraRecord* camera = project.findCamera(frame.camera);
    poseless += !frame.cameraFromWorld;
    cameraless += frame.cameraFromWorld && !camera && format != CameraFormat::Table;
    if (!frame.cameraFromWorld || (!camera && format != CameraFormat::Table)) continue;
    const auto known = std::find(set.cameras.begin(), set.cameras.end(), camera);
    set.frames.push_back({&frame, static_cast<std::size_t>(known - set.cameras.begin()), {}});
    if (known == set.cameras.end()) set.cameras.push_back(camera);
  }
  if (set.frames.empty())
    return fail("The project has no picture with a camera and a pose", project.path, "Add cameras and poses to it first");
  if (poseless > 0) done.notes.push_back(fmt::format("{} pictures without a pose were left out", poseless));
  if (cameraless > 0) done.notes.push_back(fmt::format("{} pictures without a camera were left out", cameraless));
  if (auto named = nameFrames(set); !named) return fail(named.error());
  done.frames = set.frames.size();
  done.cameras = set.cameras.size();

  Result<void> written;
  switch (format) {
    case CameraFormat::Colmap: written = writeColmap(project, set, path, done); break;
    case CameraFormat::Transforms: written = writeTransforms(set, path); break;
    case CameraFormat::Table:
      written = writePoseTable(set, path);
      done.cameras = 0;
      done.notes.push_back("A table of poses has no lenses: give the calibration along with it");
      break;
  }
  if (!written) return fail(written.error());
  return done;
}

}  // namespace alidade

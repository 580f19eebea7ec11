// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "realitycapture/xmp_reader.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "base/input_file.h"
#include "plugin_api/import_slip.h"
#include "plugin_api/picture_header.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t(16) << 20;
constexpr std::string_view kNamespace = "capturingreality";

struct FolderFiles {
  std::vector<fs::path> sidecars;               ///< by name
  std::map<std::string, fs::path> pictures;     ///< by stem
};

FolderFiles filesOf(const fs::path& folder) {
  FolderFiles files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path& path = it->path();
    const std::string extension = lowerCase(path.extension().string());
    if (extension == ".xmp") files.sidecars.push_back(path);
    else if (!extension.empty() && isPictureExtension(extension.substr(1))) files.pictures.emplace(path.stem().string(), path);
  }
  std::sort(files.sidecars.begin(), files.sidecars.end());
  return files;
}

bool carriesNamespace(const fs::path& sidecar) {
  const auto file = InputFile::open(sidecar.string());
  if (!file) return false;
  std::string head(4096, '\0');
  const auto count = file->readSome(0, std::as_writable_bytes(std::span(head)));
  return count && std::string_view(head).substr(0, *count).find(kNamespace) != std::string_view::npos;
}

/// Sidecars into one set.
class SidecarReader {
 public:
  explicit SidecarReader(const FolderFiles& files) : m_files(files) {}

  Result<void> add(const fs::path& sidecar) {
    const auto text = readTextFile(sidecar.string(), kMaxBytes);
    if (!text) return fail(text.error());
    if (text->find(kNamespace) == std::string::npos) return {};  // some other program's
    const auto picture = m_files.pictures.find(sidecar.stem().string());
    const bool hasPicture = picture != m_files.pictures.end();
    std::optional<glm::ivec2> size;
    if (hasPicture)
      if (const auto header = readPictureHeader(picture->second.string())) size = glm::ivec2(header->width, header->height);
    const auto camera = parseXmp(*text, sidecar.string(), size);
    if (!camera) return fail(camera.error());
    if (!camera->cameraFromWorld) return m_poseless.note(sidecar.string()), Result<void>();
    if (camera->relative) m_relative.note(sidecar.string());
    PosedPicture posed;
    posed.name = hasPicture ? picture->second.filename().string() : sidecar.stem().string();
    posed.cameraFromWorld = camera->cameraFromWorld;
    if (camera->intrinsics) posed.camera = indexOf(*camera->intrinsics);
    else m_lensless[camera->noIntrinsics].note(sidecar.string());
    m_set.pictures.push_back(std::move(posed));
    return {};
  }

  Result<CameraSet> take(const std::string& path) {
    if (m_set.pictures.empty())
      return fail("No XMP file here holds a pose", path, "Export the registration from RealityCapture with Export mode 'Exact' or 'Locked'");
    m_poseless.tell(m_set.warnings, "XMP files hold no pose and were left out");
    m_relative.tell(m_set.warnings, "poses are relative: in the component's own units and axes, not the survey's");
    for (const auto& [why, slip] : m_lensless) slip.tell(m_set.warnings, "lenses were left out: " + why + ". Add a calibration file");
    m_set.details = fmt::format("RealityCapture XMP: {} poses, {} cameras", m_set.pictures.size(), m_set.cameras.size());
    return std::move(m_set);
  }

 private:
  int indexOf(const Intrinsics& intrinsics) {
    auto key = intrinsics.parameters();
    key.insert(key.end(), {double(intrinsics.model), double(intrinsics.width), double(intrinsics.height)});
    const auto [found, isNew] = m_known.emplace(std::move(key), static_cast<int>(m_set.cameras.size()));
    if (isNew) m_set.cameras.push_back(intrinsics);
    return found->second;
  }

  const FolderFiles& m_files;
  CameraSet m_set;
  std::map<std::vector<double>, int> m_known;
  ImportSlip m_poseless, m_relative;
  std::map<std::string, ImportSlip> m_lensless;
};

}  // namespace

ReaderDescription XmpReader::description() const { return {"realitycapture-xmp", "RealityCapture XMP", {"xmp"}}; }

int XmpReader::sniff(const FileProbe& probe) const {
  if (!probe.isFolder) return probe.extension == "xmp" && probe.holds(kNamespace) ? 80 : 0;
  // A folder of pictures stays one: its sidecars count where cameras are asked for.
  constexpr std::size_t kLookAt = 8;
  const FolderFiles files = filesOf(probe.path);
  const std::size_t count = std::min(files.sidecars.size(), kLookAt);
  return std::any_of(files.sidecars.begin(), files.sidecars.begin() + std::ptrdiff_t(count), carriesNamespace) ? 45 : 0;
}

Result<CameraSet> XmpReader::inspect(const std::string& path) const { return read(path, Progress()); }

Result<CameraSet> XmpReader::read(const std::string& path, const Progress& progress) const {
  std::error_code error;
  const bool folder = fs::is_directory(path, error);
  const fs::path parent = fs::path(path).parent_path();
  const FolderFiles files = filesOf(folder ? fs::path(path) : parent.empty() ? fs::path(".") : parent);
  SidecarReader reader(files);
  if (!folder) {
    if (auto added = reader.add(path); !added) return fail(added.error());
    return reader.take(path);
  }
  for (std::size_t i = 0; i < files.sidecars.size(); ++i) {
    if (progress.cancelled()) return fail(cancelledError());
    progress.report(double(i) / double(files.sidecars.size()), "Reading XMP files");
    if (auto added = reader.add(files.sidecars[i]); !added) return fail(added.error());
  }
  return reader.take(path);
}

}  // namespace alidade

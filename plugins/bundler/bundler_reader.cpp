// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bundler/bundler_reader.h"

#include <array>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "bundler/centred_camera.h"
#include "plugin_api/picture_header.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t(2) << 30;
constexpr std::string_view kMagic = "# Bundle file v";
const std::string kAdvice = "Write the file again with Bundler, COLMAP or VisualSFM as bundle.out v0.3";

Result<CentredCamera> cameraOf(NumberStream& numbers) {
  std::array<double, 15> v{};
  for (double& value : v) {
    const auto number = numbers.number();
    if (!number) return fail(number.error());
    value = *number;
  }
  CentredCamera camera{v[0], v[1], v[2], std::nullopt};
  if (camera.f == 0) return camera;  // not registered
  glm::dmat3 rows;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) rows[c][r] = v[std::size_t(3 + 3 * r + c)];
  const auto rotation = nearestRotation(rows);
  if (!rotation) return fail("The camera's matrix is no rotation", numbers.place(), kAdvice);
  camera.glCameraFromWorld = RigidTransform{*rotation, {v[12], v[13], v[14]}};
  return camera;
}

Result<TiePoint> pointOf(NumberStream& numbers) {
  TiePoint point;
  for (int axis = 0; axis < 3; ++axis) {
    const auto number = numbers.number();
    if (!number) return fail(number.error());
    point.world[axis] = *number;
  }
  std::array<std::uint8_t, 3> colour{};
  for (auto& channel : colour) {
    const auto number = numbers.below(256, "colour");
    if (!number) return fail(number.error());
    channel = static_cast<std::uint8_t>(*number);
  }
  point.colour = {colour[0], colour[1], colour[2], 255};
  return point;
}

/// `count (camera key x y)…`
Result<void> viewsOf(NumberStream& numbers, std::size_t point, std::size_t cameras, std::size_t most,
                     std::vector<CentredSighting>& sightings) {
  const auto views = numbers.below(most, "number of views");
  if (!views) return fail(views.error());
  for (std::size_t i = 0; i < *views; ++i) {
    const auto camera = numbers.below(cameras, "camera of a view");
    if (!camera) return fail(camera.error());
    const auto key = numbers.integer();
    if (!key) return fail(key.error());
    const auto x = numbers.number(), y = x ? numbers.number() : x;
    if (!y) return fail(y.error());
    sightings.push_back({point, *camera, {*x, *y}});
  }
  return {};
}

/// The pictures' names as list.txt has them: the first word of a line. Empty where there is no list of that length.
std::vector<std::string> namesBeside(const std::string& path, std::size_t wanted, std::vector<ImportWarning>& warnings) {
  const fs::path folder = fs::path(path).parent_path();
  for (const fs::path& list : {fs::path(path + ".list.txt"), folder / "list.txt", folder / ".." / "list.txt"}) {
    std::error_code error;
    if (!fs::is_regular_file(list, error)) continue;
    const auto text = readTextFile(list.string(), kMaxBytes);
    if (!text) continue;
    std::vector<std::string> names;
    LineReader lines(*text);
    for (std::string_view line, word; lines.next(line);) {
      FieldReader fields(line);
      if (fields.next(word)) names.emplace_back(word);
    }
    if (names.size() == wanted) return names;
    warnings.push_back({fmt::format("The list names {} pictures for {} cameras: it was passed over", names.size(), wanted), list.string()});
  }
  return {};
}

void takeNames(const std::string& path, CameraSet& set) {
  const auto names = namesBeside(path, set.pictures.size(), set.warnings);
  if (names.empty()) {
    set.warnings.push_back({"There is no list.txt beside the file: its cameras have no names and go by order", path});
    return;
  }
  const fs::path folder = fs::path(path).parent_path();
  for (std::size_t i = 0; i < names.size(); ++i) {
    PosedPicture& picture = set.pictures[i];
    picture.name = names[i];
    if (picture.camera < 0) continue;
    for (const fs::path& file : {folder / names[i], folder / ".." / names[i]})
      if (const auto header = readPictureHeader(file.string())) {
        giveSize(set, picture.camera, header->width, header->height);
        break;
      }
  }
}

}  // namespace

Result<CameraSet> parseBundler(std::string_view text, const std::string& path, const Progress& progress) {
  if (!text.starts_with(kMagic)) return fail("The file does not begin as a Bundler model", path, kAdvice);
  std::string_view version;
  LineReader(text).next(version);
  version.remove_prefix(kMagic.size());
  if (trimmed(version) != "0.3") return fail("Bundler models of version " + quotedWords(version) + " are not read, only 0.3", path, kAdvice);

  NumberStream numbers(text, path);
  const std::size_t most = text.size() / 2 + 1;  // a number takes two characters at least
  const auto cameraCount = numbers.below(most, "number of cameras"), pointCount = cameraCount ? numbers.below(most, "number of points") : cameraCount;
  if (!pointCount) return fail(pointCount.error());
  if (*cameraCount == 0) return fail("The file has no cameras", path, kAdvice);
  if (15 * *cameraCount + 7 * *pointCount > most) return fail("The counts promise more than the file holds", numbers.place(), kAdvice);

  std::vector<CentredCamera> cameras;
  std::size_t unregistered = 0;
  for (std::size_t i = 0; i < *cameraCount; ++i) {
    auto camera = cameraOf(numbers);
    if (!camera) return fail(camera.error());
    unregistered += !camera->glCameraFromWorld;
    cameras.push_back(std::move(*camera));
  }
  std::vector<TiePoint> points;
  std::vector<CentredSighting> sightings;
  for (std::size_t i = 0; i < *pointCount; ++i) {
    if (i % 1024 == 0) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(numbers.fraction(), "Reading points");
    }
    auto point = pointOf(numbers);
    if (!point) return fail(point.error());
    points.push_back(std::move(*point));
    if (auto views = viewsOf(numbers, i, *cameraCount, most, sightings); !views) return fail(views.error());
  }
  if (!numbers.atEnd()) return fail("The file goes on after its last point: its counts are wrong", numbers.place(), kAdvice);
  auto set = cameraSetOf(cameras, std::move(points), sightings, path);
  if (!set) return set;
  if (unregistered > 0) set->warnings.push_back({fmt::format("{} cameras were not registered and have no pose", unregistered), path});
  set->details = fmt::format("Bundler model: {} cameras, {} points", *cameraCount, *pointCount);
  return set;
}

ReaderDescription BundlerReader::description() const { return {"bundler", "Bundler model", {"out"}}; }

int BundlerReader::sniff(const FileProbe& probe) const { return !probe.isFolder && probe.startsWith(kMagic) ? 90 : 0; }

Result<CameraSet> BundlerReader::inspect(const std::string& path) const { return read(path, Progress()); }

Result<CameraSet> BundlerReader::read(const std::string& path, const Progress& progress) const {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return fail(text.error());
  auto set = parseBundler(*text, path, progress);
  if (set) takeNames(path, *set);
  return set;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/scan_cleaning.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include <fmt/format.h>

#include "app/scan_source.h"
#include "io/reader_registry.h"

namespace alidade {

namespace {

constexpr std::uint8_t kUnclassified = 1, kGround = 2;  // ASPRS LAS 1.4 R15, table 17

/// The positions of a scan and what normals need beside them.
struct Positions {
  ScanInfo info;
  ScanNotes notes;
  std::vector<glm::dvec3> world;
  std::vector<std::uint16_t> scanner;  ///< empty, or one a point
  std::vector<glm::vec3> normal;       ///< empty, or one a point
  std::vector<ImportWarning> warnings;

  std::vector<glm::dvec3> viewpoints() const {
    std::vector<glm::dvec3> points;
    for (const Station& station : info.stations) points.push_back(station.worldFromScanner.translation);
    return points;
  }
};

Result<Positions> readPositions(const std::string& path, const Progress& progress) {
  Positions positions;
  const auto source = openScan(path, &positions.warnings);
  if (!source) return fail(source.error());
  positions.info = source->info, positions.notes = source->notes;
  const auto read = source->read(
      [&](PointBatch& batch) {
        const auto append = [&](auto& to, const auto& from) {
          // A column that not all batches have is of no use.
          if (to.size() == positions.world.size()) to.insert(to.end(), from.begin(), from.end());
        };
        append(positions.scanner, batch.scanner);
        append(positions.normal, batch.normal);
        positions.world.insert(positions.world.end(), batch.position.begin(), batch.position.end());
        return true;
      },
      progress);
  if (!read) return fail(read.error());
  if (positions.world.empty()) return fail("The scan has no points", path, "Choose another scan");
  if (positions.world.size() >= UINT32_MAX) return fail("The scan has too many points for this", path, "Split it");
  if (positions.scanner.size() != positions.world.size()) positions.scanner.clear();
  if (positions.normal.size() != positions.world.size()) positions.normal.clear();
  return positions;
}

template <class T>
void keepOnly(std::vector<T>& values, const KeepMask& keep) {
  if (values.size() != keep.size()) return;
  std::size_t to = 0;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) values[to++] = values[i];
  values.resize(to);
}

/// What is left of a scan after some steps: numbers in file order.
struct Survivors {
  Positions positions;
  std::vector<std::uint32_t> number;

  Result<std::uint64_t> apply(const Result<KeepMask>& keep) {
    if (!keep) return fail(keep.error());
    const std::size_t before = number.size();
    keepOnly(positions.world, *keep);
    keepOnly(positions.scanner, *keep);
    keepOnly(positions.normal, *keep);
    keepOnly(number, *keep);
    return before - number.size();
  }
};

bool sameFile(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::equivalent(a, b, ignored);
}

/// The chosen points of the file, with their new columns, to the sink.
Result<void> writeChosen(const std::string& source, const Survivors& survivors, const KeepMask& ground, const std::vector<glm::vec3>& normals,
                         ScanSink& sink, const Progress& progress) {
  const auto scan = openScan(source, nullptr);
  if (!scan) return fail(scan.error());
  std::size_t next = 0, first = 0;
  std::optional<Error> failure;
  const auto read = scan->read(
      [&](PointBatch& batch) {
        std::vector<std::uint32_t> chosen;
        const std::size_t from = next;
        for (; next < survivors.number.size() && survivors.number[next] < first + batch.size(); ++next)
          chosen.push_back(static_cast<std::uint32_t>(survivors.number[next] - first));
        first += batch.size();
        if (chosen.empty()) return true;
        PointBatch some = batch.chosen(chosen);
        if (!ground.empty()) {
          if (some.classification.empty()) some.classification.resize(some.size(), kUnclassified);
          for (std::size_t i = 0; i < some.size(); ++i) {
            std::uint8_t& value = some.classification[i];
            value = ground[from + i] ? kGround : value == kGround ? kUnclassified : value;
          }
        }
        if (!normals.empty())
          some.normal.assign(normals.begin() + static_cast<std::ptrdiff_t>(from), normals.begin() + static_cast<std::ptrdiff_t>(next));
        if (auto added = sink.add(some, std::nullopt); !added) failure = added.error();
        return !failure;
      },
      progress);
  if (!read) return fail(read.error());
  if (failure) return fail(*failure);
  if (next != survivors.number.size()) return fail("The scan changed while it was cleaned", source, "Try again when nothing writes to it");
  return {};
}

}  // namespace

Result<ScanCleaningSummary> cleanScan(const std::string& source, const std::string& target, const ScanCleaning& cleaning, const Progress& progress) {
  if (sameFile(source, target)) return fail("A scan is not cleaned in place", target, "Name another file for the cleaned scan");
  const auto writer = ReaderRegistry::instance().findWriter(target);
  if (!writer) return fail(writer.error());
  if ((*writer)->isTree()) return fail("A cleaned scan is not written as a tree", target, "Write it as LAS or LAZ");
  auto read = readPositions(source, progress.part(0, 0.25));
  if (!read) return fail(read.error());
  Survivors survivors{std::move(*read), {}};
  survivors.number.resize(survivors.positions.world.size());
  for (std::size_t i = 0; i < survivors.number.size(); ++i) survivors.number[i] = static_cast<std::uint32_t>(i);
  ScanCleaningSummary summary;
  summary.read = survivors.number.size();
  for (const ImportWarning& warning : survivors.positions.warnings) summary.notes.push_back(warning.what + " (" + warning.where + ")");

  const std::vector<glm::dvec3>& points = survivors.positions.world;
  const auto step = [&](std::uint64_t& dropped, const Result<KeepMask>& keep) -> Result<void> {
    const auto count = survivors.apply(keep);
    if (!count) return fail(count.error());
    dropped = *count;
    return {};
  };
  if (cleaning.outliers)
    if (auto ok = step(summary.outliers, removeStatisticalOutliers(points, *cleaning.outliers, progress.part(0.25, 0.4))); !ok) return fail(ok.error());
  if (cleaning.radius)
    if (auto ok = step(summary.lonely, removeRadiusOutliers(points, *cleaning.radius, progress.part(0.4, 0.5))); !ok) return fail(ok.error());
  if (cleaning.voxelMeters)
    if (auto ok = step(summary.thinned, thinByVoxel(points, *cleaning.voxelMeters, progress.part(0.5, 0.55))); !ok) return fail(ok.error());
  if (points.empty()) return fail("Nothing of the scan is left", source, "Clean less strictly");

  KeepMask ground;
  if (cleaning.ground) {
    auto mask = classifyGround(points, *cleaning.ground, progress.part(0.55, 0.65));
    if (!mask) return fail(mask.error());
    ground = std::move(*mask);
    summary.ground = static_cast<std::uint64_t>(std::count(ground.begin(), ground.end(), 1));
  }
  std::vector<glm::vec3> normals;
  if (cleaning.normals) {
    auto estimated = estimateNormals(points, survivors.positions.viewpoints(), survivors.positions.scanner, *cleaning.normals, progress.part(0.65, 0.75));
    if (!estimated) return fail(estimated.error());
    normals = std::move(*estimated);
    if (survivors.positions.info.stations.empty()) summary.notes.push_back("The scan has no stations: normals look up");
  }

  ScanWriteOptions options;
  options.info = survivors.positions.info, options.notes = survivors.positions.notes;
  options.info.pointCount = points.size();
  options.info.bounds = Bounds{};
  for (const glm::dvec3& p : points) options.info.bounds.add(p);
  auto sink = (*writer)->create(target, options);
  if (!sink) return fail(sink.error());
  if (auto ok = writeChosen(source, survivors, ground, normals, **sink, progress.part(0.75, 1.0)); !ok) return fail(ok.error());
  if (auto ok = (*sink)->finish(); !ok) return fail(ok.error());
  for (const std::string& remark : (*sink)->remarks()) summary.notes.push_back(remark);
  summary.written = points.size();
  return summary;
}

Result<Registration> registerScanFiles(const std::string& moving, const std::string& fixed, const RegistrationOptions& options,
                                       const Progress& progress) {
  const auto a = readPositions(moving, progress.part(0, 0.2));
  if (!a) return fail(a.error());
  const auto b = readPositions(fixed, progress.part(0.2, 0.4));
  if (!b) return fail(b.error());
  auto found = registerScan(a->world, b->world, options, progress.part(0.4, 1.0));
  if (!found) return fail(isCancelled(found.error()) ? found.error() : found.error().in(moving + " to " + fixed));
  return found;
}

Result<void> moveScan(const std::string& source, const std::string& target, const RigidTransform& targetFromSource, const Progress& progress) {
  if (sameFile(source, target)) return fail("A scan is not moved in place", target, "Name another file for the moved scan");
  const auto writer = ReaderRegistry::instance().findWriter(target);
  if (!writer) return fail(writer.error());
  if ((*writer)->isTree()) return fail("A moved scan is not written as a tree", target, "Write it as LAS or LAZ");
  const auto scan = openScan(source, nullptr);
  if (!scan) return fail(scan.error());
  ScanWriteOptions options;
  options.info = scan->info, options.notes = scan->notes;
  for (Station& station : options.info.stations) station.worldFromScanner = targetFromSource * station.worldFromScanner;
  const Bounds& from = scan->info.bounds;
  options.info.bounds = Bounds{};
  for (int corner = 0; corner < 8 && !from.empty(); ++corner)
    options.info.bounds.add(targetFromSource * glm::dvec3((corner & 1 ? from.max : from.min).x, (corner & 2 ? from.max : from.min).y,
                                                          (corner & 4 ? from.max : from.min).z));
  auto sink = (*writer)->create(target, options);
  if (!sink) return fail(sink.error());
  Result<void> added;
  const auto read = scan->read(
      [&](PointBatch& batch) {
        for (glm::dvec3& p : batch.position) p = targetFromSource * p;
        for (glm::vec3& n : batch.normal) n = glm::vec3(targetFromSource.rotation * glm::dvec3(n));
        added = (*sink)->add(batch, std::nullopt);
        return added.has_value();
      },
      progress);
  if (!read) return fail(read.error());
  if (!added) return fail(added.error());
  if (progress.cancelled()) return fail(cancelledError());
  return (*sink)->finish();
}

Result<SurfaceSummary> meshScan(const std::string& source, const std::string& target, const SurfaceOrder& order, const Progress& progress) {
  if (order.greedy.has_value() == order.poisson.has_value()) return fail("A surface is made either greedily or by Poisson", target, "Choose one");
  if (sameFile(source, target)) return fail("A surface does not replace its scan", target, "Name another file");
  if (!target.ends_with(".ply") && !target.ends_with(".obj"))
    return fail("A surface is written as .ply or .obj", target, "Choose one of these endings");
  auto positions = readPositions(source, progress.part(0, 0.2));
  if (!positions) return fail(positions.error());
  if (order.voxelMeters) {
    const auto keep = thinByVoxel(positions->world, *order.voxelMeters, progress.part(0.2, 0.3));
    if (!keep) return fail(keep.error());
    keepOnly(positions->scanner, *keep);
    keepOnly(positions->normal, *keep);
    keepOnly(positions->world, *keep);
  }
  if (positions->normal.empty()) {
    auto normals = estimateNormals(positions->world, positions->viewpoints(), positions->scanner, {}, progress.part(0.3, 0.5));
    if (!normals) return fail(normals.error());
    positions->normal = std::move(*normals);
  }
  const auto start = std::chrono::steady_clock::now();
  const auto mesh = order.greedy ? meshGreedily(positions->world, positions->normal, *order.greedy, progress.part(0.5, 0.95))
                                 : meshByPoisson(positions->world, positions->normal, *order.poisson, progress.part(0.5, 0.95));
  if (!mesh) return fail(mesh.error());
  SurfaceSummary summary{positions->world.size(), mesh->vertices.size(), mesh->triangles.size(),
                         std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
  if (auto ok = writeSurface(*mesh, target); !ok) return fail(ok.error());
  return summary;
}

}  // namespace alidade

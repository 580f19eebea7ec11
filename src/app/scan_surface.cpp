// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/scan_surface.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>

#include "base/input_file.h"
#include "cloud/byte_pack.h"
#include "io/atomic_file.h"

namespace alidade {

namespace {

constexpr std::uint64_t kBatch = 100'000, kMostReturns = 40'000'000, kLargePart = 20'000'000;
constexpr std::uint64_t kMagic = 0x0146'5255'5349'4c41ull;  // "ALISURF", version 1
constexpr std::size_t kHeadBytes = 2 * sizeof(std::uint64_t);

static_assert(sizeof(OccluderBlock) == 36 && sizeof(OccluderPack) == 768, "they stand in files as they lie");

std::size_t stationOf(const PointBatch& batch, std::size_t i) {
  return batch.scanner.empty() ? 0 : batch.scanner[i];
}

bool forBatches(const PointStore& store, const Progress& progress, const char* what, const std::function<void(PointBatch&)>& take) {
  for (std::uint64_t first = 0; first < store.pointCount(); first += kBatch) {
    if (progress.cancelled()) return false;
    progress.report(static_cast<double>(first) / static_cast<double>(store.pointCount()), what);
    PointBatch batch = store.batch(first, std::min(kBatch, store.pointCount() - first));
    take(batch);
  }
  return true;
}

/// Runs of stations whose returns can be held together.
std::vector<std::vector<std::uint8_t>> stationGroups(const PointStore& store, std::size_t stations, std::uint64_t most) {
  std::vector<std::uint64_t> returns(stations);
  const AttributeColumn* scanner = store.attribute("scanner");
  for (std::uint64_t i = 0; scanner && i < store.pointCount(); ++i)
    if (const auto s = static_cast<std::size_t>(scanner->at(i)); s < stations) ++returns[s];
  if (!scanner) returns[0] = store.pointCount();  // all are station 0's (OccluderMeshBuilder::add)
  std::vector<std::vector<std::uint8_t>> groups;
  std::uint64_t held = most;
  for (std::size_t s = 0; s < stations; ++s) {
    if (returns[s] == 0 || returns[s] > most) continue;
    if (held + returns[s] > most) {
      groups.emplace_back(stations);
      held = 0;
    }
    groups.back()[s] = 1;
    held += returns[s];
  }
  return groups;
}

void append(const OccluderMesh& mesh, OccluderMesh& all) {
  all.origins = mesh.origins;
  const auto firstPack = static_cast<std::uint32_t>(all.packs.size());
  for (OccluderBlock block : mesh.blocks) {
    block.firstPack += firstPack;
    all.blocks.push_back(block);
  }
  all.packs.insert(all.packs.end(), mesh.packs.begin(), mesh.packs.end());
  all.returns += mesh.returns, all.mergedQuads += mesh.mergedQuads, all.cellQuads += mesh.cellQuads;
  all.borderSquares += mesh.borderSquares, all.withoutGrid += mesh.withoutGrid;
}

bool hasGrid(const PointStore& store, const std::vector<Station>& stations) {
  return !stations.empty() && store.attribute("row") && store.attribute("column");
}

std::string surfacePath(const std::string& storePath, const StorePart& part) {
  return (std::filesystem::path(storePath) / part.manifest.folder / "surface.bin").string();
}

std::vector<std::byte> packed(const OccluderMesh& mesh, const PartManifest& part) {
  BytePacker body;
  body.put(part.nodesChecksum), body.put(part.pointCount);
  body.put(mesh.returns), body.put(mesh.mergedQuads), body.put(mesh.cellQuads), body.put(mesh.borderSquares), body.put(mesh.withoutGrid);
  body.putAll(mesh.origins), body.putAll(mesh.blocks), body.putAll(mesh.packs);
  return std::move(body.bytes);
}

/// Nothing where the bytes are not this part's surface.
std::optional<OccluderMesh> unpacked(std::span<const std::byte> bytes, const PartManifest& part) {
  ByteUnpacker in(bytes);
  if (in.get<std::uint64_t>() != part.nodesChecksum || in.get<std::uint64_t>() != part.pointCount) return std::nullopt;
  OccluderMesh mesh;
  mesh.returns = in.get<std::uint64_t>(), mesh.mergedQuads = in.get<std::uint64_t>(), mesh.cellQuads = in.get<std::uint64_t>();
  mesh.borderSquares = in.get<std::uint64_t>(), mesh.withoutGrid = in.get<std::uint64_t>();
  mesh.origins = in.getAll<glm::dvec3>(), mesh.blocks = in.getAll<OccluderBlock>(), mesh.packs = in.getAll<OccluderPack>();
  const auto sound = [&](const OccluderBlock& block) {
    return block.station < mesh.origins.size() && block.firstPack <= mesh.packs.size() && block.packCount <= mesh.packs.size() - block.firstPack;
  };
  if (!in.ok() || !std::ranges::all_of(mesh.blocks, sound)) return std::nullopt;
  return mesh;
}

std::optional<OccluderMesh> readSurface(const std::string& path, const PartManifest& part) {
  const auto file = InputFile::open(path);
  if (!file || file->size() < kHeadBytes) return std::nullopt;
  std::vector<std::byte> bytes(file->size());
  if (!file->readAt(0, bytes)) return std::nullopt;
  ByteUnpacker head(bytes);
  const auto body = std::span(bytes).subspan(kHeadBytes);
  if (head.get<std::uint64_t>() != kMagic || head.get<std::uint64_t>() != checksumOf(body)) return std::nullopt;
  return unpacked(body, part);
}

bool writeSurface(const std::string& path, const OccluderMesh& mesh, const PartManifest& part) {
  const std::vector<std::byte> body = packed(mesh, part);
  BytePacker head;
  head.put(kMagic), head.put(checksumOf(body));
  auto file = AtomicFile::create(path);
  return file && file->write(head.bytes) && file->write(body) && file->commit();
}

bool isWritable(const std::string& folder) {
  auto probe = AtomicFile::create(folder + "/surface.bin");
  return probe.has_value();
}

std::shared_ptr<const OccluderMesh> shared(OccluderMesh mesh) {
  return mesh.packs.empty() ? nullptr : std::make_shared<const OccluderMesh>(std::move(mesh));
}

std::optional<OccluderMesh> join(const PointStore& store, const std::vector<Station>& stations, std::uint64_t mostReturns,
                                 const Progress& progress) {
  OccluderMesh all;
  const auto groups = stationGroups(store, stations.size(), mostReturns);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    OccluderMeshBuilder builder(stations);
    const double share = 1.0 / static_cast<double>(groups.size());
    const Progress part = progress.part(share * static_cast<double>(g), share * static_cast<double>(g + 1));
    std::vector<std::uint32_t> chosen;
    const bool done = forBatches(store, part, "Joining the scanner's grid", [&](PointBatch& batch) {
      chosen.clear();
      for (std::size_t i = 0; i < batch.size(); ++i)
        if (const std::size_t s = stationOf(batch, i); s < stations.size() && groups[g][s]) chosen.push_back(static_cast<std::uint32_t>(i));
      if (chosen.size() == batch.size()) builder.add(batch);
      else if (!chosen.empty()) builder.add(batch.chosen(chosen));
    });
    if (!done) return std::nullopt;
    append(builder.build(), all);
  }
  return all;
}

}  // namespace

std::shared_ptr<const OccluderMesh> joinGrids(const PointStore& store, const std::vector<Station>& stations, const Progress& progress,
                                              std::uint64_t mostReturns) {
  if (!hasGrid(store, stations)) return nullptr;
  auto mesh = join(store, stations, mostReturns, progress);
  return mesh ? shared(std::move(*mesh)) : nullptr;
}

std::shared_ptr<const OccluderMesh> surfaceOfPart(const std::string& storePath, const StorePart& part, const Progress& progress) {
  if (!hasGrid(*part.points, part.manifest.info.stations)) return nullptr;
  const std::string path = surfacePath(storePath, part);
  if (auto kept = readSurface(path, part.manifest)) return shared(std::move(*kept));
  if (part.points->pointCount() >= kLargePart && !isWritable(std::filesystem::path(path).parent_path().string())) return nullptr;
  auto mesh = join(*part.points, part.manifest.info.stations, kMostReturns, progress);
  if (!mesh) return nullptr;
  // Where it cannot be kept, it is joined again the next time.
  (void)writeSurface(path, *mesh, part.manifest);
  return shared(std::move(*mesh));
}

void keepSurfaces(const StoreFolder& store, const Progress& progress) {
  const double share = 1.0 / static_cast<double>(std::max<std::size_t>(1, store.parts.size()));
  for (std::size_t i = 0; i < store.parts.size() && !progress.cancelled(); ++i)
    (void)surfaceOfPart(store.path, store.parts[i], progress.part(share * static_cast<double>(i), share * static_cast<double>(i + 1)));
}

}  // namespace alidade

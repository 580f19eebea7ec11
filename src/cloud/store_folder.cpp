// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/store_folder.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>

#include <fmt/format.h>

#include "cloud/byte_pack.h"
#include "cloud/disk.h"
#include "cloud/file_sink.h"
#include "cloud/store_data.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

constexpr const char* kAdvice = "Index the scans again";

/// What a part's spans show: the mapped columns, and the tables as read.
struct PartOwner {
  std::vector<MappedFile> columns;
  std::vector<std::uint32_t> tables;
};

Result<MappedFile> openSized(const std::string& path, std::uint64_t bytes) {
  auto file = MappedFile::open(path);
  if (file && file->bytes().size() != bytes)
    return fail(fmt::format("A file of the point store has {} bytes where {} are expected", file->bytes().size(), bytes), path, kAdvice);
  return file;
}

/// A file that is read whole: its bytes are looked at once, and then they are what was checked.
template <class T>
Result<std::vector<T>> readWhole(const std::string& path, std::uint64_t count, std::size_t each, std::uint64_t checksum) {
  const auto file = openSized(path, count * each);
  if (!file) return fail(file.error());
  std::vector<T> values(file->bytes().size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), file->bytes().data(), file->bytes().size());
  if (checksumOf(std::as_bytes(std::span(values))) != checksum)
    return fail("A file of the point store is damaged: its checksum is wrong", path, kAdvice);
  return values;
}

}  // namespace

bool isStoreFolder(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return false;
  std::string name = fs::path(path).filename().string();
  if (name.empty()) name = fs::path(path).parent_path().filename().string();
  if (name.ends_with(".alidade-points")) return true;
  std::ifstream file(fs::path(path) / kManifestName, std::ios::binary);
  std::string head(256, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.find(fmt::format("\"{}\"", kManifestFormat)) != std::string::npos;
}

Result<StorePart> openPart(const std::string& folder, const PartManifest& manifest) {
  auto owner = std::make_shared<PartOwner>();
  PointStoreData data;
  data.lattice = manifest.lattice;
  data.schema = manifest.schema;
  data.info = manifest.info;
  data.levelKind = manifest.levelKind;
  data.law = manifest.law;
  data.lawShift = manifest.lawShift;
  const auto nodes = readWhole<std::byte>(folder + "/nodes.bin", manifest.nodeCount, kNodeBytes, manifest.nodesChecksum);
  if (!nodes) return fail(nodes.error());
  unpackNodes(*nodes, data);
  auto tables = readWhole<std::uint32_t>(folder + "/" + columnFileName(PartSink::kTables), manifest.tableCount,
                                         sizeof(std::uint32_t), manifest.tablesChecksum);
  if (!tables) return fail(tables.error());
  owner->tables = std::move(*tables);
  data.tables = owner->tables;
  const auto map = [&](std::size_t column) -> Result<std::span<const std::byte>> {
    auto file = openSized(folder + "/" + columnFileName(column), manifest.pointCount * manifest.columnWidth(column));
    if (!file) return fail(file.error());
    owner->columns.push_back(std::move(*file));
    return owner->columns.back().bytes();
  };
  const auto points = map(PartSink::kPoints);
  if (!points) return fail(points.error());
  data.points = {reinterpret_cast<const DisplayPoint*>(points->data()), points->size() / sizeof(DisplayPoint)};
  const auto exact = map(PartSink::kExact);
  if (!exact) return fail(exact.error());
  data.exact = *exact;
  for (std::size_t c = 0; c < manifest.schema.columns.size(); ++c) {
    const auto column = map(PartSink::kFirstAttribute + c);
    if (!column) return fail(column.error());
    data.columns.push_back(*column);
  }
  if (!isSound(data)) return fail("The point store is damaged: its nodes do not fit its points", folder, kAdvice);
  data.owner = std::move(owner);
  return StorePart{manifest, std::make_shared<const PointStore>(std::move(data))};
}

Result<StoreFolder> openStore(const std::string& path) {
  try {
    std::error_code ignored;
    const std::string manifestPath = (fs::path(path) / kManifestName).string();
    if (!fs::is_directory(path, ignored)) return fail("There is no point store here", path, "Index scans first");
    if (!fs::exists(manifestPath, ignored))
      return fail("The point store is not finished: it has no manifest", path, "Index the same scans again to go on");
    const auto manifests = readManifest(manifestPath);
    if (!manifests) return fail(manifests.error());
    StoreFolder store;
    store.path = path;
    for (const PartManifest& manifest : *manifests) {
      auto part = openPart((fs::path(path) / manifest.folder).string(), manifest);
      if (!part) return fail(part.error());
      store.parts.push_back(std::move(*part));
    }
    return store;
  } catch (const std::bad_alloc&) {
    return fail("There is not enough memory to open the point store", path, "Close other programs");
  }
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// A point store's folder from outside: opened as it is, and once more with its checksums made to fit, so that
// damage gets past them. What opens can be walked over, chosen from and read, to the last column.
//
// An input is a folder in one piece: {u8 file, u32 size, bytes} after another, files as kFiles names them.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "cloud/byte_pack.h"
#include "cloud/point_summary.h"
#include "cloud/selection.h"
#include "cloud/store_folder.h"

namespace {

using namespace alidade;
using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 16> kFiles = {
    "manifest.json", "part-0001/nodes.bin", "part-0001/tables.bin", "part-0001/points.bin",
    "part-0001/exact.bin", "part-0001/column-001.bin", "part-0001/column-002.bin", "part-0001/column-003.bin",
    "part-0001/column-004.bin", "part-0001/column-005.bin", "part-0001/column-006.bin", "part-0001/column-007.bin",
    "part-0001/column-008.bin", "part-0001/column-009.bin", "part-0001/column-010.bin", "part-0001/column-011.bin"};
using Contents = std::array<std::string, kFiles.size()>;

struct Workplace {
  std::string folder;
  Workplace() {
    char name[] = "/tmp/alidade_store_fuzz_XXXXXX";
    if (!::mkdtemp(name)) std::abort();
    folder = name;
    if (::mkdir((folder + "/part-0001").c_str(), 0700) != 0) std::abort();
  }
  ~Workplace() {
    for (const char* file : kFiles) ::unlink((folder + "/" + file).c_str());
    ::rmdir((folder + "/part-0001").c_str());
    ::rmdir(folder.c_str());
  }
};

Contents unpack(const std::uint8_t* data, std::size_t size) {
  Contents contents;
  for (std::size_t at = 0; at + 5 <= size;) {
    std::uint32_t bytes;
    std::memcpy(&bytes, data + at + 1, sizeof bytes);
    const std::size_t file = data[at] % kFiles.size();
    at += 5;
    const std::size_t count = std::min<std::size_t>(bytes, size - at);
    contents[file].assign(reinterpret_cast<const char*>(data + at), count);
    at += count;
  }
  return contents;
}

void write(const std::string& folder, const Contents& contents) {
  for (std::size_t i = 0; i < kFiles.size(); ++i) {
    const int file = ::open((folder + "/" + kFiles[i]).c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    if (file < 0 || ::write(file, contents[i].data(), contents[i].size()) != static_cast<ssize_t>(contents[i].size())) std::abort();
    ::close(file);
  }
}

std::uint64_t checksumOfText(const std::string& text) {
  return checksumOf(std::as_bytes(std::span(text)));
}

/// False where the manifest is nothing to mend.
bool mend(Contents& contents) {
  try {
    Json manifest = Json::parse(contents[0]);
    Json& part = manifest.at("parts").at(0);
    part.at("nodes").at("checksum") = checksumOfText(contents[1]);
    part.at("tables").at("checksum") = checksumOfText(contents[2]);
    manifest.at("checksum") = checksumOfText(manifest.at("parts").dump());
    contents[0] = manifest.dump();
    return true;
  } catch (const Json::exception&) {
    return false;
  }
}

void use(const PointStore& store) {
  const Camera camera(*Intrinsics::fromParameters(CameraModel::OpenCv5, 320, 240, {200, 200, 159.5, 119.5, -0.1, 0.02, 0, 0, 0}));
  const glm::dvec3 middle = store.bounds().empty() ? glm::dvec3(0) : store.bounds().centre();
  for (const glm::dvec3& eye : {middle, middle + glm::dvec3(-10, -7, 4)}) {
    const auto view = RigidTransform::cameraLookingAt(eye, middle + glm::dvec3(3, 1, 0));
    for (const double density : {1.0, 0.3}) {
      SelectionOptions options;
      options.density = density;
      for (const Selection& selection : {select(store, camera, view, options), selectAll(store, camera, view)})
        for (const SelectedRange& range : selection.ranges)
          if (range.first > store.pointCount() || range.count > store.pointCount() - range.first) std::abort();
    }
  }
  const std::uint64_t count = store.pointCount();
  for (std::uint64_t p = 0; p < count; p += 1 + count / 50) {
    (void)store.nodeOf(p), (void)store.sourcePosition(p), (void)store.sourceColour(p);
    for (const AttributeColumn& column : store.attributes()) (void)column.at(p, column.components - 1);
  }
  if (store.batch(0, count).size() != count) std::abort();
  for (const double share : {0.0, 0.5, 1.0}) (void)store.levelOfShare(share);
  (void)summarise(store);
}

void tryFolder(const std::string& folder) {
  const auto store = openStore(folder);
  if (!store && store.error().what.empty()) std::abort();
  if (store)
    for (const StorePart& part : store->parts) use(*part.points);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Workplace workplace;
  Contents contents = unpack(data, size);
  write(workplace.folder, contents);
  tryFolder(workplace.folder);
  if (!mend(contents)) return 0;
  write(workplace.folder, contents);
  tryFolder(workplace.folder);
  return 0;
}

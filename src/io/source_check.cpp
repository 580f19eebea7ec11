// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <filesystem>
#include <set>
#include <span>
#include <vector>

#include <QCryptographicHash>

#include "base/input_file.h"
#include "io/project_paths.h"
#include "io/project_store.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kEndBytes = std::uint64_t(1) << 20;
constexpr std::uint64_t kBlockBytes = std::uint64_t(1) << 16;
constexpr std::uint64_t kBlocks = 64;

/// Offset and length of what is hashed: all of a file up to 6 MiB; else the first and the last MiB
/// and 64 blocks, block i starting (i + 1) / 65 of the way from the first MiB's end to the last
/// place where a block fits before the last MiB.
std::vector<std::pair<std::uint64_t, std::uint64_t>> hashedParts(std::uint64_t size) {
  if (size <= 2 * kEndBytes + kBlocks * kBlockBytes) return {{0, size}};
  std::vector<std::pair<std::uint64_t, std::uint64_t>> parts = {{0, kEndBytes}};
  const std::uint64_t room = size - 2 * kEndBytes - kBlockBytes;
  for (std::uint64_t i = 0; i < kBlocks; ++i) {
    // Split so that no product overflows.
    const std::uint64_t along = room / (kBlocks + 1) * (i + 1) + room % (kBlocks + 1) * (i + 1) / (kBlocks + 1);
    parts.emplace_back(kEndBytes + along, kBlockBytes);
  }
  parts.emplace_back(size - kEndBytes, kEndBytes);
  return parts;
}

}  // namespace

Result<SourceFile> describeSource(const std::string& path) {
  if (path.empty()) return fail("No file is named", {}, "Give a file");
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());

  SourceFile source;
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  source.path = error ? path : absolute.lexically_normal().string();
  source.size = file->size();
  QCryptographicHash hash(QCryptographicHash::Sha256);
  hash.addData(QByteArray::number(static_cast<qulonglong>(source.size)));
  std::vector<std::byte> buffer(static_cast<std::size_t>(std::min(source.size, kEndBytes)));
  for (auto [offset, length] : hashedParts(source.size)) {
    while (length > 0) {
      const std::size_t part = static_cast<std::size_t>(std::min<std::uint64_t>(length, buffer.size()));
      if (auto read = file->readAt(offset, std::span(buffer).first(part)); !read) return fail(read.error());
      hash.addData(QByteArrayView(buffer.data(), static_cast<qsizetype>(part)));
      offset += part;
      length -= part;
    }
  }
  source.hash = hash.result().toHex().toStdString();
  return source;
}

std::vector<SourceProblem> checkSources(const Project& project) {
  std::vector<SourceProblem> problems;
  std::set<std::string> checked;
  forEachSource(project, [&](const SourceFile& source) {
    if (source.path.empty() || !checked.insert(source.path).second) return;
    std::error_code error;
    const auto status = fs::status(source.path, error);
    if (error && status.type() != fs::file_type::not_found) {
      problems.push_back({source.path, "cannot be reached: " + error.message()});
      return;
    }
    if (!fs::exists(status)) {
      problems.push_back({source.path, "is missing"});
      return;
    }
    if (fs::is_directory(status)) {
      if (!source.hash.empty()) problems.push_back({source.path, "is a folder now"});
      return;
    }
    // A record without a hash and size was never described: nothing to compare with.
    if (source.hash.empty() && source.size == 0) return;
    const std::uint64_t size = fs::file_size(source.path, error);
    if (!error && size != source.size) {
      problems.push_back({source.path, "has changed since it was added (size " + std::to_string(source.size) + " → " +
                                           std::to_string(size) + " bytes)"});
      return;
    }
    if (source.hash.empty()) return;
    const auto now = describeSource(source.path);
    if (!now) problems.push_back({source.path, "cannot be read: " + now.error().what});
    else if (now->hash != source.hash) problems.push_back({source.path, "has changed since it was added (same size, other content)"});
  });
  return problems;
}

}  // namespace alidade

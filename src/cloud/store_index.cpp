// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/store_index.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <new>
#include <optional>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <fmt/format.h>

#include "base/parallel.h"
#include "cloud/byte_pack.h"
#include "cloud/disk.h"
#include "cloud/file_sink.h"
#include "cloud/part_index.h"
#include "cloud/record_streams.h"
#include "cloud/store_data.h"
#include "cloud/store_folder.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The store's folder, held against a second writer while it lives.
class FolderLock {
 public:
  static Result<std::unique_ptr<FolderLock>> take(const std::string& path) {
    std::unique_ptr<FolderLock> lock(new FolderLock);
    lock->m_folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock->m_folder < 0) return fail(diskError(errno, path));
    // A file system without locks is worked on without.
    if (::flock(lock->m_folder, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
      return fail("Another program is indexing into this point store", path, "Wait until it is done");
    return lock;
  }
  ~FolderLock() {
    if (m_folder >= 0) ::close(m_folder);
  }

 private:
  int m_folder = -1;
};

/// What has to be the same for work to be gone on with; nothing of threads and memory, which do not show.
std::vector<std::byte> purposeOf(const ScanSource& scan, const IndexOptions& options) {
  BytePacker purpose;
  purpose.putText("alidade-points work 3");
  purpose.putText(scan.identity);
  purpose.put(scan.info.pointCount), purpose.put(scan.info.scale), purpose.put(scan.info.offset);
  purpose.put(options.levels), purpose.put(options.seed), purpose.put(options.dimensions), purpose.put(options.leafPoints);
  return std::move(purpose.bytes);
}

/// Says how fast it goes and how long it will take, beside what is done; cancelled where the outer one is.
class TimedProgress {
 public:
  TimedProgress(const Progress& outer, const ScanSource& scan)
      : m_outer(outer), m_name(fs::path(scan.name).filename().string()), m_points(static_cast<double>(scan.info.pointCount)),
        m_inner([this](double fraction, std::string_view) { say(fraction); }) {}
  TimedProgress(const TimedProgress&) = delete;
  const Progress& progress() const { return m_inner; }

 private:
  void say(double fraction) {
    if (m_outer.cancelled()) m_inner.cancel();
    if (m_from < 0) m_from = fraction, m_start = Clock::now();  // work that goes on does not begin at nothing
    const double seconds = secondsSince(m_start), done = fraction - m_from;
    if (seconds > 0.5 && done > 0.005)
      m_outer.report(fraction, fmt::format("Indexing {}: {:.1f} Mpts/s, {:.0f} s left", m_name, m_points * done / seconds / 1e6,
                                           seconds * (1 - fraction) / done));
    else
      m_outer.report(fraction, fmt::format("Indexing {}", m_name));
  }

  const Progress m_outer;
  const std::string m_name;
  const double m_points;
  double m_from = -1;
  Clock::time_point m_start;
  Progress m_inner;
};

PartOptions partOptionsOf(const ScanSource& scan, const IndexOptions& options) {
  PartOptions part;
  part.tree.kind = options.levels;
  part.tree.seed = options.seed;
  part.tree.leafPoints = std::max(1u, options.leafPoints);
  part.dimensions = options.dimensions;
  part.threads = options.threads > 0 ? options.threads : workerCount();
  part.memoryBytes = options.memoryBytes;
  part.cellPoints = cellPointsFor(scan.info.pointCount);
  return part;
}

/// True for what indexing itself makes in a store's folder.
bool isOurs(const std::string& name) {
  if (name == kManifestName || name == fmt::format("{}.new", kManifestName)) return true;
  std::string_view rest = name;
  if (!rest.starts_with("part-")) return false;
  rest.remove_prefix(5);
  if (rest.ends_with(".partial")) rest.remove_suffix(8);
  return rest.size() >= 4 && std::ranges::all_of(rest, [](char c) { return c >= '0' && c <= '9'; });
}

/// Makes or checks the store's folder; what it holds already.
Result<std::vector<PartManifest>> prepare(const std::string& path, bool append) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_directory(status))
    return fail("This is a file, not a point store", path, "Name a folder that does not exist yet");
  const std::string manifest = (fs::path(path) / kManifestName).string();
  if (fs::exists(manifest, error)) {
    if (append) return readManifest(manifest);
    return fail(isStoreFolder(path) ? "The point store exists already" : "The folder exists and is no point store", path,
                "Name another folder, or append to a store");
  }
  if (append) return fail("There is no point store to append to", path, "Index without appending");
  if (!fs::exists(status)) {
    if (!fs::create_directory(path, error)) return fail(diskError(error.value(), path));
    return std::vector<PartManifest>{};
  }
  for (auto entry = fs::directory_iterator(path, error); !error && entry != fs::directory_iterator(); entry.increment(error))
    if (!isOurs(entry->path().filename().string()))
      return fail("The folder exists and is no point store", path, "Name a folder that does not exist yet");
  if (error) return fail(diskError(error.value(), path));
  return std::vector<PartManifest>{};
}

/// A scan that is there already would double its points.
Result<void> checkNew(std::span<const PartManifest> parts, std::span<const ScanSource> scans) {
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const std::string& identity = scans[i].identity;
    const auto same = [&](const auto& other) { return !identity.empty() && other.identity == identity; };
    if (std::ranges::any_of(parts, same)) return fail("The point store holds this scan already", scans[i].name, "Leave it out");
    if (std::ranges::any_of(scans.first(i), same)) return fail("This scan is named twice", scans[i].name, "Name it once");
  }
  return {};
}

/// Nodes, tables' checksum and manifest beside the columns; then the folder gets its final name.
Result<PartManifest> finishPart(FileSink& sink, const PartTree& tree, const ScanSource& scan, std::uint64_t purpose,
                                const std::string& store, std::size_t number) {
  const std::string folder = store + "/" + partFolderName(number), partial = folder + ".partial";
  if (auto done = sink.finish(tree); !done) return fail(done.error());
  const PointStoreData data = storeDataOf(tree);
  const std::vector<std::byte> nodes = packNodes(data);
  if (auto written = replaceFile(partial + "/nodes.bin", nodes); !written) return fail(written.error());
  const auto tables = MappedFile::open(partial + "/" + columnFileName(PartSink::kTables));
  if (!tables) return fail(tables.error());

  PartManifest part;
  part.folder = partFolderName(number);
  part.source = scan.name, part.identity = scan.identity;
  part.info = scan.info;
  part.notes = scan.notes;
  part.lattice = tree.lattice, part.schema = tree.schema;
  part.levelKind = data.levelKind, part.law = data.law, part.lawShift = data.lawShift;
  part.seed = tree.tree.seed;
  part.pointCount = tree.pointCount, part.dropped = tree.dropped;
  part.nodeCount = data.nodes.size(), part.tableCount = tree.tableCount;
  part.nodesChecksum = checksumOf(nodes), part.tablesChecksum = checksumOf(tables->bytes());
  part.purpose = purpose;
  const std::string text = manifestText({part});
  if (auto written = replaceFile(partial + "/part.json", std::as_bytes(std::span(text))); !written) return fail(written.error());
  std::error_code error;
  fs::rename(partial, folder, error);
  if (error) return fail(diskError(error.value(), folder));
  if (auto synced = syncFolder(store); !synced) return fail(synced.error());
  FileSink::removeWorkFiles(folder);
  return part;
}

/// A part that an earlier run, cut short, has finished.
std::optional<PartManifest> finishedPart(const std::string& folder, std::size_t number, std::uint64_t purpose) {
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) return std::nullopt;
  const auto parts = readManifest(folder + "/part.json", number);
  if (!parts || parts->size() != 1 || parts->front().purpose != purpose || !openPart(folder, parts->front())) return std::nullopt;
  FileSink::removeWorkFiles(folder);
  return parts->front();
}

Result<PartManifest> indexScan(const ScanSource& scan, const std::string& store, std::size_t number, const IndexOptions& options,
                               const Progress& progress, bool* kept) {
  const std::string folder = store + "/" + partFolderName(number), partial = folder + ".partial";
  const std::vector<std::byte> purpose = purposeOf(scan, options);
  const std::uint64_t checksum = checksumOf(purpose);
  std::error_code error;
  if (!scan.identity.empty()) {
    if (auto finished = finishedPart(folder, number, checksum)) {
      *kept = true;
      return *finished;
    }
  } else {
    fs::remove_all(partial, error);  // nothing tells whether it was this scan
  }
  if (fs::remove_all(folder, error); error) return fail(diskError(error.value(), folder));
  auto sink = FileSink::open(partial, purpose);
  if (!sink) return fail(sink.error());
  const TimedProgress timed(progress, scan);
  auto tree = indexPart(scan, partOptionsOf(scan, options), **sink, timed.progress());
  if (progress.cancelled()) return fail(cancelledError());
  if (!tree) {
    if (tree.error().what == kDamagedSpill) fs::remove_all(partial, error);
    return fail(tree.error());
  }
  return finishPart(**sink, *tree, scan, checksum, store, number);
}

/// What no manifest speaks of: left over from runs with other scans.
void removeStrays(const std::string& store, const std::vector<PartManifest>& parts) {
  std::error_code ignored;
  std::vector<fs::path> strays;
  for (const auto& entry : fs::directory_iterator(store, ignored)) {
    const std::string name = entry.path().filename().string();
    const auto listed = [&](const PartManifest& part) { return part.folder == name; };
    if (name.starts_with("part-") && isOurs(name) && std::ranges::none_of(parts, listed)) strays.push_back(entry.path());
  }
  for (const fs::path& stray : strays) fs::remove_all(stray, ignored);
}

}  // namespace

Result<IndexReport> indexScans(std::span<const ScanSource> scans, const std::string& storePath, const IndexOptions& options,
                               const Progress& progress) {
  try {
    const auto start = Clock::now();
    if (scans.empty()) return fail("There is no scan to index", storePath, "Name at least one");
    if (progress.cancelled()) return fail(cancelledError());
    if (auto made = prepare(storePath, options.append); !made) return fail(made.error());
    const auto lock = FolderLock::take(storePath);
    if (!lock) return fail(lock.error());
    // Again, now that nobody else can change it.
    auto parts = prepare(storePath, options.append);
    if (!parts) return fail(parts.error());
    if (auto fresh = checkNew(*parts, scans); !fresh) return fail(fresh.error());
    double whole = 0, before = 0;
    for (const ScanSource& scan : scans) whole += static_cast<double>(scan.info.pointCount) + 1;
    IndexReport report;
    std::uint64_t indexed = 0;
    for (const ScanSource& scan : scans) {
      const double after = before + static_cast<double>(scan.info.pointCount) + 1;
      bool kept = false;
      auto part = indexScan(scan, storePath, parts->size() + 1, options, progress.part(before / whole, after / whole), &kept);
      if (!part) return fail(part.error());
      before = after;
      report.points += part->pointCount, report.dropped += part->dropped;
      report.kept += kept;
      if (!kept) indexed += part->pointCount;
      parts->push_back(std::move(*part));
    }
    const std::string text = manifestText(*parts);
    if (auto ok = replaceFile((fs::path(storePath) / kManifestName).string(), std::as_bytes(std::span(text))); !ok)
      return fail(ok.error());
    removeStrays(storePath, *parts);
    report.parts = parts->size();
    report.seconds = secondsSince(start);
    report.pointsPerSecond = report.seconds > 0 ? static_cast<double>(indexed) / report.seconds : 0;
    progress.report(1.0, "Point store ready");
    return report;
  } catch (const std::bad_alloc&) {
    return fail("There is not enough memory to index the scans", storePath, "Close other programs or allow less memory");
  } catch (const fs::filesystem_error& failure) {
    return fail(diskError(failure.code().value(), storePath));
  }
}

}  // namespace alidade

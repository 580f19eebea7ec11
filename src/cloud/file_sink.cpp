// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/file_sink.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "cloud/byte_pack.h"
#include "cloud/disk.h"
#include "cloud/point_store.h"

namespace alidade {

namespace {

constexpr std::uint64_t kRecordHeader = 2 * sizeof(std::uint64_t);
constexpr const char* kDiaryName = "diary.tmp";

}  // namespace

std::string columnFileName(std::size_t column) {
  switch (column) {
    case PartSink::kPoints: return "points.bin";
    case PartSink::kExact: return "exact.bin";
    case PartSink::kTables: return "tables.bin";
    case PartSink::kTops: return "tops.tmp";
    default: return fmt::format("column-{:03}.bin", column - PartSink::kFirstAttribute + 1);
  }
}

Result<std::unique_ptr<FileSink>> FileSink::open(const std::string& folder, std::span<const std::byte> purpose) {
  if (::mkdir(folder.c_str(), 0777) != 0 && errno != EEXIST) return fail(diskError(errno, folder));
  std::unique_ptr<FileSink> sink(new FileSink(folder));
  sink->m_diary.path = folder + "/" + kDiaryName;
  sink->m_diary.descriptor = ::open(sink->m_diary.path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (sink->m_diary.descriptor < 0) return fail(diskError(errno, sink->m_diary.path));
  if (auto read = sink->readDiary(purpose); !read) return fail(read.error());
  if (auto synced = syncFolder(folder); !synced) return fail(synced.error());
  return sink;
}

FileSink::~FileSink() {
  for (const File& file : m_columns)
    if (file.descriptor >= 0) ::close(file.descriptor);
  if (m_diary.descriptor >= 0) ::close(m_diary.descriptor);
}

/// Takes the whole records of a diary with this purpose, or begins a new one.
Result<void> FileSink::readDiary(std::span<const std::byte> purpose) {
  struct stat status {};
  if (::fstat(m_diary.descriptor, &status) != 0) return fail(diskError(errno, m_diary.path));
  const auto size = static_cast<std::uint64_t>(status.st_size);
  std::vector<std::vector<std::byte>> records;
  std::vector<std::uint64_t> ends;
  for (std::uint64_t at = 0; size - at >= kRecordHeader;) {
    std::uint64_t header[2];
    if (auto ok = readAt(m_diary.descriptor, at, std::as_writable_bytes(std::span(header)), m_diary.path); !ok) return ok;
    at += kRecordHeader;
    if (header[0] > size - at) break;
    std::vector<std::byte> bytes(header[0]);
    if (auto ok = readAt(m_diary.descriptor, at, bytes, m_diary.path); !ok) return ok;
    if (checksumOf(bytes) != header[1]) break;
    at += header[0];
    records.push_back(std::move(bytes));
    ends.push_back(at);
  }
  const bool mine = !records.empty() && std::ranges::equal(records[0], purpose);
  m_diaryEnd = mine ? ends.back() : 0;
  if (::ftruncate(m_diary.descriptor, static_cast<off_t>(m_diaryEnd)) != 0) return fail(diskError(errno, m_diary.path));
  if (mine) {
    m_purposeEnd = ends[0];
    m_past.assign(std::make_move_iterator(records.begin() + 1), std::make_move_iterator(records.end()));
    return {};
  }
  if (auto ok = append(purpose); !ok) return ok;
  m_purposeEnd = m_diaryEnd;
  return {};
}

Result<void> FileSink::append(std::span<const std::byte> bytes) {
  BytePacker record;
  record.put<std::uint64_t>(bytes.size());
  record.put(checksumOf(bytes));
  record.bytes.insert(record.bytes.end(), bytes.begin(), bytes.end());
  if (auto ok = writeAt(m_diary.descriptor, m_diaryEnd, record.bytes, m_diary.path); !ok) return ok;
  if (::fdatasync(m_diary.descriptor) != 0) return fail(diskError(errno, m_diary.path));
  m_diaryEnd += record.bytes.size();
  return {};
}

Result<void> FileSink::openColumn(std::size_t column, std::uint64_t bytes, bool keep) {
  File& file = m_columns.emplace_back();
  file.path = m_folder + "/" + columnFileName(column);
  file.descriptor = ::open(file.path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | (keep ? 0 : O_TRUNC), 0666);
  if (file.descriptor < 0) return fail(diskError(errno, file.path));
  if (column == kTables || column == kTops) return {};
  // A disk without the room says so now, where its file system can promise room.
  if (bytes > 0 && ::fallocate(file.descriptor, 0, 0, static_cast<off_t>(bytes)) != 0 && errno != EOPNOTSUPP && errno != ENOSYS)
    return fail(diskError(errno, file.path));
  if (::ftruncate(file.descriptor, static_cast<off_t>(bytes)) != 0) return fail(diskError(errno, file.path));
  return {};
}

Result<void> FileSink::begin(std::uint64_t pointCount, const Lattice& lattice, const PointSchema& schema, bool resumed) {
  for (const File& file : m_columns) ::close(file.descriptor);
  m_columns.clear();
  if (!resumed) {
    if (::ftruncate(m_diary.descriptor, static_cast<off_t>(m_purposeEnd)) != 0) return fail(diskError(errno, m_diary.path));
    m_diaryEnd = m_purposeEnd;
  }
  std::vector<std::uint64_t> widths{sizeof(DisplayPoint), lattice.exactBytes(), 0, 0};
  for (const ColumnShape& column : schema.columns) widths.push_back(column.bytes());
  for (std::size_t c = 0; c < widths.size(); ++c)
    if (auto ok = openColumn(c, pointCount * widths[c], resumed); !ok) return ok;
  return syncFolder(m_folder);
}

Result<void> FileSink::write(std::size_t column, std::uint64_t offset, std::span<const std::byte> bytes) {
  File& file = m_columns[column];
  if (auto ok = writeAt(file.descriptor, offset, bytes, file.path); !ok) return ok;
  // On its way to the disk while the next is worked on: nobody then waits for all of it at the end. A wish only.
  ::sync_file_range(file.descriptor, static_cast<off_t>(offset), static_cast<off_t>(bytes.size()), SYNC_FILE_RANGE_WRITE);
  file.dirty = true;
  return {};
}

Result<void> FileSink::read(std::size_t column, std::uint64_t offset, std::span<std::byte> into) {
  return readAt(m_columns[column].descriptor, offset, into, m_columns[column].path);
}

Result<void> FileSink::flush() {
  if (m_lost != 0) return fail(diskError(m_lost, m_columns.front().path));
  for (File& file : m_columns) {
    if (!file.dirty.exchange(false) || ::fdatasync(file.descriptor) == 0) continue;
    m_lost = errno;
    return fail(diskError(m_lost, file.path));
  }
  return {};
}

Result<void> FileSink::note(std::span<const std::byte> bytes) {
  if (auto ok = flush(); !ok) return ok;
  return append(bytes);
}

Result<void> FileSink::finish(const PartTree& part) {
  File& tables = m_columns[kTables];
  // A killed run may have written further than the one that went on.
  if (::ftruncate(tables.descriptor, static_cast<off_t>(part.tableCount * sizeof(std::uint32_t))) != 0)
    return fail(diskError(errno, tables.path));
  for (File& file : m_columns)
    if (::fsync(file.descriptor) != 0) return fail(diskError(errno, file.path));
  return {};
}

void FileSink::removeWorkFiles(const std::string& folder) {
  for (const std::string& name : {std::string("spill.tmp"), std::string(kDiaryName), columnFileName(kTops)}) {
    std::error_code ignored;
    std::filesystem::remove(folder + "/" + name, ignored);
  }
}

}  // namespace alidade

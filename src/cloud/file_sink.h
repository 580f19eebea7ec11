// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "cloud/part_index.h"

namespace alidade {

/// Name of a column's file in a part's folder: "points.bin", "column-001.bin".
std::string columnFileName(std::size_t column);

/// A part's columns as files of one folder, a file a column.
///
/// The folder holds a diary: records {u64 length, u64 checksum, bytes}, the first of which says what the work
/// is. Columns are on the disk before a record vouches for them; a record cut short by a kill, and all after
/// it, count for nothing.
class FileSink : public PartSink {
 public:
  /// Makes the folder, or goes on in one whose diary begins with `purpose`. A diary of another purpose is dropped.
  static Result<std::unique_ptr<FileSink>> open(const std::string& folder, std::span<const std::byte> purpose);
  ~FileSink() override;

  Result<void> begin(std::uint64_t pointCount, const Lattice& lattice, const PointSchema& schema, bool resumed) override;
  Result<void> write(std::size_t column, std::uint64_t offset, std::span<const std::byte> bytes) override;
  Result<void> read(std::size_t column, std::uint64_t offset, std::span<std::byte> into) override;
  std::vector<std::vector<std::byte>> diary() override { return m_past; }
  Result<void> note(std::span<const std::byte> bytes) override;
  std::string spillPath() const override { return m_folder + "/spill.tmp"; }

  /// Cuts the tables to their length and flushes every column to the disk.
  Result<void> finish(const PartTree& part);
  /// Removes what only unfinished work needs: spill, diary, tops.
  static void removeWorkFiles(const std::string& folder);

 private:
  struct File {
    std::string path;
    int descriptor = -1;
    std::atomic<bool> dirty{false};
  };
  explicit FileSink(std::string folder) : m_folder(std::move(folder)) {}
  Result<void> readDiary(std::span<const std::byte> purpose);
  Result<void> append(std::span<const std::byte> bytes);
  Result<void> openColumn(std::size_t column, std::uint64_t bytes, bool keep);
  Result<void> flush();

  std::string m_folder;
  std::deque<File> m_columns;  ///< by PartSink::Column
  std::atomic<int> m_lost = 0;  ///< errno of a flush that failed: pages may be gone, and nothing after it is vouched for
  File m_diary;
  std::uint64_t m_purposeEnd = 0, m_diaryEnd = 0;
  std::vector<std::vector<std::byte>> m_past;
};

}  // namespace alidade

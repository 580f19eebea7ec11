// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"

namespace alidade {

/// The error of a temporary file that does not hold what was written: only a new start helps.
inline constexpr const char* kDamagedSpill = "The temporary file of the point store is damaged";

/// Points on their way from the source's order to their cells: runs of records of one cell and one batch, in
/// blocks ("extents") of one stream, in memory or in one temporary file.
///
/// A run is {u32 cell, u32 count, u64 batch} and then `count` records. Extents of one writer keep their order,
/// so that sorting a stream's runs by batch gives the source's order whatever the threads did.
class RecordStreams {
 public:
  struct RunHeader {
    std::uint32_t cell = 0, count = 0;
    std::uint64_t batch = 0;
  };
  struct Extent {
    std::uint64_t at = 0;    ///< extent number in the file, or in memory
    std::uint32_t used = 0;  ///< bytes
    bool inFile = false;
  };
  struct Options {
    std::size_t recordBytes = 8;  ///< a multiple of 8
    std::size_t extentBytes = 1 << 17;
    std::uint64_t memoryBytes = 0;  ///< full extents kept in memory; the rest is spilled
    std::string spillPath;          ///< empty: never spill
  };

  explicit RecordStreams(const Options& options) : m_options(options) {}
  ~RecordStreams();

  const Options& options() const { return m_options; }

  /// One thread's pen: an open extent a stream.
  class Writer {
   public:
    Writer(RecordStreams& streams, std::size_t streamCount);
    /// Room for up to `count` records of one run, at least one: where to write them, and how many fit.
    std::byte* beginRun(std::uint32_t stream, const RunHeader& header, std::uint32_t* fits);
    /// Closes every open extent. Call when done; the extents then belong to the streams.
    Result<void> finish();

   private:
    friend class RecordStreams;
    struct Open {
      std::byte* block = nullptr;
      std::uint32_t used = 0;
    };
    void close(std::uint32_t stream);
    RecordStreams& m_streams;
    std::vector<Open> m_open;
    std::vector<std::vector<Extent>> m_closed;
    Error m_error;
    bool m_failed = false;
  };

  /// Takes over what the writer wrote. In the order of the calls, which must not matter to anybody.
  void adopt(Writer& writer);
  /// Everything to the file, so that a later process can go on.
  Result<void> spillAll();
  bool hasSpilled() const { return m_file >= 0; }

  const std::vector<std::vector<Extent>>& extents() const { return m_extents; }
  /// Goes on with an earlier process's file.
  Result<void> reopen(std::vector<std::vector<Extent>> extents);

  /// A stream's extents as they are.
  class Loaded {
   public:
    explicit Loaded(RecordStreams& streams) : m_streams(&streams) {}
    Loaded(Loaded&& other) noexcept = default;
    ~Loaded();
    struct Part {
      const std::byte* data;
      std::uint32_t used;
    };
    std::vector<Part> parts;

   private:
    friend class RecordStreams;
    RecordStreams* m_streams;
    std::vector<std::byte*> m_blocks;  ///< that were read from the file
  };
  Result<Loaded> load(std::uint32_t stream);
  /// What the stream holds in memory may be written over.
  void release(std::uint32_t stream);

  std::uint64_t bytesInMemory() const { return m_inMemory.load(); }

 private:
  std::byte* takeBlock();
  void giveBlock(std::byte* block);
  Result<std::uint64_t> writeExtent(const std::byte* block);
  Result<void> openSpill(bool existing);

  Options m_options;
  std::vector<std::vector<Extent>> m_extents;
  std::mutex m_mutex;
  std::vector<std::byte*> m_slabs;  ///< what blocks are cut from, in large pages: first touch of small ones is dear
  std::vector<std::byte*> m_free;
  std::vector<std::byte*> m_held;  ///< extents in memory by number
  std::atomic<std::uint64_t> m_inMemory{0};
  std::atomic<std::uint64_t> m_nextInFile{0};
  std::atomic<int> m_file{-1};
};

}  // namespace alidade

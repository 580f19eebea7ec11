// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/record_streams.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cloud/disk.h"

namespace alidade {

namespace {

/// Of a large page; enough for direct file access, too.
constexpr std::size_t kSlab = std::size_t{2} << 20;
constexpr std::align_val_t kAlignment{kSlab};

}  // namespace

RecordStreams::Loaded::~Loaded() {
  for (std::byte* block : m_blocks) m_streams->giveBlock(block);
}

RecordStreams::~RecordStreams() {
  for (std::byte* slab : m_slabs) ::operator delete(slab, kAlignment);
  if (m_file >= 0) ::close(m_file);
}

std::byte* RecordStreams::takeBlock() {
  std::lock_guard lock(m_mutex);
  if (m_free.empty()) {
    const std::size_t blocks = std::max<std::size_t>(1, kSlab / m_options.extentBytes), bytes = blocks * m_options.extentBytes;
    m_slabs.reserve(m_slabs.size() + 1);
    m_free.reserve(blocks);
    m_slabs.push_back(static_cast<std::byte*>(::operator new(bytes, kAlignment)));
    ::madvise(m_slabs.back(), bytes, MADV_HUGEPAGE);  // where there are none, small ones do
    for (std::size_t i = blocks; i-- > 0;) m_free.push_back(m_slabs.back() + i * m_options.extentBytes);
  }
  std::byte* block = m_free.back();
  m_free.pop_back();
  return block;
}

void RecordStreams::giveBlock(std::byte* block) {
  std::lock_guard lock(m_mutex);
  m_free.push_back(block);
}

Result<void> RecordStreams::openSpill(bool existing) {
  std::lock_guard lock(m_mutex);
  if (m_file >= 0) return {};
  const int flags = O_RDWR | O_CREAT | O_CLOEXEC | (existing ? 0 : O_TRUNC);
  // Past the page cache where the file system can: buffered writes of this size are slow and erratic.
  int file = ::open(m_options.spillPath.c_str(), flags | O_DIRECT, 0644);
  if (file < 0 && errno == EINVAL) file = ::open(m_options.spillPath.c_str(), flags, 0644);
  if (file < 0) return fail(diskError(errno, m_options.spillPath));
  m_file = file;
  return {};
}

Result<std::uint64_t> RecordStreams::writeExtent(const std::byte* block) {
  if (m_file < 0)
    if (auto opened = openSpill(false); !opened) return fail(opened.error());
  const std::uint64_t number = m_nextInFile.fetch_add(1);
  if (auto ok = writeAt(m_file, number * m_options.extentBytes, {block, m_options.extentBytes}, m_options.spillPath); !ok)
    return fail(ok.error());
  return number;
}

RecordStreams::Writer::Writer(RecordStreams& streams, std::size_t streamCount)
    : m_streams(streams), m_open(streamCount), m_closed(streamCount) {}

std::byte* RecordStreams::Writer::beginRun(std::uint32_t stream, const RunHeader& header, std::uint32_t* fits) {
  const std::size_t record = m_streams.m_options.recordBytes;
  const auto size = static_cast<std::uint32_t>(m_streams.m_options.extentBytes);
  Open& open = m_open[stream];
  if (open.block != nullptr && open.used + sizeof(RunHeader) + record > size) close(stream);
  if (open.block == nullptr) open = {m_streams.takeBlock(), 0};
  RunHeader written = header;
  written.count = std::min(header.count, static_cast<std::uint32_t>((size - open.used - sizeof(RunHeader)) / record));
  std::memcpy(open.block + open.used, &written, sizeof written);
  std::byte* at = open.block + open.used + sizeof written;
  open.used += static_cast<std::uint32_t>(sizeof written + written.count * record);
  *fits = written.count;
  return at;
}

void RecordStreams::Writer::close(std::uint32_t stream) {
  Open& open = m_open[stream];
  if (open.block == nullptr) return;
  RecordStreams& all = m_streams;
  const std::uint64_t bytes = all.m_options.extentBytes;
  if (!all.m_options.spillPath.empty() && all.m_inMemory.load() + bytes > all.m_options.memoryBytes) {
    // The rest of the block goes to the file as well: never what the memory held before.
    std::memset(open.block + open.used, 0, bytes - open.used);
    const auto number = m_failed ? Result<std::uint64_t>(0) : all.writeExtent(open.block);
    if (!number) m_failed = true, m_error = number.error();
    else m_closed[stream].push_back({*number, open.used, true});
    all.giveBlock(open.block);
  } else {
    all.m_inMemory += bytes;
    std::lock_guard lock(all.m_mutex);
    m_closed[stream].push_back({all.m_held.size(), open.used, false});
    all.m_held.push_back(open.block);
  }
  open = {};
}

Result<void> RecordStreams::Writer::finish() {
  for (std::uint32_t stream = 0; stream < m_open.size(); ++stream) close(stream);
  if (m_failed) return fail(m_error);
  return {};
}

void RecordStreams::adopt(Writer& writer) {
  if (m_extents.size() < writer.m_closed.size()) m_extents.resize(writer.m_closed.size());
  for (std::size_t s = 0; s < writer.m_closed.size(); ++s)
    m_extents[s].insert(m_extents[s].end(), writer.m_closed[s].begin(), writer.m_closed[s].end());
  writer.m_closed.clear();
}

Result<void> RecordStreams::spillAll() {
  for (auto& stream : m_extents) {
    for (Extent& extent : stream) {
      if (extent.inFile) continue;
      std::byte*& block = m_held[extent.at];
      std::memset(block + extent.used, 0, m_options.extentBytes - extent.used);
      const auto number = writeExtent(block);
      if (!number) return fail(number.error());
      extent = {*number, extent.used, true};
      giveBlock(std::exchange(block, nullptr));
      m_inMemory -= m_options.extentBytes;
    }
  }
  m_held.clear();
  if (m_file >= 0 && ::fdatasync(m_file) != 0) return fail(diskError(errno, m_options.spillPath));
  return {};
}

Result<void> RecordStreams::reopen(std::vector<std::vector<Extent>> extents) {
  m_extents = std::move(extents);
  if (auto opened = openSpill(true); !opened) return opened;
  struct stat status {};
  if (::fstat(m_file, &status) != 0) return fail(diskError(errno, m_options.spillPath));
  const std::uint64_t whole = static_cast<std::uint64_t>(status.st_size) / m_options.extentBytes;
  for (const auto& stream : m_extents)
    for (const Extent& extent : stream)
      if (!extent.inFile || extent.at >= whole || extent.used > m_options.extentBytes) return fail(kDamagedSpill, m_options.spillPath);
  return {};
}

Result<RecordStreams::Loaded> RecordStreams::load(std::uint32_t stream) {
  Loaded loaded(*this);
  if (stream >= m_extents.size()) return loaded;
  for (const Extent& extent : m_extents[stream]) {
    if (!extent.inFile) {
      loaded.parts.push_back({m_held[extent.at], extent.used});
      continue;
    }
    std::byte* block = takeBlock();
    loaded.m_blocks.push_back(block);
    if (auto ok = readAt(m_file, extent.at * m_options.extentBytes, {block, m_options.extentBytes}, m_options.spillPath); !ok)
      return fail(ok.error());
    loaded.parts.push_back({block, extent.used});
  }
  return loaded;
}

void RecordStreams::release(std::uint32_t stream) {
  if (stream >= m_extents.size()) return;
  for (const Extent& extent : m_extents[stream]) {
    if (extent.inFile || m_held[extent.at] == nullptr) continue;
    giveBlock(std::exchange(m_held[extent.at], nullptr));
    m_inMemory -= m_options.extentBytes;
  }
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "base/pixel_memory.h"

#include <deque>
#include <mutex>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace alidade {

namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;

constexpr std::align_val_t boundaryOf(std::size_t bytes) {
  return std::align_val_t(bytes >= kHugePage ? kHugePage : 64);
}

#if defined(__SANITIZE_ADDRESS__)
constexpr std::size_t kSmallestKept = ~std::size_t{0};  // a kept block would hide the use of one that was returned
#else
constexpr std::size_t kSmallestKept = std::size_t{1} << 20;
#endif

struct Block {
  void* memory;
  std::size_t bytes;
};

class KeptBlocks {
 public:
  void* take(std::size_t bytes) {
    const std::lock_guard lock(m_mutex);
    for (auto it = m_blocks.rbegin(); it != m_blocks.rend(); ++it) {
      if (it->bytes != bytes) continue;
      void* const memory = it->memory;
      m_bytes -= bytes;
      m_blocks.erase(std::next(it).base());
      return memory;
    }
    return nullptr;
  }

  /// False where there is no room for it.
  bool keep(void* memory, std::size_t bytes) noexcept {
    if (bytes > kKeptPixelBytes) return false;
    const std::lock_guard lock(m_mutex);
    for (; m_bytes + bytes > kKeptPixelBytes; m_blocks.pop_front()) {
      m_bytes -= m_blocks.front().bytes;
      ::operator delete(m_blocks.front().memory, boundaryOf(m_blocks.front().bytes));
    }
    try {
      m_blocks.push_back({memory, bytes});
    } catch (const std::bad_alloc&) {
      return false;
    }
    m_bytes += bytes;
    return true;
  }

 private:
  std::mutex m_mutex;
  std::deque<Block> m_blocks;  // the one that was returned last at the end
  std::size_t m_bytes = 0;
};

/// Never destroyed: pictures of static objects are returned after main.
KeptBlocks& keptBlocks() {
  static auto* const blocks = new KeptBlocks;
  return *blocks;
}

}  // namespace

void* takePixels(std::size_t bytes) {
  if (bytes >= kSmallestKept)
    if (void* const kept = keptBlocks().take(bytes)) return kept;
  void* const memory = ::operator new(bytes, boundaryOf(bytes));
#if defined(__linux__)
  // Points fall all over a picture: with small pages most of them would miss the table of pages, too.
  if (bytes >= kHugePage) ::madvise(memory, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);
#endif
  return memory;
}

void returnPixels(void* block, std::size_t bytes) noexcept {
  if (bytes >= kSmallestKept && keptBlocks().keep(block, bytes)) return;
  ::operator delete(block, boundaryOf(bytes));
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/splat_plane.h"

#include <algorithm>
#include <cstring>
#include <deque>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "base/pixel_memory.h"

namespace alidade {

/// All ones, nothing touched, while nobody has it.
struct SplatPlane::Block {
  std::vector<std::uint8_t, PixelAllocator<std::uint8_t>> bytes;
  std::vector<std::uint8_t> touched;
  std::size_t bytesPerPixel;

  Block(std::size_t pixels, std::size_t bytesPerPixel)
      : bytes(pixels * bytesPerPixel, 0xff), touched((pixels + kPiece - 1) / kPiece, 0), bytesPerPixel(bytesPerPixel) {}
};

/// Blocks of past frames, a few of them.
class SplatPlanePool {
 public:
  using Block = SplatPlane::Block;

  static SplatPlanePool& instance() {
    static SplatPlanePool pool;
    return pool;
  }

  std::unique_ptr<Block> take(std::size_t pixels, std::size_t bytesPerPixel) {
    {
      const std::lock_guard lock(m_mutex);
      const auto fits = [&](const auto& block) { return block->bytes.size() == pixels * bytesPerPixel && block->bytesPerPixel == bytesPerPixel; };
      if (const auto found = std::ranges::find_if(m_free, fits); found != m_free.end()) {
        std::unique_ptr<Block> block = std::move(*found);
        m_bytes -= block->bytes.size();
        m_free.erase(found);
        return block;
      }
    }
    return std::make_unique<Block>(pixels, bytesPerPixel);
  }

  void giveBack(std::unique_ptr<Block> block) noexcept {
    const std::size_t bytes = block->bytes.size();
    const std::lock_guard lock(m_mutex);
    if (bytes > kKeptBytes) return;
    for (; m_bytes + bytes > kKeptBytes; m_free.pop_front()) m_bytes -= m_free.front()->bytes.size();
    try {
      m_free.push_back(std::move(block));
    } catch (const std::bad_alloc&) {
      return;
    }
    m_bytes += bytes;
  }

 private:
  /// Two kinds of picture of 1080p for some twenty threads; those that were returned first go first.
  static constexpr std::size_t kKeptBytes = std::size_t{1} << 30;
  std::mutex m_mutex;
  std::deque<std::unique_ptr<Block>> m_free;
  std::size_t m_bytes = 0;
};

SplatPlane::SplatPlane(std::size_t pixels, std::size_t bytesPerPixel) : m_block(SplatPlanePool::instance().take(pixels, bytesPerPixel)) {}

SplatPlane::~SplatPlane() {
  clear();
  SplatPlanePool::instance().giveBack(std::move(m_block));
}

void* SplatPlane::pixels() const {
  return m_block->bytes.data();
}

std::uint8_t* SplatPlane::touched() const {
  return m_block->touched.data();
}

void SplatPlane::clear() {
  const std::size_t piece = kPiece * m_block->bytesPerPixel;
  for (std::size_t i = 0; i < m_block->touched.size(); ++i) {
    if (m_block->touched[i] == 0) continue;
    std::memset(m_block->bytes.data() + i * piece, 0xff, std::min(piece, m_block->bytes.size() - i * piece));
    m_block->touched[i] = 0;
  }
}

}  // namespace alidade

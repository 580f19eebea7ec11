// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace alidade {

/// One thread's pixels, all of all ones at first, and which pieces of them were drawn into. Planes are kept from frame to frame: as
/// long as sizes stay the same a new one costs nothing, and only what was drawn into is cleared again. Not thread-safe.
class SplatPlane {
 public:
  /// Pixels of a piece, its first a multiple of it.
  static constexpr std::size_t kPiece = 128;
  static constexpr unsigned kPieceBits = 7;
  static_assert(kPiece == std::size_t{1} << kPieceBits);

  SplatPlane(std::size_t pixels, std::size_t bytesPerPixel);
  ~SplatPlane();
  SplatPlane(const SplatPlane&) = delete;
  SplatPlane& operator=(const SplatPlane&) = delete;

  void* pixels() const;
  /// A byte a piece; who draws into one sets it.
  std::uint8_t* touched() const;

 private:
  /// All ones again where something was drawn.
  void clear();

  struct Block;
  friend class SplatPlanePool;
  std::unique_ptr<Block> m_block;
};

}  // namespace alidade

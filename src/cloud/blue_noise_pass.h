// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace alidade::blue_noise {

/// Points that are worked on at a time; arrays of points are readable and writable by so many beyond their end.
constexpr std::size_t kLanes = 16;
constexpr std::uint32_t kNone = 0xffffffff;
constexpr float kAccepted = -1;  ///< in place of a squared distance

/// A cube of twice the spacing: its points are a run of the survivors.
struct Brick {
  std::uint32_t first = 0, last = 0;
  std::uint32_t acceptedFirst = 0, acceptedLast = 0;  ///< of the accepted
  std::uint32_t nearAt = kNone;                       ///< into Pass::nearSquared
};

/// A cube of 4³ bricks, those that hold points in Morton order from firstBrick on. Blocks, too, stand in Morton order.
struct Block {
  std::uint64_t code = 0;
  std::uint64_t filled = 0;  ///< by the brick's Morton code in the block
  std::uint32_t firstBrick = 0;
  std::array<std::uint32_t, 27> before{};  ///< blocks beside it that come before it, and itself; kNone for others
};

/// The bricks about a brick or about a group of 2³, itself among them, by its place in its block: which bricks of
/// which blocks.
struct Neighbourhood {
  struct Entry {
    std::uint8_t block = 0;  ///< (dz+1) * 9 + (dy+1) * 3 + dx+1
    std::uint64_t bricks = 0;
  };
  std::array<Entry, 8> entries;
  std::uint8_t count = 0;
};

/// Samples that are copied at a time; arrays of samples, too, reach so far beyond their end.
constexpr std::size_t kSamples = 4;

/// A point that was accepted.
struct Sample {
  float x, y, z;
  std::uint32_t index;
};

/// One pass over the survivors.
struct Pass {
  const float* places;  ///< of the survivors, in Morton order: x; y and z stand `apart` floats further, each after the other
  std::size_t apart;
  const std::uint32_t* index;
  Sample* accepted;
  Sample* near;  ///< room for as many
  float* squared;  ///< of each survivor's distance to the nearest accepted, as far as that is below the spacing; kAccepted: is one
  Brick* bricks;
  const Block* blocks;
  std::size_t blockCount;
  const Neighbourhood* neighbourhoods;
  std::uint32_t groupBricks;  ///< 1 or 8
  float spacingSquared;
  const float* nearSquared;
  const char* given;  ///< survivors that are accepted whatever is near; null: none
};

/// Goes over the survivors in their order and accepts. Returns how many; the same whatever the instruction set.
std::size_t chooseScalar(const Pass& pass);
std::size_t chooseAvx2(const Pass& pass);
std::size_t chooseAvx512(const Pass& pass);

}  // namespace alidade::blue_noise

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "base/image.h"

#include <utility>

#include <gtest/gtest.h>

namespace alidade {
namespace {

TEST(Image, HoldsItsValueWhateverTheMemoryHeldBefore) {
  for (int round = 0; round < 3; ++round) {
    ColourImage used(1000, 700, Rgba8{1, 2, 3, 4});
    used = ColourImage();
    const ColourImage fresh(1000, 700);
    for (std::size_t i = 0; i < fresh.size(); ++i) ASSERT_EQ(fresh.data()[i], Rgba8{}) << i;
  }
}

TEST(Image, CopiesAreItsOwn) {
  DepthImage first(900, 800, 2.0f);
  DepthImage second = first;
  second.at(899, 799) = 3.0f;
  EXPECT_EQ(first.at(899, 799), 2.0f);
  EXPECT_EQ(second.at(0, 0), 2.0f);
  first = second;
  EXPECT_EQ(first.at(899, 799), 3.0f);
  const DepthImage third = std::move(second);
  EXPECT_EQ(third.width(), 900);
  EXPECT_EQ(third.at(899, 799), 3.0f);
}

TEST(PixelMemory, HandsOutAgainWhatWasReturnedLast) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "kept blocks would hide errors from the sanitizer";
#endif
  const std::size_t bytes = 3'000'000;
  void* const a = takePixels(bytes);
  void* const b = takePixels(bytes);
  EXPECT_NE(a, b);
  returnPixels(a, bytes);
  returnPixels(b, bytes);
  EXPECT_EQ(takePixels(bytes), b);
  EXPECT_EQ(takePixels(bytes), a);
  // More than is kept goes back to the system, and what is left can still be taken.
  returnPixels(a, bytes);
  void* const large = takePixels(kKeptPixelBytes - bytes / 2);
  returnPixels(large, kKeptPixelBytes - bytes / 2);
  returnPixels(b, bytes);
  void* const last = takePixels(bytes);
  EXPECT_EQ(last, b);
  returnPixels(last, bytes);
}

}  // namespace
}  // namespace alidade

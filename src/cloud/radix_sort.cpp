// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/radix_sort.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>

namespace alidade {

namespace {

/// Sorts by bits [from, from + digits * width), least significant digit first.
void sortByDigits(RawVector<std::uint64_t>& keys, RawVector<std::uint64_t>& scratch, int from, int digits, int width) {
  constexpr int kWidest = 11, kMostDigits = 6;
  const std::size_t count = keys.size();
  const std::uint64_t mask = (std::uint64_t{1} << width) - 1;
  std::array<std::array<std::uint32_t, 1 << kWidest>, kMostDigits> counts;
  for (int d = 0; d < digits; ++d) std::fill_n(counts[static_cast<std::size_t>(d)].begin(), std::size_t{1} << width, 0);
  for (const std::uint64_t key : keys) {
    std::uint64_t rest = key >> from;
    for (std::size_t d = 0; d < static_cast<std::size_t>(digits); ++d) ++counts[d][rest & mask], rest >>= width;
  }
  scratch.resize(count);
  for (int d = 0; d < digits; ++d) {
    const int shift = from + d * width;
    auto& next = counts[static_cast<std::size_t>(d)];
    if (next[keys[0] >> shift & mask] == count) continue;
    std::uint32_t sum = 0;
    for (std::size_t digit = 0; digit <= mask; ++digit) next[digit] = std::exchange(sum, sum + next[digit]);
    for (const std::uint64_t key : keys) scratch[next[key >> shift & mask]++] = key;
    keys.swap(scratch);
  }
}

/// Keys that are sorted but for their lowest `rest` bits.
void putRight(std::uint64_t* keys, std::size_t count, int rest) {
  constexpr std::size_t kFar = 32;  // moved so far, a key stands in a run that is worth sorting
  for (std::size_t i = 1; i < count; ++i) {
    const std::uint64_t key = keys[i];
    if (keys[i - 1] <= key) continue;
    std::size_t at = i;
    const std::size_t least = i > kFar ? i - kFar : 0;
    for (; at > least && keys[at - 1] > key; --at) keys[at] = keys[at - 1];
    keys[at] = key;
    if (at > least || least == 0) continue;
    const std::uint64_t run = key >> rest;
    std::size_t first = at, last = i + 1;
    while (first > 0 && keys[first - 1] >> rest == run) --first;
    while (last < count && keys[last] >> rest == run) ++last;
    std::sort(keys + first, keys + last);
    i = last - 1;
  }
}

}  // namespace

void sortKeys(RawVector<std::uint64_t>& keys, RawVector<std::uint64_t>& scratch, int bits) {
  if (keys.size() < 2) return;
  // Points of a surface fall apart with two bits of three: as many as count them, and two octaves more.
  const int wanted = std::min(bits, (static_cast<int>(std::bit_width(keys.size())) + 3) * 3 / 2);
  const int digits = (wanted + 10) / 11, width = (wanted + digits - 1) / digits;
  const int rest = std::max(0, bits - digits * width);
  sortByDigits(keys, scratch, rest, digits, width);
  putRight(keys.data(), keys.size(), rest);
}

}  // namespace alidade

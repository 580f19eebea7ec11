// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/radix_sort.h"

#include <array>
#include <cstddef>
#include <utility>

namespace alidade {

void radixSort(RawVector<std::uint64_t>& keys, RawVector<std::uint64_t>& scratch, int from, int bits) {
  constexpr int kWidest = 11, kMostDigits = 6;
  const std::size_t count = keys.size();
  if (bits <= 0 || count < 2) return;
  const int digits = (bits + kWidest - 1) / kWidest, width = (bits + digits - 1) / digits;
  const std::uint64_t mask = (std::uint64_t{1} << width) - 1;
  std::array<std::array<std::uint32_t, 1 << kWidest>, kMostDigits> counts;
  for (int d = 0; d < digits; ++d) counts[static_cast<std::size_t>(d)].fill(0);
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
    for (std::uint32_t& c : next) c = std::exchange(sum, sum + c);
    for (const std::uint64_t key : keys) scratch[next[key >> shift & mask]++] = key;
    keys.swap(scratch);
  }
}

}  // namespace alidade
